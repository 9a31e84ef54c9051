"""MCAP files that are cut off or damaged: found, told, and read as far as they can be trusted."""

import random

import numpy as np
import pytest
from mcap.reader import make_reader

from recordings.errors import BadRecordingError
from recordings.figures import clock
from recordings.mcap_reader import read
from recordings.mcap_stream import take_apart
from recordings.recorder import Outcome
from recordings.schema import SAMPLES_PER_CHUNK
from recordings.soundness import require_sound


@pytest.fixture(scope="module")
def flight(kept):
    return kept.fly(kept.header(kept.corners), right_m=0.5)


@pytest.fixture(scope="module")
def short(kept):
    """The first two chunks of it, of which hundreds of variants are read."""
    return kept.fly(kept.header(kept.corners), right_m=0.5, until_s=60.0)


def read_or_refused(path):
    try:
        return read(path)
    except BadRecordingError:
        return None


def test_a_file_cut_anywhere_says_so_and_is_never_mistaken(workshop, flight):
    whole = workshop.file(flight)
    content, cut = whole.read_bytes(), workshop.folder / "cut.mcap"
    everything = read(whole)
    generator = random.Random(1)
    offsets = [
        *range(30),
        *generator.sample(range(len(content)), 150),
        *range(len(content) - 30, len(content)),
    ]
    samples = []
    for offset in sorted(offsets):
        cut.write_bytes(content[:offset])
        recording = read_or_refused(cut)
        if recording is None:
            assert not samples, "more of the file, but less of the recording"
            continue
        samples.append(len(recording.state))
        assert not recording.complete
        assert "cut off" in recording.missing
        assert np.array_equal(recording.state, everything.state[: len(recording.state)])
    assert samples == sorted(samples)
    assert len(set(samples)) > 5


def test_a_flipped_bit_is_found(workshop, short):
    """Everything before the summary is under a checksum, and so is the summary."""
    content = workshop.file(short).read_bytes()
    with (workshop.folder / "flight.mcap").open("rb") as stream:
        summary = make_reader(stream).get_summary()
    last = max(chunk.chunk_start_offset + chunk.chunk_length for chunk in summary.chunk_indexes)
    flipped = workshop.folder / "flipped.mcap"
    generator = random.Random(2)
    behind = generator.sample(range(last, len(content)), 120)
    for offset in [*generator.sample(range(last), 80), *behind, *range(len(content) - 50, len(content))]:
        damaged = bytearray(content)
        damaged[offset] ^= 1 << generator.randrange(8)
        flipped.write_bytes(damaged)
        recording = read_or_refused(flipped)
        assert recording is None or not recording.complete, offset


def damaged_chunk(workshop, flight, index):
    """The file with 16 bytes inside of one chunk's messages turned over; other bytes are as they were."""
    path = workshop.file(flight)
    content = bytearray(path.read_bytes())
    with path.open("rb") as stream:
        chunk = make_reader(stream).get_summary().chunk_indexes[index]
    middle = chunk.chunk_start_offset + chunk.chunk_length // 2
    content[middle : middle + 16] = bytes(byte ^ 255 for byte in content[middle : middle + 16])
    damaged = path.with_name("damaged.mcap")
    damaged.write_bytes(content)
    return damaged


def test_a_damaged_chunk_is_left_out_and_what_was_flown_is_measured_up_to_it(workshop, flight):
    whole = workshop.recording(flight)
    damaged = damaged_chunk(workshop, flight, 3)
    found = take_apart(damaged)
    kept, lost_from = len(found.messages["/state"]), found.samples_before_damage
    assert len(whole.state) - SAMPLES_PER_CHUNK <= kept < len(whole.state) > lost_from > 0
    assert found.messages["/outcome"] == take_apart(workshop.file(flight)).messages["/outcome"]
    recording = read(damaged)
    assert (recording.complete, recording.outcome) == (False, Outcome.INCOMPLETE)
    assert np.array_equal(recording.state, whole.state[:lost_from])
    assert recording.end_time_s == recording.state["time_s"][-1] == recording.guidance["time_s"][-1]
    first, last = (
        clock(float(time_s)) for time_s in whole.state["time_s"][[lost_from - 1, lost_from - kept]]
    )
    assert f"what was flown from {first} to {last} is lost" in recording.missing
    require_sound(recording)


def test_without_the_beginning_nothing_is_measured_and_the_other_file_is_named(workshop, flight):
    damaged = damaged_chunk(workshop, flight, 0)
    with pytest.raises(BadRecordingError, match=r"how the flight began is lost.*; fly again"):
        read(damaged)
    damaged.with_suffix(".rrd").write_bytes(b"")
    with pytest.raises(BadRecordingError, match=r"take .*damaged\.rrd, which lies beside it"):
        read(damaged)


def test_a_file_whose_data_have_no_marked_end_is_damaged(workshop, flight):
    content = workshop.file(flight).read_bytes()
    data_end = content.rindex(bytes([0x0F, 4, 0, 0, 0, 0, 0, 0, 0]))
    other = workshop.folder / "other.mcap"
    other.write_bytes(content[:data_end] + b"\x07" + content[data_end + 1 :])
    assert "the end of its data is not marked" in read(other).missing


def test_messages_that_the_file_once_had_are_missed(workshop, flight):
    """The chunk of a whole minute cut out, and the checksum with it."""
    path = workshop.file(flight)
    content = path.read_bytes()
    with path.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    chunk = summary.chunk_indexes[3]
    begin, end = (
        chunk.chunk_start_offset,
        chunk.chunk_start_offset + chunk.chunk_length + chunk.message_index_length,
    )
    data_end = content.rindex(bytes([0x0F, 4, 0, 0, 0, 0, 0, 0, 0]))
    without = content[:begin] + content[end : data_end + 9] + bytes(4) + content[data_end + 13 :]
    other = workshop.folder / "other.mcap"
    other.write_bytes(without)
    recording = read(other)
    assert not recording.complete
    assert "were written" in recording.missing
