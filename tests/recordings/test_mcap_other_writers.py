"""Recordings as other programs might write them: read alike, or refused with the reason."""

import json

import pytest
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer

from recordings.errors import BadRecordingError
from recordings.mcap_reader import read
from recordings.protobuf_types import message_type
from recordings.recorder import Outcome


@pytest.fixture(scope="module")
def flight(kept):
    """Of three chunks; longer ones are no other."""
    return kept.fly(kept.header(kept.corners), right_m=0.5, until_s=150.0)


@pytest.fixture(scope="module")
def whole(kept, flight):
    return kept.file(flight)


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
def test_files_of_other_writers_are_read(whole, tmp_path, flight, options, assert_same):
    other = rewritten(whole, tmp_path / "other.mcap", **options)
    recording = read(other)
    assert_same(recording, flight)
    assert recording.complete


def test_messages_encoded_in_other_ways_are_read(whole, tmp_path, flight, assert_same):
    """Protobuf's own encoder leaves zeros out, so the columns no longer lie in fixed places."""

    def change(topic, data):
        kinds = {"/state": "galeway.State", "/guidance": "galeway.Guidance"}
        return message_type(kinds[topic]).FromString(data).SerializeToString() if topic in kinds else data

    other = rewritten(whole, tmp_path / "other.mcap", change)
    assert_same(read(other), flight)


def test_a_recording_of_the_first_schema_has_one_reference_without_a_time(
    whole, tmp_path, flight, assert_same
):
    def older(topic, data):
        if topic != "/reference":
            return data
        message = message_type("galeway.Reference").FromString(data)
        message.ClearField("issued_s")
        return message.SerializeToString(deterministic=True)

    other = rewritten(
        whole,
        tmp_path / "other.mcap",
        older,
        lambda content: content | {"schema": "1"} if "schema" in content else content,
    )
    found = read(other)
    assert_same(found, flight)
    assert [issue.time_s for issue in found.references] == [flight.header.reference.start_time_s[0]]
    assert found.references[0].reference is found.header.reference


def test_a_flight_without_an_outcome_just_stops(whole, tmp_path, flight):
    other = rewritten(
        whole,
        tmp_path / "other.mcap",
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
def test_what_a_recording_cannot_do_without(whole, tmp_path, left_out, message):
    other = rewritten(
        whole,
        tmp_path / "other.mcap",
        lambda topic, data: None if topic == left_out else data,
    )
    with pytest.raises(BadRecordingError, match=message):
        read(other)


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("schema", "4", "schema '4'"),
        ("schema", "", "schema unknown"),
        ("seed", "seven", "seed is 'seven'"),
        ("threshold_mps", "strong", "threshold_mps is 'strong'"),
        ("limits", "[1]", r"limits is '\[1\]'"),
        ("limits", "none", "limits is 'none'"),
        ("grid_rows", "0", "grid or plan makes no sense"),
        ("grid_south_rad", "0.6", "another plane"),
    ],
)
def test_metadata_that_makes_no_sense(whole, tmp_path, key, value, message):
    other = rewritten(
        whole,
        tmp_path / "other.mcap",
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
def test_messages_that_make_no_sense(whole, tmp_path, topic, data, message):
    other = rewritten(
        whole,
        tmp_path / "other.mcap",
        lambda name, usual: data if name == topic else usual,
    )
    with pytest.raises(BadRecordingError, match=message):
        read(other)


def test_a_reference_with_columns_of_unequal_length(whole, tmp_path):
    def change(topic, data):
        if topic != "/reference":
            return data
        message = message_type("galeway.Reference").FromString(data)
        message.north_m.append(0.0)
        return message.SerializeToString()

    other = rewritten(whole, tmp_path / "other.mcap", change)
    with pytest.raises(BadRecordingError, match="columns of"):
        read(other)


@pytest.mark.parametrize("field", ["cells", "closed"])
def test_hazard_bits_of_another_size(whole, tmp_path, field):
    def change(topic, data):
        if topic != "/weather/truth/hazard":
            return data
        message = message_type("galeway.Hazard").FromString(data)
        setattr(message, field, getattr(message, field) + b"\0")
        return message.SerializeToString()

    other = rewritten(whole, tmp_path / "other.mcap", change)
    with pytest.raises(BadRecordingError, match="bytes of them"):
        read(other)


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


def test_a_topic_of_another_type(whole, tmp_path):
    path = tmp_path / "stale.mcap"
    path.write_bytes(whole.read_bytes().replace(b"galeway.State", b"galeway.Stale"))
    with pytest.raises(BadRecordingError, match=r"/state holds 'galeway\.Stale'"):
        read(path)
