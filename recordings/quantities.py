"""What is measured at every sample or waypoint of a flight: the one table of it, with units and meanings."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planner.grid import geodesic_m
from recordings.clearance import clearances_m, in_closed_cells
from recordings.figures import Floats, Places
from recordings.recorder import Layer
from recordings.recording import Recording
from recordings.series import Series


class Measured(NamedTuple):
    """Values of one quantity, NaN where there was nothing to measure, and when and where they were."""

    values: Floats
    places: Places


class Quantity(NamedTuple):
    """Something that is measured all through a flight.

    `is_error`: its statistics are of sizes; their signs say to which side. `at_waypoints`: measured
    there alone.
    """

    meaning: str
    measure: Callable[[Series, Recording], Measured]
    is_error: bool = False
    at_waypoints: bool = False


class Duration(NamedTuple):
    """A figure in seconds: for how long something lay beyond its bound.

    `measure`: by how much, at every sample, above zero where it lay beyond; and what is shown of it.
    """

    unit: str
    measure: Callable[[Series, Recording], tuple[Floats, Floats]]


def _from(values: Callable[[Series], NDArray[np.floating]]) -> Callable[[Series, Recording], Measured]:
    """Of the samples of a flight."""

    def measure(series: Series, _: Recording) -> Measured:
        return Measured(np.asarray(values(series), np.float64), series.samples)

    return measure


def _column(name: str, factor: float = 1.0) -> Callable[[Series, Recording], Measured]:
    return _from(lambda series: factor * series.state[name].astype(np.float64))


def _degrees(name: str) -> Callable[[Series, Recording], Measured]:
    return _from(lambda series: np.degrees(series.state[name].astype(np.float64)))


def _size(*names: str) -> Callable[[Series, Recording], Measured]:
    """Length of a vector."""
    return _from(
        lambda series: np.sqrt(sum(np.square(series.state[name].astype(np.float64)) for name in names))
    )


def _clearance(series: Series, recording: Recording) -> Measured:
    truth = [sheet for sheet in recording.hazards if sheet.layer == Layer.TRUTH]
    return Measured(clearances_m(truth, series.time_s, series.lat_rad, series.lon_rad), series.samples)


class _Believed(NamedTuple):
    """Estimates of the flight, and the rows of the series that they are of."""

    rows: NDArray[np.void]
    true: NDArray[np.void]
    places: Places


def _believed(series: Series, recording: Recording) -> _Believed:
    estimate = recording.estimate
    rows = estimate[np.isin(estimate["time_s"], series.time_s)]
    at = np.searchsorted(series.time_s, rows["time_s"])
    return _Believed(rows, series.state[at], series.samples.chosen(at))


def _position_estimate_error(series: Series, recording: Recording) -> Measured:
    rows, true, places = _believed(series, recording)
    error_m = geodesic_m(true["lat_rad"], true["lon_rad"], rows["lat_rad"], rows["lon_rad"])
    return Measured(error_m, places)


def _wind_estimate_error(series: Series, recording: Recording) -> Measured:
    rows, true, places = _believed(series, recording)
    north_mps, east_mps = (rows[name] - true[name] for name in ("wind_north_mps", "wind_east_mps"))
    return Measured(np.hypot(north_mps, east_mps, dtype=np.float64), places)


def _waypoint_time_error(series: Series, _: Recording) -> Measured:
    return Measured(series.waypoint_time_error_s, series.passed)


def _corner_cut(series: Series, _: Recording) -> Measured:
    return Measured(series.corner_cut_m, series.planned)


QUANTITIES = {
    "cross_track_m": Quantity(
        "distance from the reference, to the right positive", _from(lambda of: of.cross_track_m), True
    ),
    "altitude_error_m": Quantity(
        "height off the reference, above positive", _from(lambda of: of.altitude_error_m), True
    ),
    "time_error_s": Quantity(
        "behind the reference's time at its nearest point, late positive",
        _from(lambda of: of.time_error_s),
        True,
    ),
    "waypoint_time_error_s": Quantity("at each waypoint, late positive", _waypoint_time_error, True, True),
    "corner_cut_m": Quantity(
        "between each waypoint of the plan and the reference", _corner_cut, at_waypoints=True
    ),
    "clearance_m": Quantity("to the centre of the nearest cell that is truly hazardous then", _clearance),
    "airspeed_mps": Quantity("true airspeed, gusts included", _from(lambda of: of.airspeed_mps)),
    "ground_speed_mps": Quantity("horizontal speed over ground", _size("north_mps", "east_mps")),
    "climb_mps": Quantity("vertical speed, up positive", _column("down_mps", -1.0)),
    "altitude_m": Quantity("above the ellipsoid", _column("altitude_m")),
    "height_above_ground_m": Quantity("above the ground", _column("height_above_ground_m")),
    "wind_mps": Quantity("steady horizontal wind at the aircraft", _from(lambda of: of.wind_mps)),
    "gust_mps": Quantity(
        "what turbulence adds to it", _size("gust_north_mps", "gust_east_mps", "gust_down_mps")
    ),
    "bank_deg": Quantity("right wing down positive", _degrees("roll_rad")),
    "pitch_deg": Quantity("nose up positive", _degrees("pitch_rad")),
    "angle_of_attack_deg": Quantity("nose above the oncoming air positive", _degrees("angle_of_attack_rad")),
    "sideslip_deg": Quantity("air from the right positive", _degrees("sideslip_rad")),
    "throttle": Quantity("share of full", _column("throttle")),
    "fuel_kg": Quantity("left in the tanks", _column("fuel_kg")),
    "position_estimate_error_m": Quantity(
        "horizontal distance from where the aircraft believed itself", _position_estimate_error
    ),
    "wind_estimate_error_mps": Quantity(
        "of the wind that it believed, against the steady wind", _wind_estimate_error
    ),
}
"""By the name that a limit gives them."""


_CLOSED = 1e-9  # what counts as above zero and is less than any wind over its threshold


def _in_hazard(series: Series, recording: Recording) -> tuple[Floats, Floats]:
    """In wind above the threshold at the aircraft, or in a cell that is hazardous for another reason."""
    above_mps = series.wind_mps - recording.header.threshold_mps
    truth = [sheet for sheet in recording.hazards if sheet.layer == Layer.TRUTH]
    closed = in_closed_cells(truth, series.time_s, series.lat_rad, series.lon_rad)
    return np.where(closed, np.maximum(above_mps, _CLOSED), above_mps), series.wind_mps


def _outside_envelope(series: Series, recording: Recording) -> tuple[Floats, Floats]:
    header, airspeed_mps = recording.header, series.airspeed_mps
    beyond_mps = np.maximum(header.airspeed_min_mps - airspeed_mps, airspeed_mps - header.airspeed_max_mps)
    return beyond_mps, airspeed_mps


DURATIONS = {
    "hazard_exposure_s": Duration("m/s of wind", _in_hazard),
    "outside_airspeeds_s": Duration("m/s of airspeed", _outside_envelope),
}
"""Figures of a report that are a time, and can so be taken over a part of the flight."""
