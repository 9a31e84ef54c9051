"""The closed loop on the real aircraft: it arrives, and each thing that can end a flight ends it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from recordings.recorder import Layer, Outcome
from sim.closed_loop import fly
from sim.wind_ahead import WIND_RAMP_S

TANK = "propulsion/tank/contents-lbs"


def ignore(_):
    pass


def test_it_arrives_on_the_path_and_on_time(ready, kept):
    setup = ready()
    end = fly(setup, kept, ignore)
    assert end.outcome is Outcome.ARRIVED
    assert end.time_s == pytest.approx(setup.header.plan.duration_s, abs=5.0)
    assert kept.end == (end.time_s, end.outcome, end.detail)
    assert kept.header is setup.header
    assert not kept.abandoned
    flown = [(state, guidance) for state, guidance in kept.samples if state.time_s >= 0.0]
    assert np.percentile([abs(guidance.cross_track_m) for _, guidance in flown], 95) < 2.0
    assert np.percentile([abs(guidance.altitude_error_m) for _, guidance in flown], 95) < 3.0
    times_s = [state.time_s for state, _ in kept.samples]
    assert times_s[0] == -setup.lead_in_s
    assert np.diff(times_s) == pytest.approx(0.1)
    assert kept.events[0][1].startswith("departure")


def test_the_wind_that_is_flown_in_is_the_truth_at_the_aircraft(ready, kept):
    setup = ready("turbulence.kind=none")
    fly(setup, kept, ignore)
    departure_s = setup.header.plan.departure_s
    for state, _ in kept.samples[len(kept.samples) // 2 :: 500]:
        north, east, _ = setup.truth.at(
            departure_s + state.time_s, state.lat_rad, state.lon_rad, state.altitude_m
        )
        assert (state.wind_north_mps, state.wind_east_mps) == pytest.approx((north, east), abs=1e-3)
        ground = state.north_mps - north, state.east_mps - east, state.down_mps
        assert state.airspeed_mps == pytest.approx(math.hypot(*ground), abs=0.05)
    assert kept.samples[1][0].time_s < -setup.lead_in_s + WIND_RAMP_S
    assert math.hypot(kept.samples[1][0].wind_north_mps, kept.samples[1][0].wind_east_mps) < 0.2


def test_each_stage_is_recorded_in_both_layers_before_its_samples(ready, kept):
    setup = ready("stages.count=3", "stages.steps=5")
    fly(setup, kept, ignore)
    assert [(sheet.stage, sheet.layer) for _, sheet in kept.sheets][:4] == [
        (0, Layer.FORECAST),
        (0, Layer.TRUTH),
        (1, Layer.FORECAST),
        (1, Layer.TRUTH),
    ]
    for samples_before, sheet in kept.sheets:
        assert samples_before == 0 or kept.samples[samples_before - 1][0].time_s < sheet.time_s


def test_the_same_seed_gives_the_same_flight_and_another_does_not(ready, kept):
    """For the first minutes, until a fault ends the flight."""
    flights = []
    for seed in (3, 3, 4):
        recorder = type(kept)()
        fly(ready(f"seed={seed}", 'faults=[{kind="state_nan", time_s=200}]'), recorder, ignore)
        assert len(recorder.samples) > 2000
        flights.append(recorder.samples)
    assert flights[0] == flights[1]
    assert flights[0] != flights[2]


def test_gps_sensors_hold_the_path_on_true_state(ready, kept):
    setup = ready("flight.sensors=gps")
    end = fly(setup, kept, ignore)
    assert end.outcome is Outcome.ARRIVED
    every = setup.sample_hz // setup.guidance_hz  # the first round has no fix yet
    assert [seen.time_s for seen in kept.seen] == [state.time_s for state, _ in kept.samples[every::every]]
    frame, reference = setup.header.grid.frame, setup.header.reference
    states = [state for state, _ in kept.samples if state.time_s >= 0.0]
    time_s, lat_rad, lon_rad, altitude_m = np.array([state[:4] for state in states]).T
    path_m, cross_track_m = reference.project_many(
        *frame.to_plane(lat_rad, lon_rad), reference.path_at_times(time_s)
    )
    assert np.percentile(np.abs(cross_track_m), 95) < 3.0
    assert np.abs(cross_track_m).max() < 8.0
    off_m = np.abs(altitude_m - reference.at_many(path_m).altitude_m)
    assert np.percentile(off_m, 95) < 4.0
    assert path_m[-1] >= reference.waypoint_path_m[-1] - 0.1
    believed_m = np.array([guidance.cross_track_m for _, guidance in kept.samples])[-len(time_s) :]
    assert 0.1 < np.std(believed_m - cross_track_m) < 1.5


def test_perfect_sensors_leave_nothing_to_estimate(ready, kept):
    setup = ready("mission.altitude_m=60")
    fly(with_truth(setup, down_mps=np.full_like(setup.truth.north_mps, 12.0)), kept, ignore)
    assert kept.samples
    assert kept.seen == []


def with_truth(setup, **changes):
    return replace(setup, truth=replace(setup.truth, **changes))


def test_wind_that_ends_early_ends_the_flight(ready, kept):
    setup = ready()
    short = np.array([0.0, 300.0]) + setup.header.plan.departure_s
    truth = setup.truth
    setup = with_truth(setup, time_s=short, north_mps=truth.north_mps[:2], east_mps=truth.east_mps[:2])
    end = fly(setup, kept, ignore)
    assert end.outcome is Outcome.LEFT_WEATHER
    assert end.time_s == pytest.approx(300.0, abs=0.2)
    assert "time" in end.detail


def with_gale(setup, speed_mps, begin_s, duration_s, ramp_s=60.0):
    """The truth, with a wind toward the east in its place, brought in and out over a minute."""
    truth = setup.truth
    marks = np.array([0.0, ramp_s, ramp_s + duration_s, 2.0 * ramp_s + duration_s])
    marks += begin_s + setup.header.plan.departure_s
    time_s = np.union1d(truth.time_s, marks)
    share = np.interp(time_s, marks, [0.0, 1.0, 1.0, 0.0])[:, np.newaxis, np.newaxis]
    north, east = (np.stack(sheets).astype(float) for sheets in zip(*map(truth.sheet, time_s), strict=True))
    north, east = (1.0 - share) * north, (1.0 - share) * east + share * speed_mps
    return with_truth(setup, time_s=time_s, north_mps=north, east_mps=east)


def test_wind_above_the_airspeed_for_ten_minutes_is_survived(ready, kept):
    setup = with_gale(ready(), 48.0, 100.0, 600.0)
    end = fly(setup, kept, ignore)
    assert end.outcome is Outcome.ARRIVED
    wind_mps = np.array([math.hypot(state.wind_north_mps, state.wind_east_mps) for state, _ in kept.samples])
    excess_m = np.maximum(wind_mps - setup.guidance.envelope.airspeed_max_mps, 0.0).sum() * 0.1
    off_m = np.abs([guidance.cross_track_m for _, guidance in kept.samples])
    assert excess_m > 4000.0
    assert off_m.max() < excess_m + 0.5 * 600.0  # half a metre a second for turbulence
    assert np.abs([guidance.altitude_error_m for _, guidance in kept.samples]).max() < 150.0
    back_s = next(time_s for time_s, text in kept.events if text == "back on the path")
    after = np.array([state.time_s for state, _ in kept.samples]) > back_s + 20.0
    assert after.sum() > 1000
    assert np.percentile(off_m[after], 95) < 1.0
    told = [text.split(":")[0] for _, text in kept.events if not text.startswith(("schedule", "departure"))]
    assert told == ["wind above airspeed", "wind below airspeed", "back on the path"]
    assert any("at the fastest, late by" in text for _, text in kept.events)


def test_a_gale_that_does_not_end_blows_the_flight_out_of_its_weather(ready, kept):
    end = fly(with_gale(ready(), 75.0, 100.0, 6500.0), kept, ignore)
    assert end.outcome is Outcome.LEFT_WEATHER
    assert any(text.startswith("wind above airspeed") for _, text in kept.events)


def test_a_flight_too_far_off_its_path_in_wind_that_can_be_flown_in_is_given_up(ready, kept):
    end = fly(ready("flight.off_path_limit_m=0.7", "turbulence.severity=5"), kept, ignore)
    assert end.outcome is Outcome.CANNOT_FOLLOW
    assert "limit 0.7 m" in end.detail


def test_a_downdraught_into_the_ground_is_a_crash(ready, kept):
    setup = ready("mission.altitude_m=60")
    end = fly(with_truth(setup, down_mps=np.full_like(setup.truth.north_mps, 12.0)), kept, ignore)
    assert end.outcome is Outcome.CRASHED


def test_numbers_that_are_not_finite_end_the_flight(ready, kept):
    setup = ready()

    def spoil(time_s):
        if time_s >= 30.0:
            setup.aircraft._fdm[TANK] = math.nan

    end = fly(setup, kept, spoil)
    assert end.outcome is Outcome.NOT_FINITE
    assert end.time_s == pytest.approx(30.0, abs=0.3)
    assert "fuel_kg" in end.detail
    assert all(math.isfinite(value) for state, _ in kept.samples for value in state)


def test_an_error_in_the_loop_abandons_the_recording(ready, kept):
    def interrupt(time_s):
        if time_s > 10.0:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fly(ready(), kept, interrupt)
    assert kept.abandoned
    assert kept.end is None
    assert kept.samples
