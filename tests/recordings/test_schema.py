"""The table of topics against the message types that are really there."""

import subprocess
import sys
from dataclasses import fields
from pathlib import Path

import pytest
from google.protobuf.descriptor import FieldDescriptor

from aircraft.reference import Reference
from aircraft.state import FlightState
from recordings.protobuf_types import message_type
from recordings.schema import (
    ESTIMATE,
    ESTIMATE_COLUMNS,
    GUIDANCE,
    GUIDANCE_COLUMNS,
    REFERENCE,
    STATE,
    STATE_COLUMNS,
    TOPICS,
    Kind,
)

ROOT = Path(__file__).parents[2]
KINDS = {
    FieldDescriptor.TYPE_DOUBLE: Kind.DOUBLE,
    FieldDescriptor.TYPE_FLOAT: Kind.FLOAT,
    FieldDescriptor.TYPE_UINT32: Kind.SMALL,
}


@pytest.mark.parametrize(
    ("topic", "columns"),
    [(STATE, STATE_COLUMNS), (GUIDANCE, GUIDANCE_COLUMNS), (ESTIMATE, ESTIMATE_COLUMNS)],
)
def test_columns_are_the_fields_of_the_message_in_order(topic, columns):
    found = [(f.name, f.number, KINDS[f.type]) for f in message_type(topic.message).DESCRIPTOR.fields]
    assert found == [(column.name, number, column.kind) for number, column in enumerate(columns, 1)]


def test_every_field_of_the_flight_state_is_recorded():
    assert tuple(column.name for column in STATE_COLUMNS) == FlightState._fields


def test_every_array_of_the_reference_is_recorded():
    recorded = {field.name for field in message_type(REFERENCE.message).DESCRIPTOR.fields}
    assert recorded == {"origin_lat_rad", "origin_lon_rad"} | {field.name for field in fields(Reference)}


@pytest.mark.parametrize("topic", TOPICS, ids=lambda topic: topic.name)
def test_message_types_exist_by_the_name_in_the_table(topic):
    assert message_type(topic.message).DESCRIPTOR.full_name == topic.message


def test_topic_names_are_unique():
    assert len({topic.name for topic in TOPICS}) == len(TOPICS)


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
