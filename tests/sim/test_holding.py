"""Flights that come too early: they hold where that is safe, and only there."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from planner.grid import Grid
from planner.hazards import StageClock, hazard_stages
from planner.windfield import WindField
from recordings.mcap_reader import read
from recordings.mcap_writer import McapRecorder
from recordings.recorder import Outcome
from recordings.tracking import track
from sim.closed_loop import fly
from sim.holding import SafePlaces
from sim.scenario import load_scenario

NORTH = Path(__file__).parent / "scenarios" / "north.toml"
TAILWIND_MPS = 17.0
CALM_S = 700.0  # from here on the wind is as forecast


def ignore(_):
    pass


@pytest.fixture
def early(ready):
    """Straight north, in a truth that blows from behind, where the forecast blows against; then as that."""

    def made(*overrides, until_s=CALM_S):
        setup = ready("turbulence.kind=none", *overrides, scenario=NORTH)
        truth, departure_s = setup.truth, setup.header.plan.departure_s
        marks = departure_s + np.array([until_s, until_s + 60.0])
        time_s = np.union1d(truth.time_s, marks)
        share = np.interp(time_s, marks, [1.0, 0.0])[:, np.newaxis, np.newaxis]
        north, east = (np.stack(sheets) for sheets in zip(*map(truth.sheet, time_s), strict=True))
        north, east = (1.0 - share) * north + share * TAILWIND_MPS, (1.0 - share) * east
        return replace(setup, truth=replace(truth, time_s=time_s, north_mps=north, east_mps=east))

    return made


def never(setup):
    """The same flight with a forecast that is hazardous everywhere, for holding."""
    places = setup.holding.places
    setup.holding.places = replace(places, hazard=np.ones_like(places.hazard))
    return setup


def test_a_flight_too_early_holds_and_is_on_time_again(early, kept):
    setup = early()
    end = fly(setup, kept, ignore)
    assert end.outcome is Outcome.ARRIVED
    ((time_s, reference),) = kept.references
    told = [(when_s, text) for when_s, text in kept.events if "holding" in text]
    assert [when_s for when_s, _ in told] == [time_s]
    assert told[0][1].startswith("schedule: early by 1")
    assert "s at the slowest, holding 1 lap of 1" in told[0][1]
    loiters = [(when_s, text) for when_s, text in kept.events if text.startswith("loiter")]
    assert [text for _, text in loiters] == ["loiter begins", "loiter ends"]
    held_s = loiters[1][0] - loiters[0][0]
    assert 100.0 < held_s < 200.0
    assert end.time_s == pytest.approx(setup.header.plan.duration_s, abs=1.0)
    assert setup.guidance.reference is reference
    errors = [(state.time_s, guidance.time_error_s) for state, guidance in kept.samples]
    before_s = [late_s for when_s, late_s in errors if 0.0 <= when_s < time_s]
    after_s = [late_s for when_s, late_s in errors if when_s > loiters[1][0] + 120.0]
    assert min(before_s) < -100.0
    assert max(map(abs, after_s)) < 2.0
    assert np.abs([guidance.cross_track_m for _, guidance in kept.samples]).max() < 3.0


def test_the_recording_shows_the_hold_and_is_the_same_to_the_byte(early, tmp_path):
    paths = [tmp_path / "one.mcap", tmp_path / "two.mcap"]
    for path in paths:
        fly(early(), McapRecorder(path), ignore)
    assert paths[0].read_bytes() == paths[1].read_bytes()
    recording = read(paths[0])
    report = track(recording)
    assert report.arrived
    assert report.holds == 1
    assert abs(report.delay_s) < 1.0
    assert report.waypoints_missed == 0
    late_s = report.series.waypoint_time_error_s
    passed_s = report.series.waypoint_time_s + late_s
    issued_s = recording.references[1].time_s
    assert (late_s[passed_s < issued_s][1:] < -10.0).all()
    following = passed_s > max(issued_s, CALM_S) + 240.0
    assert following.sum() >= 8
    assert np.abs(late_s[following]).max() < 1.0
    assert report.cross_track_m.max < 3.0


def test_where_the_forecast_is_hazardous_it_does_not_hold_and_says_that_it_is_early(early, kept):
    end = fly(never(early(until_s=4000.0)), kept, ignore)
    assert end.outcome is Outcome.ARRIVED
    assert kept.references == []
    assert not any("holding" in text or text.startswith("loiter") for _, text in kept.events)
    assert any(text.startswith("schedule: at the slowest, early by 3") for _, text in kept.events)
    assert kept.samples[-1][1].time_error_s < -300.0


def test_it_holds_as_often_as_it_is_too_early(early, kept):
    setup = early(until_s=4000.0)
    end = fly(setup, kept, ignore)
    assert end.outcome is Outcome.ARRIVED
    assert len(kept.references) == 3
    assert min(guidance.time_error_s for _, guidance in kept.samples) > -160.0


def test_a_corridor_too_narrow_for_a_circle_is_no_place_to_hold(early, kept):
    end = fly(early("hazard.corridor_m=500"), kept, ignore)
    assert end.outcome is Outcome.ARRIVED
    assert min(guidance.time_error_s for _, guidance in kept.samples) < -150.0
    assert kept.references == []


def test_with_gps_sensors_it_holds_too(early, tmp_path):
    path = tmp_path / "flight.mcap"
    end = fly(early("flight.sensors=gps"), McapRecorder(path), ignore)
    assert end.outcome is Outcome.ARRIVED
    report = track(read(path))
    assert report.arrived
    assert report.holds == 1
    assert report.waypoints_missed == 0
    assert abs(report.delay_s) < 3.0
    assert report.cross_track_m.max < 8.0


def test_a_flight_on_time_never_asks(ready, kept):
    setup = ready()

    def unasked(*_):
        raise AssertionError("asked on time")

    setup.holding.decide = unasked
    assert fly(setup, kept, ignore).outcome is Outcome.ARRIVED


GRID = Grid.covering(
    math.radians(29.0), math.radians(29.3), math.radians(-90.3), math.radians(-90.0), rows=11, columns=11
)
CORRIDOR_M = 1100.0
CLOCK = StageClock(0.0, stage_count=3, steps_per_stage=5, step_s=120.0)


@pytest.fixture(scope="module")
def stormy():
    """A wind that changes from cell to cell, and the places where its forecast lets an aircraft hold."""
    random = np.random.default_rng(4)
    north, east = random.uniform(-11.0, 11.0, (2, 4, *GRID.shape))
    wind = WindField(GRID, CLOCK.stage_s * np.arange(4.0), north, east)
    hazard = hazard_stages(wind, CLOCK, threshold_mps=12.5, corridor_m=CORRIDOR_M)
    return wind, SafePlaces(GRID, CLOCK, hazard)


def test_where_it_may_hold_no_wind_in_the_corridor_is_above_the_threshold(stormy):
    wind, places = stormy
    random, frame, allowed = np.random.default_rng(1), GRID.frame, 0
    for _ in range(400):
        row, column = random.uniform(0.0, 10.0, 2)
        lat_rad = GRID.south_rad + row * GRID.north_step_rad
        lon_rad = GRID.west_rad + column * GRID.east_step_rad
        north_m, east_m = frame.to_plane(lat_rad, lon_rad)
        begin_s, lasting_s = random.uniform(0.0, 1500.0), random.uniform(60.0, 300.0)
        if not places.may_hold(begin_s, north_m, east_m, begin_s + lasting_s):
            continue
        allowed += 1
        scale = frame.scale(lat_rad)
        for time_s in np.linspace(begin_s, begin_s + lasting_s, 4):
            off_m = random.uniform(-0.995, 0.995, (6, 2)) * CORRIDOR_M * scale
            for north_off_m, east_off_m in off_m:
                where = frame.to_geodetic(north_m + north_off_m, east_m + east_off_m)
                if inside(*where):
                    north, east, _ = wind.at(time_s, *where, 1000.0)
                    assert math.hypot(north, east) <= 12.5 + 1e-6
    assert 20 < allowed < 380


def inside(lat_rad, lon_rad):
    row, column = GRID.indices(lat_rad, lon_rad)
    return 0.0 <= row <= GRID.rows - 1 and 0.0 <= column <= GRID.columns - 1


def place(row, column):
    return GRID.frame.to_plane(
        GRID.south_rad + row * GRID.north_step_rad, GRID.west_rad + column * GRID.east_step_rad
    )


def test_each_of_the_cells_around_a_place_counts_in_each_stage_of_the_hold():
    def may(row, column, *hazards, times=(700.0, 900.0)):
        hazard = np.zeros((3, *GRID.shape), bool)
        for cell in hazards:
            hazard[cell] = True
        return SafePlaces(GRID, CLOCK, hazard).may_hold(times[0], *place(row, column), times[1])

    assert may(4.5, 5.5)
    for cell in ((4, 5), (5, 5), (4, 6), (5, 6)):
        assert not may(4.5, 5.5, (1, *cell))
        assert may(4.5, 5.5, (0, *cell), (2, *cell))
        assert not may(4.5, 5.5, (2, *cell), times=(1100.0, 1300.0))
    assert may(4.5, 5.5, (1, 6, 5), (1, 4, 7), (1, 3, 5))
    assert may(4.0, 5.5, (1, 3, 5), (1, 5, 5))  # between two cells only these count
    assert not may(4.0, 5.5, (1, 4, 6))
    assert may(4.0, 5.0, (1, 4, 6))
    assert not may(4.0, 5.0, (1, 4, 5))


@pytest.mark.parametrize("where", [(-0.5, 5.0), (10.5, 5.0), (5.0, -0.5), (5.0, 10.5)])
def test_beyond_the_grid_or_the_forecast_there_is_no_place_to_hold(where):
    safe = SafePlaces(GRID, CLOCK, np.zeros((3, *GRID.shape), bool))
    assert not safe.may_hold(0.0, *place(*where), 100.0)
    assert safe.may_hold(1700.0, *place(5.0, 5.0), 1800.0)
    assert not safe.may_hold(1700.0, *place(5.0, 5.0), 1801.0)


def test_circles_fit_the_corridor_and_the_aircraft(ready):
    limits = ready("hazard.corridor_m=900").holding.limits
    assert limits.radius_max_m == 450.0
    assert ready("aircraft.loiter_radius_m=400").holding.limits.radius_max_m == 400.0
    assert load_scenario(str(NORTH), ()).scenario.hazard.corridor_m == 1100.0
