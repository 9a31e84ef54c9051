"""Guidance on a point mass that answers bank and airspeed with a lag: what the laws do, apart from JSBSim."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest

from aircraft.envelope import Envelope
from aircraft.guidance import Gains, Guidance, Progress
from aircraft.reference import PathPoint, Phase, Reference
from aircraft.state import Command, FlightState

ENVELOPE = Envelope(
    airspeed_min_mps=20.0,
    airspeed_max_mps=41.0,
    cruise_mps=27.0,
    climb_max_mps=3.0,
    descent_max_mps=3.0,
    bank_max_rad=math.radians(35.0),
    ceiling_m=2000.0,
)
GRAVITY_MPS2 = 9.80665
ROLL_LAG_S, AIRSPEED_LAG_S, CLIMB_LAG_S = 0.35, 2.0, 1.0

Wind = Callable[[float], tuple[float, float]]  # time_s -> toward (north_mps, east_mps)


@dataclass
class PointMass:
    """Coordinated flight through moving air, integrated at 60 Hz; positions in a plane of the given scale."""

    north_m: float
    east_m: float
    altitude_m: float
    heading_rad: float
    airspeed_mps: float
    time_s: float
    scale: float = 1.0
    roll_rad: float = 0.0
    climb_mps: float = 0.0

    def fly(self, command: Command, wind: Wind, seconds: float) -> None:
        for _ in range(round(seconds * 60.0)):
            self.roll_rad += (command.roll_rad - self.roll_rad) / ROLL_LAG_S / 60.0
            self.airspeed_mps += (command.airspeed_mps - self.airspeed_mps) / AIRSPEED_LAG_S / 60.0
            self.heading_rad += GRAVITY_MPS2 * math.tan(self.roll_rad) / self.airspeed_mps / 60.0
            climb_mps = command.climb_mps + 0.7 * (command.altitude_m - self.altitude_m)
            self.climb_mps += (min(max(climb_mps, -5.0), 5.0) - self.climb_mps) / CLIMB_LAG_S / 60.0
            north_mps, east_mps = self.velocity(wind)
            self.north_m += north_mps * self.scale / 60.0
            self.east_m += east_mps * self.scale / 60.0
            self.altitude_m += self.climb_mps / 60.0
            self.time_s += 1.0 / 60.0

    def velocity(self, wind: Wind) -> tuple[float, float]:
        wind_north_mps, wind_east_mps = wind(self.time_s)
        return (
            self.airspeed_mps * math.cos(self.heading_rad) + wind_north_mps,
            self.airspeed_mps * math.sin(self.heading_rad) + wind_east_mps,
        )

    def state(self, wind: Wind) -> FlightState:
        known = dict.fromkeys(FlightState._fields, 0.0)
        known["north_mps"], known["east_mps"] = self.velocity(wind)
        known["wind_north_mps"], known["wind_east_mps"] = wind(self.time_s)
        for name in ("time_s", "altitude_m", "heading_rad", "airspeed_mps", "roll_rad"):
            known[name] = getattr(self, name)
        return FlightState(**known)


def flat(*waypoints: tuple[float, float, float]) -> list[PathPoint]:
    return [PathPoint(north_m, east_m, 1000.0, time_s, 1.0) for north_m, east_m, time_s in waypoints]


def lay(points: list[PathPoint], wind: Wind) -> Reference:
    return Reference.through(
        points,
        turn_radius_m=300.0,
        loiter_radius_m=550.0,
        lead_in_s=30.0,
        wind_at=lambda _north_m, _east_m, time_s: wind(time_s),
        loiter_airspeed_mps=27.0,
    )


def on_lead_in(reference: Reference, right_m: float = 0.0, turned_rad: float = 0.0) -> PointMass:
    start = reference.at(0.0)
    return PointMass(
        start.north_m - right_m * start.scale * math.sin(start.course_rad),
        start.east_m + right_m * start.scale * math.cos(start.course_rad),
        start.altitude_m,
        start.course_rad + turned_rad,
        28.0,
        start.time_s,
        start.scale,
    )


@dataclass
class Flown:
    progress: list[Progress]
    commands: list[Command]
    time_s: list[float]

    def after(self, time_s: float, field: str) -> np.ndarray:
        rows = zip(self.time_s, self.progress, strict=True)
        return np.array([getattr(progress, field) for time, progress in rows if time >= time_s])


def follow(reference: Reference, plant: PointMass, wind: Wind, until_s: float) -> Flown:
    guidance = Guidance(reference, ENVELOPE)
    flown = Flown([], [], [])
    while plant.time_s < until_s:
        command, progress = guidance.update(
            plant.state(wind), plant.north_m, plant.east_m, plant.scale, *wind(plant.time_s)
        )
        flown.progress.append(progress)
        flown.commands.append(command)
        flown.time_s.append(plant.time_s)
        plant.fly(command, wind, 0.1)
    return flown


def calm(_time_s: float) -> tuple[float, float]:
    return 0.0, 0.0


def breeze(_time_s: float) -> tuple[float, float]:
    return 7.0, -6.0


def turning_wind(time_s: float) -> tuple[float, float]:
    return 8.5 * math.cos(time_s / 400.0), 8.5 * math.sin(time_s / 400.0)


STAIRCASE = flat(
    (0, 0, 0), (3600, 0, 120), (3600, 3600, 240), (7200, 3600, 360), (7200, 0, 480), (7200, -3600, 600)
)


@pytest.mark.parametrize("wind", [calm, breeze, turning_wind])
def test_a_staircase_is_followed_closely_and_on_time(wind: Wind) -> None:
    reference = lay(STAIRCASE, wind)
    flown = follow(reference, on_lead_in(reference), wind, 600.0)
    assert np.abs(flown.after(0.0, "cross_track_m")).max() < 1.0
    assert np.abs(flown.after(0.0, "time_error_s")).max() < 2.5
    passed_s = np.interp(reference.waypoint_path_m[1:-1], flown.after(-30.0, "path_m"), flown.time_s)
    assert np.abs(passed_s - [120.0, 240.0, 360.0, 480.0]).max() < 1.5


def test_a_loiter_in_wind_is_followed_and_left_on_time() -> None:
    points = flat((0, 0, 0), (3600, 0, 120), (3600, 0, 240), (3600, 0, 360), (3600, 3600, 480))
    reference = lay(points, breeze)
    flown = follow(reference, on_lead_in(reference), breeze, 480.0)
    assert Phase.LOITER in flown.after(0.0, "phase")
    assert np.abs(flown.after(0.0, "cross_track_m")).max() < 1.0
    assert np.abs(flown.after(120.0, "time_error_s")).max() < 3.0


def test_a_reversal_and_a_wait_in_a_corner_are_followed() -> None:
    points = flat((0, 0, 0), (3600, 0, 120), (0, 0, 240), (0, 0, 360), (0, 3600, 480))
    reference = lay(points, breeze)
    flown = follow(reference, on_lead_in(reference), breeze, 480.0)
    assert np.abs(flown.after(0.0, "cross_track_m")).max() < 1.5
    assert np.abs(flown.after(0.0, "time_error_s")).max() < 3.0


def test_a_stretched_plane_makes_no_difference() -> None:
    points = [PathPoint(1.1 * p.north_m, 1.1 * p.east_m, p.altitude_m, p.time_s, 1.1) for p in STAIRCASE]
    stretched, plain = lay(points, breeze), lay(STAIRCASE, breeze)
    ours = follow(stretched, on_lead_in(stretched), breeze, 300.0)
    theirs = follow(plain, on_lead_in(plain), breeze, 300.0)
    np.testing.assert_allclose(
        ours.after(0.0, "cross_track_m"), theirs.after(0.0, "cross_track_m"), atol=1e-3
    )


@pytest.mark.parametrize("right_m", [400.0, -400.0])
@pytest.mark.parametrize("turned_rad", [0.0, 3.0, -1.5])
def test_it_comes_back_to_the_path_from_any_side_on_any_heading(right_m: float, turned_rad: float) -> None:
    reference = lay(flat((0, 0, 0), (3600, 0, 120), (7200, 0, 240)), breeze)
    flown = follow(reference, on_lead_in(reference, right_m, turned_rad), breeze, 100.0)
    assert np.abs(flown.after(70.0, "cross_track_m")).max() < 1.0
    assert (
        np.abs(flown.after(-30.0, "cross_track_m")).max() < 400.0 + 2.1 * 28.0**2 / 6.8
    )  # a half circle more
    assert max(abs(command.roll_rad) for command in flown.commands) <= ENVELOPE.bank_max_rad + 1e-9


def test_it_is_on_the_path_and_settled_within_a_lead_in_in_which_the_wind_comes_up() -> None:
    def rising(time_s: float) -> tuple[float, float]:
        share = min((time_s + 30.0) / 10.0, 1.0)
        return -5.0 * share, 13.0 * share

    reference = lay(STAIRCASE, rising)
    flown = follow(reference, on_lead_in(reference), rising, 60.0)
    assert np.abs(flown.after(-5.0, "cross_track_m")).max() < 1.0
    assert np.abs(flown.after(0.0, "time_error_s")).max() < 3.0


def test_a_crosswind_as_strong_as_the_airspeed_does_not_turn_it_away() -> None:
    def gale(_time_s: float) -> tuple[float, float]:
        return 0.0, 38.0

    reference = lay(flat((0, 0, 0), (3600, 0, 240), (7200, 0, 480)), gale)
    flown = follow(reference, on_lead_in(reference, turned_rad=-math.radians(70.0)), gale, 300.0)
    assert np.abs(flown.after(60.0, "cross_track_m")).max() < 1.0
    assert (np.diff(flown.after(60.0, "path_m")) > 0.0).all()


def test_a_crosswind_above_the_airspeed_is_met_head_on() -> None:
    def gale(_time_s: float) -> tuple[float, float]:
        return 0.0, 45.0

    reference = lay(flat((0, 0, 0), (3600, 0, 240), (7200, 0, 480)), gale)
    plant = on_lead_in(reference, turned_rad=-math.radians(70.0))
    follow(reference, plant, gale, 60.0)
    heading_rad = math.remainder(plant.heading_rad, 2.0 * math.pi)
    assert heading_rad == pytest.approx(-math.radians(89.0), abs=0.03)
    assert plant.airspeed_mps == pytest.approx(ENVELOPE.airspeed_max_mps, abs=0.1)


@pytest.mark.parametrize("toward_rad", [0.5 * math.pi, 0.8 * math.pi])
def test_ten_minutes_of_wind_above_the_airspeed_cost_no_more_than_its_excess(toward_rad: float) -> None:
    def gale(time_s: float) -> tuple[float, float]:
        share = min(max(min(time_s - 60.0, 720.0 - time_s) / 60.0, 0.0), 1.0)
        return 48.0 * share * math.cos(toward_rad), 48.0 * share * math.sin(toward_rad)

    reference = lay(flat((0, 0, 0), (9000, 0, 300), (9000, 9000, 600)), calm)
    plant = on_lead_in(reference)
    flown = follow(reference, plant, gale, 1400.0)
    winds = np.array([math.hypot(*gale(time_s)) for time_s in flown.time_s])
    excess_m = np.maximum(winds - ENVELOPE.airspeed_max_mps, 0.0).sum() * 0.1
    off_m = np.abs(flown.after(-30.0, "cross_track_m"))
    assert off_m.max() < excess_m + 50.0
    away = np.flatnonzero(off_m > 1.0)
    assert len(away) == 0 or flown.time_s[away[-1]] < 720.0 + 400.0
    assert flown.progress[-1].path_m == pytest.approx(reference.end_m)


def test_a_late_aircraft_hurries_and_an_early_one_slows_down() -> None:
    reference = lay(flat((0, 0, 0), (3600, 0, 120), (7200, 0, 240)), calm)
    late, early = on_lead_in(reference), on_lead_in(reference)
    late.time_s += 4.0
    early.time_s -= 4.0
    hurried = follow(reference, late, calm, 60.0)
    slowed = follow(reference, early, calm, 60.0)
    assert hurried.commands[0].airspeed_mps > 33.0
    assert slowed.commands[0].airspeed_mps < 27.0
    assert np.abs(hurried.after(30.0, "time_error_s")).max() < 0.5
    assert np.abs(slowed.after(30.0, "time_error_s")).max() < 0.5


def test_airspeed_stays_in_the_envelope_and_is_kept_up_in_a_turn() -> None:
    def tail(_time_s: float) -> tuple[float, float]:
        return 14.0, 14.0

    reference = lay(flat((0, 0, 0), (3600, 0, 120), (3600, 3600, 240)), tail)
    flown = follow(reference, on_lead_in(reference), tail, 200.0)
    airspeeds = np.array([command.airspeed_mps for command in flown.commands])
    banks = np.array([command.roll_rad for command in flown.commands])
    assert airspeeds.min() >= 20.0
    assert airspeeds.max() <= 41.0
    stall_share = np.sqrt(1.0 / np.cos(banks))  # lift at the stall goes with airspeed squared
    assert (airspeeds >= 20.0 * stall_share - 1e-9).all()
    assert stall_share.max() > 1.03


def test_climbs_are_followed() -> None:
    points = [PathPoint(3600.0 * i, 0.0, 1000.0 + 120.0 * (i in (2, 3)), 120.0 * i, 1.0) for i in range(5)]
    reference = lay(points, calm)
    flown = follow(reference, on_lead_in(reference), calm, 480.0)
    assert np.abs(flown.after(0.0, "altitude_error_m")).max() < 1.5
    assert max(command.climb_mps for command in flown.commands) == pytest.approx(1.0, abs=0.1)


def test_progress_tells_right_above_and_late_as_positive() -> None:
    reference = lay(flat((0, 0, 0), (3600, 0, 120)), calm)
    plant = on_lead_in(reference, right_m=12.0)
    plant.altitude_m += 5.0
    plant.time_s += 2.0
    _, progress = Guidance(reference, ENVELOPE).update(
        plant.state(calm), plant.north_m, plant.east_m, 1.0, 0.0, 0.0
    )
    assert progress.cross_track_m == pytest.approx(12.0)
    assert progress.altitude_error_m == pytest.approx(5.0)
    assert progress.time_error_s == pytest.approx(2.0)
    assert progress.phase == Phase.LEAD_IN
    assert progress.path_m == pytest.approx(0.0, abs=1e-6)


def heights_asked(
    late_s: float, airspeed_mps: float, rounds: int = 50, *, most_m: float = 4.5
) -> list[float]:
    """Altitudes commanded on a straight leg at 1000 m, to an aircraft that stays that late and that slow."""
    reference = lay(flat((0.0, 0.0, 0.0), (36000.0, 0.0, 1200.0)), calm)
    guidance = Guidance(reference, ENVELOPE, Gains(height_for_time_m=most_m))
    asked = []
    for number in range(rounds):
        on_time_s = 100.0 + 0.2 * number
        place = reference.at(reference.path_at_time(on_time_s))
        plant = PointMass(place.north_m, place.east_m, 1000.0, 0.0, airspeed_mps, on_time_s + late_s)
        command, _ = guidance.update(plant.state(calm), plant.north_m, plant.east_m, 1.0, 0.0, 0.0)
        asked.append(command.altitude_m)
    return asked


def test_height_is_given_for_time_to_a_bound_by_an_aircraft_that_is_late_and_too_slow() -> None:
    heights_m = heights_asked(late_s=5.0, airspeed_mps=22.0)
    assert heights_m[0] > 999.0  # smoothly
    assert np.all(np.diff(heights_m) < 0.0)
    assert heights_m[-1] == pytest.approx(995.5, abs=0.01)
    assert heights_asked(5.0, 22.0, most_m=0.0)[-1] == 1000.0


@pytest.mark.parametrize(("late_s", "airspeed_mps"), [(0.9, 22.0), (-5.0, 22.0), (5.0, 36.0)])
def test_no_height_is_given_on_time_nor_at_the_airspeed_asked_for(late_s: float, airspeed_mps: float) -> None:
    assert set(heights_asked(late_s, airspeed_mps)) == {1000.0}
