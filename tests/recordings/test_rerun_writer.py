"""What the Rerun recorder writes, read back from the file."""

import subprocess
import sys
import time
from contextlib import suppress
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pyarrow as pa
import pytest
from rerun.chunk import RrdReader

from recordings.errors import RecordingError
from recordings.recorder import Outcome
from recordings.rerun_writer import POSE_STRIDE, ROWS_PER_CHUNK, RerunRecorder

HAZARD_PLACE = slice(50, None), slice(70, None)


@pytest.fixture
def flight(workshop):
    return workshop.fly(workshop.header(workshop.corners))


@pytest.fixture
def path(tmp_path):
    return tmp_path / "flight.rrd"


def recorded(flight, path):
    flight.record(RerunRecorder(path))
    return path


def tables(path, entity):
    """The chunks of an entity that have times, each as a table."""
    for chunk in RrdReader(path).stream():
        if chunk.entity_path == f"/{entity}" and "flight_time" in chunk.timeline_names:
            yield chunk.to_record_batch()


def values(path, entity, component):
    """(time_s, value) of every row of an entity that has the component, in order of time."""
    rows = []
    for table in tables(path, entity):
        names = [name for name in table.schema.names if name.endswith(component)]
        if names:
            times = table.column("flight_time").cast(pa.int64()).to_pylist()
            rows += zip([time / 1e9 for time in times], table.column(names[0]).to_pylist(), strict=True)
    return sorted(rows, key=lambda row: row[0])


def static_text(path, entity):
    """The last text logged to an entity without a time."""
    texts = []
    for chunk in RrdReader(path).stream():
        if chunk.entity_path == f"/{entity}" and chunk.is_static:
            table = chunk.to_record_batch()
            texts += table.column("TextDocument:text").to_pylist()
    return texts[-1][0]


def kept_states(flight):
    return [state for state in flight.states if abs(state.time_s - round(state.time_s)) < 1e-6]


def test_the_plots_have_one_sample_a_second_as_it_was_sampled(flight, path):
    recorded(flight, path)
    states = kept_states(flight)
    speeds = values(path, "plots/speed", "Scalars:scalars")
    assert [time_s for time_s, _ in speeds] == [state.time_s for state in states]
    for (_, (ground_mps, air_mps)), state in zip(speeds, states, strict=True):
        assert ground_mps == pytest.approx(np.hypot(state.north_mps, state.east_mps))
        assert air_mps == state.airspeed_mps
    for _, (late_s, above_m, across_m) in values(path, "plots/off_reference", "Scalars:scalars"):
        assert (late_s, above_m, across_m) == (1.5, -0.5, 0.25)
    for (_, (gusty_mps, wind_mps)), state in zip(
        values(path, "plots/wind", "Scalars:scalars"), states, strict=True
    ):
        assert wind_mps == pytest.approx(np.hypot(state.wind_north_mps, state.wind_east_mps))
        assert gusty_mps == pytest.approx(
            np.hypot(state.wind_north_mps + state.gust_north_mps, state.wind_east_mps + state.gust_east_mps)
        )


def test_the_last_sample_is_kept_also_between_seconds(workshop, path):
    flight = workshop.fly(workshop.header(workshop.straight), until_s=100.3)
    recorded(flight, path)
    last_s, (_, air_mps) = values(path, "plots/speed", "Scalars:scalars")[-1]
    assert last_s == pytest.approx(100.3)
    assert air_mps == flight.states[-1].airspeed_mps


def test_the_flown_line_goes_through_every_kept_position_without_a_gap(flight, path):
    recorded(flight, path)
    strips = [strip for _, (strip,) in values(path, "chart/flown", "LineStrips2D:strips")]
    assert len(strips) > 2
    for before, after in pairwise(strips):
        assert before[-1] == after[0]
    line = np.concatenate([strips[0], *(strip[1:] for strip in strips[1:])])
    states = kept_states(flight)
    north_m, east_m = flight.header.grid.frame.to_plane(
        np.array([state.lat_rad for state in states]), np.array([state.lon_rad for state in states])
    )
    np.testing.assert_allclose(line, np.column_stack([east_m, -north_m]) / 1000.0, atol=1e-4)


