"""How closely a flight followed its plan, computed from the recording alone.

From positions, plan, reference and hazards: never from figures that the run itself wrote, such as guidance's
errors or, for the arrival, the outcome. The lead-in before departure does not count.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aircraft.reference import Reference
from planner.grid import geodesic_m
from recordings import tracking_report
from recordings.clearance import nearest_approach
from recordings.figures import Extent, Largest, Moment, Places, Spread, Statistics
from recordings.recorder import FlightHeader, Layer
from recordings.recording import Recording
from recordings.series import Series, measure
from recordings.soundness import require_sound

Floats = NDArray[np.float64]

ARRIVAL_RADIUS_M = 50.0
"""A flight has arrived when it passed the last waypoint at no more than this distance."""


@dataclass(frozen=True, slots=True, eq=False)
class Tracking:
    """The report of one flight, in the order in which it is written; None where there is nothing to measure.

    `outcome`: as recorded; `arrived`: as recomputed from the positions. Lengths and distances are true
    metres, the planned length that of the reference. `flight_time_s`: to the last sample. Errors are
    absolute; `waypoint_time_error_s` is of the waypoints that were reached. `hazard_exposure_s`: time in
    steady wind (without turbulence) above the threshold. `outside_airspeeds_s`: time below the lowest or
    above the highest airspeed of the aircraft's envelope, gusts included. `min_clearance_m`: to the centre of
    the nearest cell whose wind truly exceeds the threshold in that stage, None if there is none at all.
    `corner_cut_m`: between the plan's waypoints and the reference. `position_estimate_error_m` (horizontal)
    and `wind_estimate_error_mps`: of what the aircraft believed, where its sensors are not perfect. `worst`:
    where and when, by the name of a statistic such as "cross_track_m.p95".
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
    outcome_detail: str
    worst: Mapping[str, Moment]
    series: Series

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
    position_error_m, wind_error_mps = _estimate_errors(recording, statistics)
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
        hazard_exposure_s=_exposure_s(series, header.threshold_mps, statistics),
        min_clearance_m=_clearance_m(recording, series, statistics),
        samples=len(series.time_s),
        waypoints_missed=int(np.isnan(series.waypoint_time_error_s).sum()),
        corner_cut_m=statistics.largest("corner_cut_m", series.corner_cut_m, series.planned),
        outside_airspeeds_s=_outside_airspeeds_s(series, header, statistics),
        position_estimate_error_m=position_error_m,
        wind_estimate_error_mps=wind_error_mps,
        outcome_detail=recording.outcome_detail,
        worst=statistics.worst,
        series=series,
    )


def _arrived(recording: Recording, series: Series, statistics: Statistics) -> bool:
    """Whether the flight, at the end of the reference, came within the radius of the last waypoint."""
    reference, last = recording.header.reference, recording.header.plan.waypoints[-1]
    near_end_m = reference.waypoint_path_m[-1] - ARRIVAL_RADIUS_M * reference.scale[-1]
    near_end = np.flatnonzero(series.path_m >= near_end_m)
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
    return len(near_end) > 0 and distance_m <= ARRIVAL_RADIUS_M


def _length_m(reference: Reference) -> float:
    """True length of the reference from the first waypoint to the last."""
    true_m = np.append(0.0, np.cumsum(reference.length_m / reference.scale))
    plane_m = np.append(reference.start_m, reference.end_m)
    first_m, last_m = np.interp(reference.waypoint_path_m[[0, -1]], plane_m, true_m)
    return float(last_m - first_m)


def _flown_m(series: Series) -> float:
    lat_rad, lon_rad = series.lat_rad, series.lon_rad
    return float(np.sum(geodesic_m(lat_rad[:-1], lon_rad[:-1], lat_rad[1:], lon_rad[1:])))


def _estimate_errors(recording: Recording, statistics: Statistics) -> tuple[Spread, Spread]:
    """How far off the aircraft believed itself, horizontally, and the steady wind."""
    times_s = recording.state["time_s"]
    flight = (recording.estimate["time_s"] >= 0.0) & np.isin(recording.estimate["time_s"], times_s)
    believed = recording.estimate[flight]
    true = recording.state[np.searchsorted(times_s, believed["time_s"])]
    places = Places(true["time_s"], np.degrees(true["lat_rad"]), np.degrees(true["lon_rad"]))
    position_m = geodesic_m(true["lat_rad"], true["lon_rad"], believed["lat_rad"], believed["lon_rad"])
    wind_mps = np.hypot(
        believed["wind_north_mps"] - true["wind_north_mps"],
        believed["wind_east_mps"] - true["wind_east_mps"],
        dtype=np.float64,
    )
    return (
        statistics.spread("position_estimate_error_m", position_m, places),
        statistics.spread("wind_estimate_error_mps", wind_mps, places),
    )


def _exposure_s(series: Series, threshold_mps: float, statistics: Statistics) -> float | None:
    if not len(series.time_s):
        return None
    strongest = int(np.argmax(series.wind_mps))
    wind_mps = float(series.wind_mps[strongest])
    statistics.note("hazard_exposure_s", wind_mps, series.samples, strongest, "m/s of wind")
    return _time_s(series, series.wind_mps > threshold_mps)


def _outside_airspeeds_s(series: Series, header: FlightHeader, statistics: Statistics) -> float | None:
    if not len(series.time_s):
        return None
    beyond_mps = np.maximum(
        header.airspeed_min_mps - series.airspeed_mps, series.airspeed_mps - header.airspeed_max_mps
    )
    farthest = int(np.argmax(beyond_mps))
    airspeed_mps = float(series.airspeed_mps[farthest])
    statistics.note("outside_airspeeds_s", airspeed_mps, series.samples, farthest, "m/s of airspeed")
    return _time_s(series, beyond_mps > 0.0)


def _time_s(series: Series, chosen: NDArray[np.bool_]) -> float:
    """Each sample stands for the time to the next one, the last for as long as the one before it."""
    steps_s = np.diff(series.time_s)
    lasting_s = np.append(steps_s, steps_s[-1:] if len(steps_s) else math.inf)
    return float(lasting_s[chosen].sum())


def _clearance_m(recording: Recording, series: Series, statistics: Statistics) -> float | None:
    truth = [sheet for sheet in recording.hazards if sheet.layer == Layer.TRUTH]
    found = nearest_approach(truth, series.time_s, series.lat_rad, series.lon_rad)
    if found is None:
        return None
    statistics.note("min_clearance_m", found.distance_m, series.samples, found.sample, "m")
    return found.distance_m
