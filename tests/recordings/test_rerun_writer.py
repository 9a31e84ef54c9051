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
from scipy.spatial.transform import Rotation

from recordings.errors import RecordingError
from recordings.limits import judge, parse_limits
from recordings.recorder import Outcome
from recordings.rerun_flight import POSE_STRIDE
from recordings.rerun_plots import ALTITUDE, CROSS_TRACK, LATENESS, LEVELS, plot_titles
from recordings.rerun_scene import curve, south
from recordings.rerun_shown import shown
from recordings.rerun_writer import RerunRecorder
from recordings.samples import MOST
from recordings.tracking import track

HAZARD_PLACE = slice(50, None), slice(70, None)


@pytest.fixture(scope="module")
def flight(kept):
    return kept.fly(kept.header(kept.corners))


@pytest.fixture
def path(tmp_path):
    return tmp_path / "flight.rrd"


@pytest.fixture(scope="module")
def written(flight, kept):
    """The file of the flight."""
    return recorded(flight, kept.folder / "flight.rrd")


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


def test_the_plots_have_one_sample_a_second_as_it_was_sampled(flight, written):
    states = kept_states(flight)
    speeds = values(written, "plots/speed", "Scalars:scalars")
    assert [time_s for time_s, _ in speeds] == [state.time_s for state in states]
    for (_, (ground_mps, air_mps)), state in zip(speeds, states, strict=True):
        assert ground_mps == pytest.approx(np.hypot(state.north_mps, state.east_mps))
        assert air_mps == state.airspeed_mps
    for entity, error in ((CROSS_TRACK, 0.25), (ALTITUDE, -0.5), (LATENESS, 1.5)):
        errors = values(written, entity, "Scalars:scalars")
        assert [time_s for time_s, _ in errors] == [state.time_s for state in states]
        assert {value for _, (value,) in errors} == {error}
    for (_, (gusty_mps, wind_mps)), state in zip(
        values(written, "plots/wind", "Scalars:scalars"), states, strict=True
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


def test_the_flown_line_goes_through_every_kept_position_without_a_gap(flight, written):
    strips = [strip for _, (strip,) in values(written, "chart/flown", "LineStrips2D:strips")]
    assert len(strips) > 2
    for before, after in pairwise(strips):
        assert before[-1] == after[0]
    line = np.concatenate([strips[0], *(strip[1:] for strip in strips[1:])])
    states = kept_states(flight)
    north_m, east_m = flight.header.grid.frame.to_plane(
        np.array([state.lat_rad for state in states]), np.array([state.lon_rad for state in states])
    )
    np.testing.assert_allclose(line, np.column_stack([east_m, -north_m]) / 1000.0, atol=1e-4)


def test_a_line_is_of_the_time_of_its_last_point_so_that_the_track_never_runs_ahead(flight, written):
    last_s = -np.inf
    for time_s, _ in values(written, "scene/flown", "LineStrips3D:strips"):
        assert time_s > last_s
        last_s = time_s
    assert last_s == flight.states[-1].time_s


def test_the_mark_of_the_aircraft_ends_where_the_flight_ends_and_points_along_it(flight, written):
    places = values(written, "chart/aircraft", "Transform3D:translation")
    turns = values(written, "chart/aircraft", "Transform3D:quaternion")
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
    assert states["phase"] == [(-30.0, ["lead-in"]), (0.0, ["legs"])]
    assert states["hazard"] == [(-30.0, ["clear"]), (200.0, ["hazard"])]
    assert states["stage"] == [(-30.0, ["0"]), (200.0, ["9"])]


def _later(sheets, time_s, hazard):
    return [replace(sheet, stage=9, time_s=time_s, hazard=hazard) for sheet in sheets]


def test_each_stage_has_its_layers_in_both_views(workshop, path):
    flight = workshop.fly(workshop.header(workshop.corners, leg_s=400.0))
    recorded(flight, path)
    for layer in ("truth", "forecast", "difference"):
        for entity, component in (
            (f"chart/weather/{layer}/picture", "Image:buffer"),
            (f"scene/weather/{layer}/picture", "Mesh3D:albedo_texture_buffer"),
        ):
            assert [time_s for time_s, _ in values(path, entity, component)] == [-30.0, 600.0, 1200.0]
    for layer in ("truth", "forecast"):
        for entity, component in (
            (f"chart/weather/{layer}/arrows", "Arrows2D:vectors"),
            (f"chart/weather/{layer}/edge", "LineStrips2D:strips"),
            (f"scene/weather/{layer}/edge", "LineStrips3D:strips"),
        ):
            assert [time_s for time_s, _ in values(path, entity, component)] == [-30.0, 600.0, 1200.0]
    assert values(path, "chart/stage", "Points2D:labels")[1][1] == [
        "stage 1: 2022-09-29 00:10 to 00:20 UTC, wind at 1000 m as forecast"
    ]


@pytest.mark.parametrize("layer", ["truth", "forecast"])
def test_the_arrows_point_downwind_and_are_longer_in_stronger_wind(written, layer):
    (_, arrows), *_ = values(written, f"chart/weather/{layer}/arrows", "Arrows2D:vectors")
    east, south = np.array(arrows).T
    np.testing.assert_allclose(east, -0.5 * south, atol=1e-4)
    lengths = np.hypot(east, south)
    assert lengths[-1] > lengths[len(lengths) // 2]


def test_an_arrow_lies_with_its_middle_on_its_cell(flight, written):
    (_, begins), *_ = values(written, "chart/weather/truth/arrows", "Arrows2D:origins")
    (_, arrows), *_ = values(written, "chart/weather/truth/arrows", "Arrows2D:vectors")
    middles = np.array(begins) + np.array(arrows) / 2.0
    grid = flight.header.grid
    lat_rad, lon_rad = grid.frame.to_geodetic(-1000.0 * middles[:, 1], 1000.0 * middles[:, 0])
    rows, columns = grid.indices(lat_rad, lon_rad)
    np.testing.assert_allclose(rows, np.rint(rows), atol=1e-3)
    np.testing.assert_allclose(columns, np.rint(columns), atol=1e-3)
    assert len(set(zip(np.rint(rows), np.rint(columns), strict=True))) == len(arrows)


def test_the_aircraft_banks_and_pitches_with_its_attitude(flight, written):
    """Nose and right wing against the aerospace rotation from body axes to north-east-down, by matrix."""
    states = {state.time_s: state for state in flight.states}
    turns = values(written, "scene/aircraft", "Transform3D:quaternion")
    assert len(turns) == len(values(written, "chart/aircraft", "Transform3D:quaternion"))
    for time_s, (quaternion,) in turns:
        state = states[time_s]
        body_to_ned = Rotation.from_euler("ZYX", [state.heading_rad, state.pitch_rad, state.roll_rad])
        turn = Rotation.from_quat(quaternion)
        for forward_left_up, forward_right_down in (
            ((1.0, 0.0, 0.0), (1.0, 0.0, 0.0)),
            ((0.0, -1.0, 0.0), (0.0, 1.0, 0.0)),
        ):
            north, east, down = body_to_ned.apply(forward_right_down)
            assert turn.apply(forward_left_up) == pytest.approx((east, north, -down), abs=1e-5)
    assert np.ptp([state.roll_rad for state in flight.states]) > 0.1


def test_limits_are_drawn_as_bands_from_end_to_end(workshop, path):
    limits = ("cross_track_m.p95 <= 2", "cross_track_m.max <= 7.5", "waypoint_time_error_s.p95 <= 5")
    flight = workshop.fly(replace(workshop.header(workshop.straight), limits=limits))
    recorded(flight, path)
    ends_s = flight.header.reference.start_time_s[0], flight.header.reference.end_time_s[-1]
    for entity, levels in (
        (CROSS_TRACK, [2.0, -2.0, 7.5, -7.5, 10.0, -10.0]),  # the last two make room
        (LATENESS, [5.0, -5.0, 10.0, -10.0]),
        ("plots/speed", [20.0, 40.0, 18.0, 44.0]),
        ("plots/wind", [15.0, 18.0]),
    ):
        drawn = values(path, f"{entity}/limits", "Scalars:scalars")
        assert [time_s for time_s, _ in drawn] == list(ends_s)
        assert [found for _, found in drawn] == [pytest.approx(levels)] * 2
    _, (_, levels) = values(path, f"{ALTITUDE}/limits", "Scalars:scalars")
    assert levels == [1.0, -1.0]  # no limit, room for numbers alone


def test_titles_say_between_what_a_flight_is_to_stay(workshop):
    limits = ("cross_track_m.p95 <= 2", "cross_track_m.max <= 7.5", "altitude_error_m always >= -5")
    titles = plot_titles(replace(workshop.header(workshop.straight), limits=limits))
    assert titles[CROSS_TRACK].endswith("[m], limit 2, 7.5")
    assert titles[ALTITUDE].endswith("[m], limit -5")
    assert titles[LATENESS].endswith("[s]")


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
    written = len(kept_states(replace(flight, states=flight.states[:MOST])))
    assert 0 < written < len(kept_states(flight))
    deadline = time.monotonic() + 20.0  # another thread writes
    rows = []
    while len(rows) < written and time.monotonic() < deadline:
        with suppress(RuntimeError):  # the reader wants whole frames, and one may be half written
            rows = values(recorder.partial_path, "plots/speed", "Scalars:scalars")
    assert len(rows) == written
    recorder.abandon()


def test_the_outcome_stands_on_the_card_and_among_the_events(flight, path):
    recorded(replace(flight, outcome=Outcome.CANNOT_FOLLOW), path)
    assert "**cannot follow**: as it was told" in static_text(path, "card")
    events = values(path, "events", "TextLog:text")
    assert events[0] == (60.0, ["a minute has passed"])
    assert events[-1] == (flight.states[-1].time_s, ["cannot follow: as it was told"])


def test_the_verdicts_of_a_flight_that_is_judged_finish_its_file(workshop, flight, path):
    recorder = RerunRecorder(path, judged=True)
    flight.record(recorder)
    assert recorder.partial_path.exists()
    verdicts = judge(track(workshop.recording(flight)), parse_limits(["arrived == true", "holds >= 1"]))
    recorder.verdicts(verdicts)
    assert path.exists()
    assert not recorder.partial_path.exists()
    done = subprocess.run(
        [sys.executable, "-m", "rerun", "rrd", "verify", path], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "1 of 2 limits hold" in static_text(path, "verdicts")
    assert "as it was told" in static_text(path, "card")
    events = [text for _, (text,) in values(path, "events", "TextLog:text")]
    assert events[-2:] == [str(verdict) for verdict in verdicts]
    assert [level for _, (level,) in values(path, "events", "TextLog:level")][-2:] == ["INFO", "ERROR"]


def test_a_flight_that_could_not_be_judged_is_left_readable_to_its_end(flight, path):
    recorder = RerunRecorder(path, judged=True)
    flight.record(recorder)
    recorder.abandon()
    assert not path.exists()
    assert values(recorder.partial_path, "plots/speed", "Scalars:scalars")[-1][0] == flight.states[-1].time_s
    assert "arrived" in static_text(recorder.partial_path, "card")
    assert "judged after the flight" in static_text(recorder.partial_path, "verdicts")


def test_the_same_moments_stand_on_the_utc_timeline(flight, written):
    departure_ns = round(flight.header.plan.departure_s * 1e9)
    for table in tables(written, "plots/wind"):
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


def test_a_blueprint_is_in_the_file(written):
    assert len(RrdReader(written).blueprints()) == 1


def test_a_flight_that_changes_level_has_a_plot_of_its_altitude(flight, workshop, written, path):
    climbing = tuple(
        replace(point, altitude_m=1000.0 if index < 3 else 1500.0)
        for index, point in enumerate(flight.header.plan.waypoints)
    )
    changing = replace(
        flight, header=replace(flight.header, plan=replace(flight.header.plan, waypoints=climbing))
    )
    recorded(changing, path)
    altitudes = values(path, LEVELS, "Scalars:scalars")
    wanted = [(state.time_s, [1000.0, state.altitude_m]) for state in kept_states(flight)]
    assert altitudes == wanted
    assert LEVELS in origins(path)
    (label,) = values(path, "chart/stage", "Points2D:labels")[0][1]
    assert label.endswith("UTC, wind at 1000 m as forecast")
    mcap = workshop.file(changing)
    with shown([mcap], pytest.fail) as drawn:
        assert values(drawn, LEVELS, "Scalars:scalars") == altitudes
        assert origins(drawn) == origins(path)
    assert not values(written, LEVELS, "Scalars:scalars")
    assert origins(written) == origins(path) - {LEVELS}


def origins(path):
    """The entities that views of a file's blueprint show."""
    (entry,) = RrdReader(path).blueprints()
    found = set()
    for chunk in RrdReader(path).stream(store=entry):
        table = chunk.to_record_batch()
        for name in table.schema.names:
            if name.endswith("ViewBlueprint:space_origin"):
                found |= {origin.lstrip("/") for (origin,) in table.column(name).to_pylist()}
    return found


def test_of_a_late_flight_the_axes_and_the_limits_reach_to_its_end(workshop, path):
    flight = workshop.fly(workshop.header(workshop.straight), late_s=90.0)
    recorded(flight, path)
    end_s = flight.states[-1].time_s
    assert end_s == pytest.approx(flight.header.plan.duration_s + 90.0)
    assert values(path, f"{CROSS_TRACK}/limits", "Scalars:scalars")[-1][0] == end_s
    planned_s, widened_s = sorted(axis_end_s(path, entry) for entry in RrdReader(path).blueprints())
    assert planned_s < end_s <= widened_s


def axis_end_s(path, blueprint):
    """The greatest end of a time axis in a blueprint."""
    ends = []
    for chunk in RrdReader(path).stream(store=blueprint):
        table = chunk.to_record_batch()
        for name in table.schema.names:
            if name.endswith("TimeAxis:view_range"):
                ends += [view["end"] for (view,) in table.column(name).to_pylist()]
    return max(end / 1e9 for end in ends)


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


def test_the_reference_that_is_drawn_is_the_one_that_is_followed(workshop, path):
    flight = workshop.fly_and_hold(workshop.header(workshop.straight), 70.0, 100.0)
    recorded(flight, path)
    drawn = values(path, "chart/reference", "LineStrips2D:strips")
    written = [(-30.0, flight.header.reference), *flight.relaid]
    assert [time_s for time_s, _ in drawn] == [time_s for time_s, _ in written]
    for (_, (strip,)), (_, reference) in zip(drawn, written, strict=True):
        np.testing.assert_allclose(strip, south(curve(reference)), atol=1e-5)
