"""How closely a flight followed its plan, computed from the recording alone.

From positions, plan, reference and hazards: never from figures that the run itself wrote, such as guidance's
errors or, for the arrival, the outcome. The lead-in before departure does not count.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from aircraft.path import Phase
from aircraft.reference import Reference
from planner.grid import geodesic_m
from recordings import tracking_report
from recordings.clearance import nearest_approach
from recordings.figures import Extent, Largest, Moment, Spread, Statistics
from recordings.passing import PASSED_M
from recordings.quantities import DURATIONS, QUANTITIES
from recordings.recorder import Layer
from recordings.recording import Recording
from recordings.series import Series, measure
from recordings.soundness import require_sound

ARRIVAL_RADIUS_M = 50.0
"""A flight has arrived when it passed the last waypoint at no more than this distance."""


@dataclass(frozen=True, slots=True, eq=False)
class Tracking:
    """The report of one flight, in the order in which it is written; None where there is nothing to measure.

    `outcome`: as recorded; `arrived`: as recomputed from the positions. Lengths and distances are true
    metres, the planned length that of the reference. `flight_time_s`: to the last sample. Errors are
    absolute; `waypoint_time_error_s` is of the waypoints that were reached. `hazard_exposure_s`: time in
    steady wind (without turbulence) above the threshold, or in cells that are hazardous for another reason.
    `outside_airspeeds_s`: time below the lowest or above the highest airspeed of the aircraft's envelope,
    gusts included. `min_clearance_m`: to the centre of the nearest cell that is truly hazardous in that
    stage, None if there is none at all.
    `corner_cut_m`: between the plan's waypoints and the reference. `position_estimate_error_m` (horizontal)
    and `wind_estimate_error_mps`: of what the aircraft believed, where its sensors are not perfect.
    `delay_s`: at the last waypoint, early negative. `holds`: how often a hold was laid into the reference in
    flight. `forecasts`: issued in flight; `plan_changes`: how often the plan changed for one; `replanning`:
    what each did to it; `destination`: where the last plan leads. `level_changes`: how often the last plan
    changes its altitude, `levels_m`: those it stays at. `worst`: where and when, by the name of a
    statistic such as "cross_track_m.p95"; `series` and `recording`: what all of it was computed from.
    """

    scenario: str
    seed: int
    outcome: str
    arrived: bool
    goal: str
    planned_time_s: float
    flight_time_s: float
    planned_length_m: float
    flown_length_m: float
    cross_track_m: Spread
    altitude_error_m: Spread
    waypoint_time_error_s: Spread
    airspeed_mps: Extent
    wind_mps: Extent
    hazard_exposure_s: float | None
    min_clearance_m: float | None
    samples: int
    waypoints_missed: int
    corner_cut_m: Largest
    outside_airspeeds_s: float | None
    position_estimate_error_m: Spread
    wind_estimate_error_mps: Spread
    delay_s: float | None
    holds: int
    forecasts: int
    plan_changes: int
    destination: str
    level_changes: int
    levels_m: tuple[float, ...]
    replanning: tuple[str, ...]
    outcome_detail: str
    worst: Mapping[str, Moment]
    series: Series
    recording: Recording

    def to_json(self, **extra: float) -> bytes:
        """The report as indented JSON, with `extra` figures behind it."""
        return tracking_report.report_json(self, extra)

    def summary(self) -> str:
        """The report for people, some lines."""
        return tracking_report.summary(self)


def track(recording: Recording) -> Tracking:
    """Measure a flight against its plan.

    Raises:
        BadRecordingError: if the recording cannot be measured; see `soundness.require_sound`.
    """
    require_sound(recording)
    header, series, statistics = recording.header, measure(recording), Statistics()
    places = series.samples
    levels_m = tuple(altitude_m for altitude_m, _ in recording.plan.level_flight)
    changed_s = {issue.time_s for issue in recording.plans[1:] if issue.changed}

    def believed(name: str) -> Spread:
        return statistics.spread(name, *QUANTITIES[name].measure(series, recording))

    return Tracking(
        scenario=header.scenario,
        seed=header.seed,
        outcome=recording.outcome.value,
        arrived=_arrived(recording, series, statistics),
        goal=header.plan.goal,
        planned_time_s=header.plan.duration_s,
        flight_time_s=float(series.time_s[-1]) if len(series.time_s) else 0.0,
        planned_length_m=_length_m(header.reference),
        flown_length_m=_flown_m(series),
        cross_track_m=statistics.spread("cross_track_m", series.cross_track_m, places),
        altitude_error_m=statistics.spread("altitude_error_m", series.altitude_error_m, places),
        waypoint_time_error_s=statistics.spread(
            "waypoint_time_error_s", series.waypoint_time_error_s, series.passed
        ),
        airspeed_mps=statistics.extent("airspeed_mps", series.airspeed_mps, places),
        wind_mps=statistics.extent("wind_mps", series.wind_mps, places),
        hazard_exposure_s=_duration_s("hazard_exposure_s", series, recording, statistics),
        min_clearance_m=_clearance_m(recording, series, statistics),
        samples=len(series.time_s),
        waypoints_missed=int(np.isnan(series.waypoint_time_error_s).sum()),
        corner_cut_m=statistics.largest("corner_cut_m", series.corner_cut_m, series.planned),
        outside_airspeeds_s=_duration_s("outside_airspeeds_s", series, recording, statistics),
        position_estimate_error_m=believed("position_estimate_error_m"),
        wind_estimate_error_mps=believed("wind_estimate_error_mps"),
        delay_s=_delay_s(series, statistics),
        holds=sum(
            _begins_with_hold(issue.reference)
            for issue in recording.references[1:]
            if issue.time_s not in changed_s
        ),
        forecasts=len(recording.plans) - 1,
        plan_changes=len(changed_s),
        destination=recording.plan.goal,
        level_changes=max(len(levels_m) - 1, 0),
        levels_m=levels_m,
        replanning=tuple(issue.reason for issue in recording.plans[1:]),
        outcome_detail=recording.outcome_detail,
        worst=statistics.worst,
        series=series,
        recording=recording,
    )


def _arrived(recording: Recording, series: Series, statistics: Statistics) -> bool:
    """Whether the flight, at the end of the reference, came within the radius of the last waypoint.

    That is the mission's goal, unless the plan led elsewhere in the end.
    """
    reference, plan = recording.references[-1].reference, recording.plan
    last, to_goal = plan.waypoints[-1], plan.goal == recording.header.plan.goal and plan.outcome.reachable
    near_end = np.flatnonzero(series.to_go_m <= ARRIVAL_RADIUS_M * reference.scale[-1])
    candidates = near_end if len(near_end) else np.arange(len(series.time_s))[-1:]
    if not len(candidates):
        return False
    distances_m = geodesic_m(
        series.lat_rad[candidates],
        series.lon_rad[candidates],
        np.full(len(candidates), math.radians(last.lat_deg)),
        np.full(len(candidates), math.radians(last.lon_deg)),
    )
    nearest = int(np.argmin(distances_m))
    distance_m = float(distances_m[nearest])
    statistics.note(
        "arrived", distance_m, series.samples, int(candidates[nearest]), "m from the last waypoint"
    )
    return to_goal and len(near_end) > 0 and distance_m <= ARRIVAL_RADIUS_M


def _delay_s(series: Series, statistics: Statistics) -> float | None:
    delay_s = float(series.waypoint_time_error_s[-1])
    if math.isnan(delay_s):
        return None
    statistics.note("delay_s", delay_s, series.passed, len(series.waypoint_time_error_s) - 1, "s")
    return delay_s


def _begins_with_hold(reference: Reference) -> bool:
    """Whether it circles before its first waypoint; waits of the plan are at waypoints."""
    circling = reference.start_m[reference.phase == Phase.LOITER]
    return len(circling) > 0 and float(circling[0]) < float(reference.waypoint_path_m[0]) - PASSED_M


def _length_m(reference: Reference) -> float:
    """True length of the reference from the first waypoint to the last."""
    true_m = np.append(0.0, np.cumsum(reference.length_m / reference.scale))
    plane_m = np.append(reference.start_m, reference.end_m)
    first_m, last_m = np.interp(reference.waypoint_path_m[[0, -1]], plane_m, true_m)
    return float(last_m - first_m)


def _flown_m(series: Series) -> float:
    lat_rad, lon_rad = series.lat_rad, series.lon_rad
    return float(np.sum(geodesic_m(lat_rad[:-1], lon_rad[:-1], lat_rad[1:], lon_rad[1:])))


def _duration_s(name: str, series: Series, recording: Recording, statistics: Statistics) -> float | None:
    if not len(series.time_s):
        return None
    unit, measure_beyond = DURATIONS[name]
    beyond, shown = measure_beyond(series, recording)
    farthest = int(np.argmax(beyond))
    statistics.note(name, float(shown[farthest]), series.samples, farthest, unit)
    return float(series.samples.lasting_s()[beyond > 0.0].sum())


def _clearance_m(recording: Recording, series: Series, statistics: Statistics) -> float | None:
    truth = [sheet for sheet in recording.hazards if sheet.layer == Layer.TRUTH]
    found = nearest_approach(truth, series.time_s, series.lat_rad, series.lon_rad)
    if found is None:
        return None
    statistics.note("min_clearance_m", found.distance_m, series.samples, found.sample, "m")
    return found.distance_m
