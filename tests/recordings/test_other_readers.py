"""Our files by programs that are not ours: Rerun's tools, and the mcap package with Foxglove's decoder."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
from rerun.chunk import McapReader, RrdReader

import recordings
from recordings.mcap_writer import McapRecorder
from recordings.recorder import Recorders
from recordings.rerun_writer import RerunRecorder
from recordings.schema import SAMPLED, TOPICS

RERUN = Path(sys.executable).parent / "rerun"


def rerun(*arguments):
    return subprocess.run([RERUN, *map(str, arguments)], capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("others")


@pytest.fixture
def files(workshop, folder):
    """One flight in both formats, recorded twice, and another one."""
    named = {name: folder / name for name in ("one.mcap", "one.rrd", "again.rrd", "other.rrd")}
    if not named["one.mcap"].exists():
        flight = workshop.fly(workshop.header(workshop.straight), until_s=61.0)
        flight.record(Recorders([McapRecorder(named["one.mcap"]), RerunRecorder(named["one.rrd"])]))
        flight.record(RerunRecorder(named["again.rrd"]))
        flight.changed(300, airspeed_mps=33.0).record(RerunRecorder(named["other.rrd"]))
    return named


def test_rerun_finds_nothing_wrong_with_the_mcap_file(files):
    done = rerun("mcap", "check", files["one.mcap"])
    assert done.returncode == 0, done.stderr
    rows = [line.split() for line in done.stdout.splitlines() if "/" in line and line.startswith("ok")]
    assert {row[3] for row in rows} == {topic.name for topic in TOPICS}


def test_rerun_converts_the_mcap_file(files, folder):
    converted = folder / "converted.rrd"
    assert rerun("mcap", "convert", files["one.mcap"], "-o", converted).returncode == 0
    verified = rerun("rrd", "verify", converted)
    assert verified.returncode == 0, verified.stderr
    entities = {chunk.entity_path for chunk in RrdReader(converted).stream()}
    assert {topic.name for topic in TOPICS} <= entities


def test_rerun_counts_the_messages_that_we_count(files):
    counts = {
        channel.topic: channel.message_count for channel in McapReader(files["one.mcap"]).info().channels
    }
    found = recordings.open(files["one.mcap"])
    assert {topic: counts[topic] for topic in found.columns} == {
        topic: len(rows) for topic, rows in found.columns.items()
    }


def test_rerun_verifies_its_own_file(files):
    done = rerun("rrd", "verify", files["one.rrd"])
    assert done.returncode == 0, done.stderr
    stats = rerun("rrd", "stats", files["one.rrd"])
    assert stats.returncode == 0, stats.stderr
    assert "num_rows" in stats.stdout


def test_rerun_tells_two_flights_apart_and_one_from_itself(files):
    assert rerun("rrd", "compare", "--unordered", files["one.rrd"], files["again.rrd"]).returncode == 0
    assert rerun("rrd", "compare", "--unordered", files["one.rrd"], files["other.rrd"]).returncode != 0


def test_a_file_that_rerun_has_compacted_is_read_the_same(files, folder):
    compacted = folder / "compacted.rrd"
    with compacted.open("wb") as out:
        done = subprocess.run([RERUN, "rrd", "optimize", files["one.rrd"]], stdout=out, check=False)
    assert done.returncode == 0
    found, expected = recordings.open(compacted), recordings.open(files["one.rrd"])
    assert found.missing == ""
    assert found.state.tobytes() == expected.state.tobytes()
    assert found.events == expected.events


def test_the_mcap_package_decodes_every_sample_to_what_we_read(files):
    ours = recordings.open(files["one.mcap"]).columns
    for topic, columns in SAMPLED.items():
        with files["one.mcap"].open("rb") as stream:
            reader = make_reader(stream, decoder_factories=[DecoderFactory()])
            messages = [found for *_, found in reader.iter_decoded_messages(topics=[topic.name])]
        assert len(messages) == len(ours[topic.name]) > 600
        for column in columns:
            theirs = np.array([getattr(message, column.name) for message in messages])
            assert np.array_equal(
                theirs.astype(ours[topic.name][column.name].dtype), ours[topic.name][column.name]
            )
