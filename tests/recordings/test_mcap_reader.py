"""Reading back: everything as it was written, and the truth about what is not there."""

import json
import random
from dataclasses import fields, replace

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer

from recordings.errors import BadRecordingError
from recordings.mcap_reader import read
from recordings.protobuf_types import message_type
from recordings.recorder import Layer, Outcome


@pytest.fixture
def flight(workshop):
    return workshop.fly(workshop.header(workshop.corners), right_m=0.5)


def unchanged(_, data):
    return data


def rewritten(source, target, change=unchanged, metadata=lambda content: content, **options):
    """The recording as another program would write it, changed; messages changed to None are left out."""
    with source.open("rb") as stream, target.open("wb") as out:
        reader = make_reader(stream)
        writer = Writer(out, **options)
        writer.start()
        for record in reader.iter_metadata():
            writer.add_metadata(record.name, metadata(record.metadata))
        for attachment in reader.iter_attachments():
            data = change(attachment.name, attachment.data)
            if data is not None:
                writer.add_attachment(0, 0, attachment.name, attachment.media_type, data)
        channels = {}
        for schema, channel, message in reader.iter_messages():
            data = change(channel.topic, message.data)
            if data is None:
                continue
            if channel.topic not in channels:
                schema_id = writer.register_schema(schema.name, schema.encoding, schema.data)
                channels[channel.topic] = writer.register_channel(channel.topic, "protobuf", schema_id)
            writer.add_message(channels[channel.topic], message.log_time, data, message.log_time)
        writer.finish()
    return target


def read_or_refused(path):
    try:
        return read(path)
    except BadRecordingError:
        return None


def assert_same(recording, flight):
    for name in flight.states[0]._fields:
        written = np.array([getattr(state, name) for state in flight.states])
        column = recording.state[name]
        assert np.array_equal(column, written.astype(column.dtype)), name
    assert np.array_equal(recording.state["lat_rad"], [state.lat_rad for state in flight.states])
    assert np.array_equal(recording.guidance["path_m"], [sample.path_m for sample in flight.guidance])
    assert np.all(recording.guidance["command_altitude_m"] == 1000.0)
    header, found = flight.header, recording.header
    for field in fields(header):
        if field.name != "reference":
            assert getattr(found, field.name) == getattr(header, field.name), field.name
    for field in fields(header.reference):
        ours, theirs = getattr(found.reference, field.name), getattr(header.reference, field.name)
        assert ours.dtype == theirs.dtype
        assert np.array_equal(ours, theirs), field.name


def test_what_is_read_is_what_was_written(workshop, flight):
    recording = workshop.recording(flight)
    assert_same(recording, flight)
    assert (recording.complete, recording.missing) == (True, "")
    assert (recording.outcome, recording.outcome_detail) == (Outcome.ARRIVED, "as it was told")
    assert recording.end_time_s == flight.states[-1].time_s
    assert [(event.time_s, event.text) for event in recording.events] == [(60.0, "a minute has passed")]
    assert recording.limits == flight.header.limits


def test_estimates_are_read_back(workshop, flight):
    found = workshop.recording(flight).estimate
    assert found["time_s"].tolist() == [state.time_s for state in flight.seen]
    assert found["lat_rad"].tolist() == [state.lat_rad for state in flight.seen]
    wind_mps = np.array([state.wind_north_mps for state in flight.seen], dtype=np.float32)
    assert np.array_equal(found["wind_north_mps"], wind_mps)
    assert len(workshop.recording(replace(flight, seen=[])).estimate) == 0


def test_hazards_are_read_back_bit_by_bit(workshop):
    hazard = np.random.default_rng(5).random(workshop.grid.shape) < 0.3
    flight = workshop.fly(workshop.header(workshop.straight), sheets=workshop.sheets(hazard))
    recording = workshop.recording(flight)
    assert [(sheet.layer, sheet.stage) for sheet in recording.hazards] == [
        (Layer.FORECAST, 0),
        (Layer.TRUTH, 0),
    ]
    for sheet in recording.hazards:
        assert np.array_equal(sheet.hazard, hazard)
        assert (sheet.grid, sheet.threshold_mps, sheet.time_s) == (workshop.grid, 15.0, -30.0)


@pytest.mark.parametrize(
    "options",
    [
        {"compression": CompressionType.LZ4},
        {"compression": CompressionType.NONE, "chunk_size": 5000},
        {"use_chunking": False},
        {"enable_data_crcs": True},
        {"use_statistics": False, "repeat_channels": False, "enable_crcs": False},
    ],
    ids=lambda options: ",".join(options),
)
def test_files_of_other_writers_are_read(workshop, flight, options):
    other = rewritten(workshop.file(flight), workshop.folder / "other.mcap", **options)
    recording = read(other)
    assert_same(recording, flight)
    assert recording.complete


def test_messages_encoded_in_other_ways_are_read(workshop, flight):
    """Protobuf's own encoder leaves zeros out, so the columns no longer lie in fixed places."""

    def change(topic, data):
        kinds = {"/state": "galeway.State", "/guidance": "galeway.Guidance"}
        return message_type(kinds[topic]).FromString(data).SerializeToString() if topic in kinds else data

    other = rewritten(workshop.file(flight), workshop.folder / "other.mcap", change)
    assert_same(read(other), flight)


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