def test_a_line_is_of_the_time_of_its_last_point_so_that_the_track_never_runs_ahead(flight, path):
    recorded(flight, path)
    last_s = -np.inf
    for time_s, _ in values(path, "scene/flown", "LineStrips3D:strips"):
        assert time_s > last_s
        last_s = time_s
    assert last_s == flight.states[-1].time_s


def test_the_mark_of_the_aircraft_ends_where_the_flight_ends_and_points_along_it(flight, path):
    recorded(flight, path)
    places = values(path, "chart/aircraft", "Transform3D:translation")
    turns = values(path, "chart/aircraft", "Transform3D:quaternion")
    last = flight.states[-1]
    north_m, east_m = flight.header.grid.frame.to_plane(last.lat_rad, last.lon_rad)
    assert places[-1][0] == last.time_s
    assert places[-1][1][0][:2] == pytest.approx([east_m / 1000.0, -north_m / 1000.0], abs=1e-4)
    (x, y, z, w) = turns[-1][1][0]
    assert (x, y) == (0.0, 0.0)
    assert np.exp(2j * np.arctan2(z, w)) == pytest.approx(np.exp(1j * last.heading_rad), abs=1e-6)
    assert len(places) == pytest.approx(len(kept_states(flight)) / POSE_STRIDE, abs=3)


def test_the_lanes_tell_phase_stage_and_hazard_when_they_change(workshop, path):
    flight = workshop.fly(workshop.header(workshop.straight))
    hazard = np.zeros(workshop.grid.shape, bool)
    hazard[HAZARD_PLACE] = True
    flight = replace(flight, sheets=[*flight.sheets[:2], *_later(flight.sheets[:2], 200.0, ~hazard)])
    flight = replace(
        flight,
        guidance=[sample._replace(phase=0 if i < 300 else 1) for i, sample in enumerate(flight.guidance)],
    )
    recorded(flight, path)
    states = {
        lane: values(path, f"lanes/{lane}", "StateChange:state") for lane in ("phase", "hazard", "stage")
    }
    assert states["phase"] == [(-30.0, ["lead-in"]), (0.0, ["en route"])]
    assert states["hazard"] == [(-30.0, ["clear"]), (200.0, ["in hazard"])]
    assert states["stage"] == [(-30.0, ["0"]), (200.0, ["9"])]


def _later(sheets, time_s, hazard):
    return [replace(sheet, stage=9, time_s=time_s, hazard=hazard) for sheet in sheets]


def test_each_stage_has_a_picture_in_both_views_and_arrows(workshop, path):
    flight = workshop.fly(workshop.header(workshop.corners, leg_s=400.0))
    recorded(flight, path)
    for entity, component in (
        ("chart/weather", "Image:buffer"),
        ("scene/weather", "GridMap:data"),
        ("chart/wind", "Arrows2D:vectors"),
        ("chart/stage", "Points2D:labels"),
    ):
        assert [time_s for time_s, _ in values(path, entity, component)] == [-30.0, 600.0, 1200.0]
    assert values(path, "chart/stage", "Points2D:labels")[1][1] == ["stage 1: 2022-09-29 00:10 to 00:20 UTC"]


