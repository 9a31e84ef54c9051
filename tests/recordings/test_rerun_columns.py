"""Every sample stands in the Rerun file with the fields and the precision of the MCAP file."""

import numpy as np
import pyarrow as pa
import pytest
from rerun.chunk import RrdReader

from recordings.mcap_reader import read
from recordings.mcap_writer import McapRecorder
from recordings.recorder import Recorders
from recordings.rerun_writer import RerunRecorder
from recordings.samples import MOST


def columns(path, topic, names):
    """Field to values, over all chunks of a topic in order of time."""
    chunks = [chunk for chunk in RrdReader(path).stream() if chunk.entity_path == topic]
    tables = [chunk.to_record_batch() for chunk in chunks]
    tables.sort(key=lambda table: table.column("flight_time")[0].value)
    found = {"flight_time": pa.chunked_array([table.column("flight_time") for table in tables])}
    for name in names:
        (column,) = {column for column in tables[0].schema.names if column.endswith(f":{name}")}
        lists = [table.column(column) for table in tables]
        assert all((values.value_lengths().to_numpy() == 1).all() for values in lists)
        found[name] = pa.chunked_array([values.flatten() for values in lists])
    return {name: values.to_numpy() for name, values in found.items()}


@pytest.mark.parametrize("topic", ["/state", "/guidance"])
def test_both_files_hold_the_same_samples(workshop, tmp_path, topic):
    flight = workshop.fly(workshop.header(workshop.corners))
    mcap, rrd = tmp_path / "flight.mcap", tmp_path / "flight.rrd"
    flight.record(Recorders([McapRecorder(mcap), RerunRecorder(rrd)]))
    recording = read(mcap)
    written = {"/state": recording.state, "/guidance": recording.guidance}[topic]
    assert len(written) > MOST
    assert len(written) % MOST
    found = columns(rrd, topic, written.dtype.names)
    assert np.array_equal(found["flight_time"].astype(np.int64), np.rint(written["time_s"] * 1e9))
    for name in written.dtype.names:
        assert found[name].dtype.itemsize >= written[name].dtype.itemsize
        np.testing.assert_array_equal(found[name], written[name], err_msg=name)


def test_an_abandoned_flight_keeps_its_last_sample(workshop, tmp_path):
    flight = workshop.fly(workshop.header(workshop.corners))
    recorder = RerunRecorder(tmp_path / "flight.rrd")
    flight.record(recorder, finish=False)
    recorder.abandon()
    found = columns(recorder.partial_path, "/state", ("time_s", "lat_rad"))
    assert found["time_s"].tolist() == [state.time_s for state in flight.states]
    assert found["lat_rad"].tolist() == [state.lat_rad for state in flight.states]
