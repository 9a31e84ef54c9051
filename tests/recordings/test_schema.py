"""The table of topics against the message types that are really there."""

import subprocess
import sys
from dataclasses import fields
from pathlib import Path

import pytest
from google.protobuf.descriptor import FieldDescriptor
from mcap.reader import make_reader

from aircraft.reference import Reference
from aircraft.state import FlightState
from recordings.foxglove_fields import FOXGLOVE_FIELDS
from recordings.meanings import MEANINGS
from recordings.proto_text import proto_text
from recordings.protobuf_types import message_type
from recordings.schema import MESSAGES, PLAN, REFERENCE, SAMPLED, STATE_COLUMNS, TOPICS, Kind

ROOT = Path(__file__).parents[2]
KINDS = {
    FieldDescriptor.TYPE_DOUBLE: {Kind.DOUBLE},
    FieldDescriptor.TYPE_FLOAT: {Kind.FLOAT},
    FieldDescriptor.TYPE_UINT32: {Kind.SMALL, Kind.WHOLE},
    FieldDescriptor.TYPE_STRING: {Kind.TEXT},
    FieldDescriptor.TYPE_BYTES: {Kind.BYTES},
}


@pytest.mark.parametrize("message", MESSAGES, ids=lambda message: message.name)
def test_the_fields_of_a_message_are_those_of_the_schema_in_order(message):
    fields = message_type(message.name).DESCRIPTOR.fields
    assert [(f.name, f.number, f.is_repeated, f.has_presence) for f in fields] == [
        (column.name, number, column.repeated, column.optional)
        for number, column in enumerate(message.columns, 1)
    ]
    for field, column in zip(fields, message.columns, strict=True):
        assert column.kind in KINDS[field.type], column.name


def test_every_topic_of_ours_has_its_message_in_the_schema_and_every_message_a_topic():
    ours = {topic.message for topic in TOPICS if topic.message.startswith("galeway.")}
    assert ours == {message.name for message in MESSAGES}
    for topic, columns in SAMPLED.items():
        assert columns == next(message.columns for message in MESSAGES if message.name == topic.message)


def test_a_unit_that_is_a_suffix_is_the_unit_of_the_field_and_nothing_is_explained_that_is_not_there():
    columns = {column.name: column for message in MESSAGES for column in message.columns}
    assert set(columns) == set(MEANINGS)
    for name, column in columns.items():
        suffix = name.rpartition("_")[2]
        if suffix in {"m", "s", "mps", "rad", "radps", "kg"}:
            assert column.unit.replace("/", "p").removesuffix(" in the plane") == suffix


def test_small_numbers_are_in_sampled_messages_alone():
    """The reader takes them for one byte."""
    for columns in SAMPLED.values():
        assert {column.kind for column in columns} <= {Kind.DOUBLE, Kind.FLOAT, Kind.SMALL}


def test_every_field_of_the_flight_state_is_recorded():
    assert tuple(column.name for column in STATE_COLUMNS) == FlightState._fields


def test_every_array_of_the_reference_is_recorded():
    recorded = {field.name for field in message_type(REFERENCE.message).DESCRIPTOR.fields}
    assert recorded == {"origin_lat_rad", "origin_lon_rad", "issued_s"} | {
        field.name for field in fields(Reference)
    }


@pytest.mark.parametrize("topic", TOPICS, ids=lambda topic: topic.name)
def test_message_types_exist_by_the_name_in_the_table(topic):
    assert message_type(topic.message).DESCRIPTOR.full_name == topic.message


def test_topic_names_are_unique():
    assert len({topic.name for topic in TOPICS}) == len(TOPICS)


def leaves(message, way=""):
    """Of each field that is set, also in parts and in lists of parts, the way to it."""
    for field, value in message.ListFields():
        path = f"{way}{field.name}"
        if field.message_type is None or field.message_type.full_name == "google.protobuf.Timestamp":
            yield path
        else:
            for part in value if field.is_repeated else [value]:
                yield from leaves(part, f"{path}.")


@pytest.fixture(scope="module")
def filled(kept):
    """Topic to the fields that any of its messages has set."""
    found = {}
    path = kept.file(kept.fly(kept.header(kept.corners), until_s=70.0))
    with path.open("rb") as stream:
        for _, channel, message in make_reader(stream).iter_messages():
            topic = next(topic for topic in TOPICS if topic.name == channel.topic)
            decoded = message_type(topic.message).FromString(message.data)
            found.setdefault(topic, set()).update(leaves(decoded))
    return found


def test_foxgloves_messages_are_filled_with_what_the_table_says_and_nothing_else(filled):
    theirs = {topic for topic in TOPICS if topic.message.startswith("foxglove.")}
    assert set(FOXGLOVE_FIELDS) == theirs
    for topic in theirs:
        assert filled[topic] - {"timestamp"} == {field.path for field in FOXGLOVE_FIELDS[topic]}, topic.name
        assert ("timestamp" in filled[topic]) == (topic is not PLAN)


def test_the_proto_file_is_that_of_the_schema():
    assert (ROOT / "recordings" / "galeway.proto").read_text() == proto_text(), "run `make proto`"


def test_the_recording_page_is_that_of_the_schema():
    page = subprocess.run(
        [sys.executable, ROOT / "docs" / "recording_page.py"], capture_output=True, text=True, check=True
    ).stdout
    assert (ROOT / "docs" / "recording.md").read_text(encoding="utf-8") == page, "run `make proto`"


def test_the_committed_messages_are_those_of_the_proto_file(tmp_path):
    subprocess.run(
        [
            sys.executable,
            "-m",
            "grpc_tools.protoc",
            "-I.",
            f"--python_out={tmp_path}",
            "recordings/galeway.proto",
        ],
        cwd=ROOT,
        check=True,
    )
    made, committed = tmp_path / "recordings" / "galeway_pb2.py", ROOT / "recordings" / "galeway_pb2.py"
    assert made.read_text() == committed.read_text(), "run `make proto` and commit the result"