def test_a_flipped_bit_is_found(workshop, flight):
    """Everything before the summary is under a checksum; the summary is not read, except for the counts."""
    content = workshop.file(flight).read_bytes()
    with (workshop.folder / "flight.mcap").open("rb") as stream:
        summary = make_reader(stream).get_summary()
    last = max(chunk.chunk_start_offset + chunk.chunk_length for chunk in summary.chunk_indexes)
    flipped = workshop.folder / "flipped.mcap"
    generator = random.Random(2)
    for offset in generator.sample(range(last), 120):
        damaged = bytearray(content)
        damaged[offset] ^= 1 << generator.randrange(8)
        flipped.write_bytes(damaged)
        recording = read_or_refused(flipped)
        assert recording is None or not recording.complete, offset


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


def test_a_flight_without_an_outcome_just_stops(workshop, flight):
    other = rewritten(
        workshop.file(flight),
        workshop.folder / "other.mcap",
        lambda topic, data: None if topic == "/outcome" else data,
    )
    recording = read(other)
    assert (recording.complete, recording.outcome) == (False, Outcome.INCOMPLETE)
    assert recording.end_time_s == flight.states[-1].time_s


@pytest.mark.parametrize(
    ("left_out", "message"),
    [
        ("/state", "no sample"),
        ("/reference", "reference is missing"),
        ("plan.json", r"plan\.json is missing"),
        ("scenario.toml", r"scenario\.toml is missing"),
    ],
)
def test_what_a_recording_cannot_do_without(workshop, flight, left_out, message):
    other = rewritten(
        workshop.file(flight),
        workshop.folder / "other.mcap",
        lambda topic, data: None if topic == left_out else data,
    )
    with pytest.raises(BadRecordingError, match=message):
        read(other)


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("schema", "2", "schema 2"),
        ("schema", "", "schema unknown"),
        ("seed", "seven", "seed is 'seven'"),
        ("threshold_mps", "strong", "threshold_mps is 'strong'"),
        ("limits", "[1]", r"limits is '\[1\]'"),
        ("limits", "none", "limits is 'none'"),
        ("grid_rows", "0", "grid or plan makes no sense"),
        ("grid_south_rad", "0.6", "another plane"),
    ],
)
def test_metadata_that_makes_no_sense(workshop, flight, key, value, message):
    other = rewritten(
        workshop.file(flight),
        workshop.folder / "other.mcap",
        metadata=lambda content: content | {key: value} if key in content else content,
    )
    with pytest.raises(BadRecordingError, match=message):
        read(other)


@pytest.mark.parametrize(
    ("topic", "data", "message"),
    [
        ("/reference", b"", "another plane"),
        ("/reference", b"\xff\xff", "not a galeway.Reference"),
        ("/state", b"\x01", "not a galeway.State"),
        ("/weather/truth/hazard", b"", "grid of a hazard"),
        ("/outcome", b"\x12\x04lost", "outcome is 'lost'"),
        ("plan.json", b"{}", "grid or plan makes no sense"),
    ],
)
def test_messages_that_make_no_sense(workshop, flight, topic, data, message):
    other = rewritten(
        workshop.file(flight),
        workshop.folder / "other.mcap",
        lambda name, usual: data if name == topic else usual,
    )
    with pytest.raises(BadRecordingError, match=message):
        read(other)


def test_a_reference_with_columns_of_unequal_length(workshop, flight):
    def change(topic, data):
        if topic != "/reference":
            return data
        message = message_type("galeway.Reference").FromString(data)
        message.north_m.append(0.0)
        return message.SerializeToString()

    other = rewritten(workshop.file(flight), workshop.folder / "other.mcap", change)
    with pytest.raises(BadRecordingError, match="columns of"):
        read(other)


def test_hazard_bits_of_another_size(workshop, flight):
    def change(topic, data):
        if topic != "/weather/truth/hazard":
            return data
        message = message_type("galeway.Hazard").FromString(data)
        message.cells += b"\0"
        return message.SerializeToString()

    other = rewritten(workshop.file(flight), workshop.folder / "other.mcap", change)
    with pytest.raises(BadRecordingError, match="bytes of them"):
        read(other)


def test_a_rerun_file_is_not_what_is_checked(tmp_path):
    with pytest.raises(BadRecordingError, match=r"MCAP recording beside it, such as .*flight\.mcap"):
        read(tmp_path / "flight.rrd")


@pytest.mark.parametrize("content", [b"", b"no", b"RRF2 and so on", json.dumps({}).encode()])
def test_files_that_are_something_else(tmp_path, content):
    path = tmp_path / "flight.mcap"
    path.write_bytes(content)
    with pytest.raises(BadRecordingError, match="not an MCAP file"):
        read(path)


def test_files_that_cannot_be_read(tmp_path):
    for path in (tmp_path / "none.mcap", tmp_path):
        with pytest.raises(BadRecordingError, match="cannot read"):
            read(path)


def test_an_mcap_file_of_something_else(tmp_path):
    path = tmp_path / "other.mcap"
    with path.open("wb") as out:
        writer = Writer(out)
        writer.start()
        writer.finish()
    with pytest.raises(BadRecordingError, match="not a recording of galeway"):
        read(path)


def test_a_topic_of_another_type(workshop, flight):
    path = workshop.file(flight)
    content = path.read_bytes().replace(b"galeway.State", b"galeway.Stale")
    path.write_bytes(content)
    with pytest.raises(BadRecordingError, match=r"/state holds galeway\.Stale"):
        read(path)


def test_a_crash_is_a_whole_recording(workshop, flight):
    recording = workshop.recording(replace(flight, outcome=Outcome.CRASHED))
    assert recording.complete
    assert recording.outcome == Outcome.CRASHED
