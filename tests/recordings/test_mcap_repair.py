"""Repair: everything that is intact, nothing that is not, and never in the place of what it is made of."""

import numpy as np
import pytest
from mcap.reader import make_reader

from recordings.errors import RecordingError
from recordings.mcap_reader import read
from recordings.mcap_repair import repair, repaired_path
from recordings.mcap_stream import take_apart
from recordings.mcap_writer import McapRecorder
from recordings.recorder import Outcome
from recordings.tracking import track


@pytest.fixture(scope="module")
def flight(kept):
    return kept.fly(kept.header(kept.corners))


def test_a_cut_file_is_repaired_with_all_that_is_left(workshop, flight, tmp_path):
    content = workshop.file(flight).read_bytes()
    cut, out = tmp_path / "cut.mcap", tmp_path / "out.mcap"
    cut.write_bytes(content[: len(content) * 2 // 3])
    left = read(cut)
    assert "cut off" in repair(cut, out).reason
    found = read(out)
    for name in ("state", "guidance", "estimate"):
        assert np.array_equal(getattr(found, name), getattr(left, name))
    assert found.events == left.events
    assert [sheet.stage for sheet in found.hazards] == [sheet.stage for sheet in left.hazards]
    assert found.header.plan == flight.header.plan
    assert (found.outcome, found.complete) == (Outcome.INCOMPLETE, False)
    assert found.missing.startswith("repaired: the file is cut off")
    assert found.end_time_s == left.state["time_s"][-1]
    assert track(found).cross_track_m == track(left).cross_track_m
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cut.mcap", "flight.mcap", "out.mcap"]


def test_a_file_that_was_closed_without_an_outcome_is_repaired(workshop, flight):
    recorder = McapRecorder(workshop.folder / "flight.mcap")
    flight.record(recorder, finish=False)
    recorder.abandon()
    out = repaired_path(recorder.partial_path)
    assert "says nothing of how the flight ended" in repair(recorder.partial_path, out).reason
    assert out.name == "flight.repaired.mcap"
    assert len(read(out).state) == len(flight.states)


def test_a_damaged_file_that_arrived_is_no_whole_flight(workshop, flight, tmp_path):
    """Of what is lost nothing is known, so the outcome is not believed."""
    content = bytearray(workshop.file(flight).read_bytes())
    with (workshop.folder / "flight.mcap").open("rb") as stream:
        chunk = make_reader(stream).get_summary().chunk_indexes[2]
    content[chunk.chunk_start_offset + 200] ^= 1
    damaged, out = tmp_path / "damaged.mcap", tmp_path / "out.mcap"
    damaged.write_bytes(content)
    assert not repair(damaged, out).whole
    assert read(out).outcome is Outcome.INCOMPLETE
    with pytest.raises(RecordingError, match="whole"):
        repair(out, tmp_path / "again.mcap")


@pytest.mark.parametrize("byte", [-45, -3], ids=["table of contents", "last mark"])
def test_a_file_of_which_only_the_index_is_damaged_is_the_whole_flight_again(
    workshop, flight, tmp_path, byte
):
    whole = workshop.file(flight)
    content = bytearray(whole.read_bytes())
    content[byte] ^= 1
    damaged, out = tmp_path / "damaged.mcap", tmp_path / "out.mcap"
    damaged.write_bytes(content)
    assert not read(damaged).complete
    assert repair(damaged, out).whole
    found, before = read(out), read(whole)
    assert (found.complete, found.outcome, found.missing) == (True, before.outcome, "")
    assert np.array_equal(found.state, before.state)
    assert track(found).to_json() == track(before).to_json()
    with out.open("rb") as stream:
        assert make_reader(stream).get_summary().statistics.chunk_count > 1


def test_what_lies_behind_a_damaged_chunk_is_kept_and_not_measured(workshop, flight, tmp_path):
    content = bytearray(workshop.file(flight).read_bytes())
    with (workshop.folder / "flight.mcap").open("rb") as stream:
        chunk = make_reader(stream).get_summary().chunk_indexes[2]
    content[chunk.chunk_start_offset + 200] ^= 1
    damaged, out = tmp_path / "damaged.mcap", tmp_path / "out.mcap"
    damaged.write_bytes(content)
    assert "is damaged" in repair(damaged, out).reason
    assert len(take_apart(out).messages["/state"]) == len(take_apart(damaged).messages["/state"])
    found, left = read(out), read(damaged)
    assert 0 < len(left.state) < len(take_apart(out).messages["/state"])
    assert np.array_equal(found.state, left.state)
    assert "is lost, so the flight is measured up to there only" in found.missing
    assert track(found).cross_track_m == track(left).cross_track_m


def test_the_command_refuses_a_whole_file(workshop, flight, galeway):
    done = galeway("repair", str(workshop.file(flight)))
    assert (done.returncode, done.stdout) == (2, "")
    assert "is whole; there is nothing to repair" in done.stderr


def test_what_is_refused(workshop, flight, tmp_path):
    whole = workshop.file(flight)
    with pytest.raises(RecordingError, match="is whole; there is nothing to repair"):
        repair(whole, tmp_path / "out.mcap")
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole.read_bytes()[:-100])
    with pytest.raises(RecordingError, match="exists and is not overwritten"):
        repair(cut, cut)
    with pytest.raises(RecordingError, match="cannot write"):
        repair(cut, tmp_path / "none" / "out.mcap")
    other = tmp_path / "other.mcap"
    other.write_text("no recording")
    with pytest.raises(RecordingError, match="not an MCAP file"):
        repair(other, tmp_path / "out.mcap")
    cut.write_bytes(whole.read_bytes()[:3000])
    with pytest.raises(RecordingError, match="no sample of a flight"):
        repair(cut, tmp_path / "out.mcap")
    assert not (tmp_path / "out.mcap").exists()