def test_the_arrows_point_downwind_and_are_longer_in_stronger_wind(flight, path):
    recorded(flight, path)
    (_, arrows), *_ = values(path, "chart/wind", "Arrows2D:vectors")
    east, south = np.array(arrows).T
    np.testing.assert_allclose(east, -0.5 * south, atol=1e-4)
    lengths = np.hypot(east, south)
    assert lengths[-1] > lengths[len(lengths) // 2]


def test_the_file_is_partial_until_the_flight_has_ended(flight, path):
    recorder = RerunRecorder(path)
    flight.record(recorder, finish=False)
    assert recorder.partial_path.name == "flight.partial.rrd"
    assert recorder.partial_path.exists()
    assert not path.exists()
    recorder.finish(480.0, Outcome.ARRIVED, "passed Port")
    assert path.exists()
    assert not recorder.partial_path.exists()


def test_an_abandoned_flight_can_be_read_to_its_last_sample(flight, path):
    recorder = RerunRecorder(path)
    flight.record(recorder, finish=False)
    recorder.abandon()
    assert not path.exists()
    speeds = values(recorder.partial_path, "plots/speed", "Scalars:scalars")
    assert speeds[-1][0] == flight.states[-1].time_s
    assert "in flight" in static_text(recorder.partial_path, "card")


@pytest.mark.filterwarnings("ignore:RRD file has no footer")
def test_what_has_been_written_can_be_read_while_the_flight_goes_on(flight, path):
    recorder = RerunRecorder(path)
    flight.record(recorder, finish=False)
    whole_chunks = len(kept_states(flight)) // ROWS_PER_CHUNK
    deadline = time.monotonic() + 20.0  # another thread writes
    rows = []
    while len(rows) < whole_chunks * ROWS_PER_CHUNK and time.monotonic() < deadline:
        with suppress(RuntimeError):  # the reader wants whole frames, and one may be half written
            rows = values(recorder.partial_path, "plots/speed", "Scalars:scalars")
    assert len(rows) == whole_chunks * ROWS_PER_CHUNK
    recorder.abandon()


def test_the_outcome_stands_on_the_card_and_among_the_events(flight, path):
    recorded(replace(flight, outcome=Outcome.CANNOT_FOLLOW), path)
    assert "cannot follow: as it was told" in static_text(path, "card")
    events = values(path, "events", "TextLog:text")
    assert events[0] == (60.0, ["a minute has passed"])
    assert events[-1] == (flight.states[-1].time_s, ["cannot follow: as it was told"])


def test_the_same_moments_stand_on_the_utc_timeline(flight, path):
    recorded(flight, path)
    departure_ns = round(flight.header.plan.departure_s * 1e9)
    for table in tables(path, "plots/wind"):
        since, utc = (table.column(name).cast(pa.int64()).to_numpy() for name in ("flight_time", "utc"))
        np.testing.assert_array_equal(utc, departure_ns + since)


def test_a_recording_is_known_by_scenario_and_seed(workshop, flight, tmp_path):
    headers = flight.header, flight.header, replace(flight.header, seed=8)
    ids = []
    for number, header in enumerate(headers):
        path = recorded(replace(flight, header=header), tmp_path / f"{number}.rrd")
        (entry,) = RrdReader(path).recordings()
        assert entry.application_id == "galeway"
        ids.append(entry.recording_id)
    assert ids[0] == ids[1] != ids[2]


def test_a_blueprint_is_in_the_file(flight, path):
    assert len(RrdReader(recorded(flight, path)).blueprints()) == 1


def test_a_folder_that_is_not_there_is_named(flight, tmp_path):
    recorder = RerunRecorder(tmp_path / "nowhere" / "flight.rrd")
    with pytest.raises(RecordingError, match=r"cannot write .*nowhere.*; record to another folder"):
        recorder.begin(flight.header)
    recorder.abandon()


def test_nothing_can_be_recorded_before_the_beginning_or_after_the_end(flight, path):
    recorder = RerunRecorder(path)
    with pytest.raises(RecordingError, match="make a new recorder"):
        recorder.event(0.0, "too early")
    flight.record(recorder)
    with pytest.raises(RecordingError, match="make a new recorder"):
        recorder.event(500.0, "too late")


def test_the_types_of_a_recording_come_without_rerun():
    program = "import sys, recordings.recorder, recordings.schema; print('rerun' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
