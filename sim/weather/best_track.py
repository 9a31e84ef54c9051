"""Best tracks of tropical cyclones: the published fixes, read from NOAA's format."""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from itertools import pairwise, takewhile
from pathlib import Path

import numpy as np

from sim.errors import WeatherError

KNOT_MPS = 1852.0 / 3600.0
NAUTICAL_MILE_M = 1852.0

RADIUS_SPEEDS_MPS = tuple(knots * KNOT_MPS for knots in (34.0, 50.0, 64.0))
"""The wind speeds whose extents are published [m/s]."""

QUADRANT_BEARINGS_RAD = tuple(math.radians(bearing) for bearing in (45.0, 135.0, 225.0, 315.0))
"""The middle of each quadrant as seen from the centre: north-east, south-east, south-west, north-west."""

_MISSING = -999.0

Span = tuple[float, float]


@dataclass(frozen=True, slots=True)
class BestTrackFix:
    """A cyclone of the northern hemisphere at one moment.

    Attributes:
        time_s: seconds since 1970-01-01 UTC.
        lat_rad: of the centre.
        lon_rad: of the centre.
        max_wind_mps: highest one-minute mean wind at 10 m.
        max_wind_radius_m: distance from the centre to that wind.
        radii_m: how far each of `RADIUS_SPEEDS_MPS` reaches in each quadrant, indexed [speed][quadrant];
            zero where that speed is not reached.

    Raises:
        WeatherError: if a value is impossible, or missing in the best track.
    """

    time_s: float
    lat_rad: float
    lon_rad: float
    max_wind_mps: float
    max_wind_radius_m: float
    radii_m: tuple[tuple[float, ...], ...]

    def __post_init__(self) -> None:
        when = f"the best track's fix of {_utc(self.time_s)} UTC"
        if not (0.0 < self.lat_rad < math.pi / 2.0 and math.isfinite(self.lon_rad)):
            raise WeatherError(
                f"{when} lies at {math.degrees(self.lat_rad):.1f} deg; it must lie in the north, where winds "
                "turn counter-clockwise: storms of the south are not made"
            )
        if not (self.max_wind_mps > 0.0 and self.max_wind_radius_m > 0.0):
            raise WeatherError(
                f"{when} has a top wind of {self.max_wind_mps:.1f} m/s at {self.max_wind_radius_m:.0f} m; "
                "both must be positive: correct the best track, or take another storm"
            )
        if [len(row) for row in self.radii_m] != [len(QUADRANT_BEARINGS_RAD)] * len(RADIUS_SPEEDS_MPS):
            raise WeatherError(f"{when} needs radii of three speeds in four quadrants, not {self.radii_m}")
        known = [speed for speed, row in zip(RADIUS_SPEEDS_MPS, self.radii_m, strict=True) if any(row)]
        if known and known[-1] > self.max_wind_mps:
            raise WeatherError(
                f"{when} has radii of {known[-1]:.1f} m/s, but a maximum wind of {self.max_wind_mps:.1f}; "
                "correct one of them"
            )
        for quadrant in zip(*self.radii_m, strict=True):
            reached = [radius_m for radius_m in quadrant if radius_m != 0.0]
            shrinking = all(outer_m > inner_m > 0.0 for outer_m, inner_m in pairwise([math.inf, *reached]))
            if not shrinking or quadrant[: len(reached)] != tuple(reached):
                raise WeatherError(
                    f"{when} has radii of {quadrant} m for rising speeds in one quadrant; they must shrink "
                    "from speed to speed, and be zero where a speed is not reached"
                )


def read_best_track(
    path: Path, storm: str, *, span_s: Span | None = None, estimate_core: bool = False
) -> tuple[BestTrackFix, ...]:
    """The fixes of one storm, such as "AL092022", from a file in NOAA's HURDAT2 format.

    Every status is taken, extratropical ones too, and landfalls between the six-hourly fixes. Longitudes run
    on across the date line.

    Args:
        path: of the file.
        storm: its HURDAT2 id.
        span_s: first and last time that matter [s since 1970]; only the fixes around them are read.
        estimate_core: see `parse_fixes`.

    Raises:
        WeatherError: if the file cannot be read, lacks the storm or the first time, or a line makes no sense.
    """
    try:
        lines = path.read_text(encoding="ascii").splitlines()
    except OSError as error:
        raise WeatherError(
            f"cannot read the best track {path}: {error.strerror}; give a HURDAT2 text file"
        ) from error
    except UnicodeDecodeError as error:
        raise WeatherError(
            f"{path} is not text, and with weather.storm {storm!r} weather.file is a best track in HURDAT2's "
            "format; for wind from NetCDF, GRIB or Zarr take weather.storm out of the scenario"
        ) from error
    header = next((number for number, line in enumerate(lines) if line.startswith(storm + ",")), None)
    if header is None or not storm:
        raise WeatherError(
            f"the best track {path} has no storm {storm!r}; write basin, number and year: AL092022"
        )
    rows: Sequence[str] = list(takewhile(lambda row: row[:1].isdigit(), lines[header + 1 :]))
    if span_s is not None:
        rows = _around(rows, span_s, f"the best track of {storm} in {path}")
    return parse_fixes("\n".join(rows), estimate_core=estimate_core)


def _around(rows: Sequence[str], span_s: Span, what: str) -> Sequence[str]:
    """The lines from the last one before a span to the first one after it."""
    times_s = [_time_s(row) for row in rows]
    if not times_s or not times_s[0] <= span_s[0] < times_s[-1]:
        held = " to ".join(map(_utc, (times_s[0], times_s[-1]))) if times_s else "nothing"
        raise WeatherError(
            f"{what} holds {held} UTC, but the mission begins at {_utc(span_s[0])}; "
            "change mission.departure, or choose another storm"
        )
    return rows[bisect_right(times_s, span_s[0]) - 1 : bisect_left(times_s, span_s[1]) + 1]


def parse_fixes(text: str, *, estimate_core: bool = False) -> tuple[BestTrackFix, ...]:
    """Fixes from lines in HURDAT2's columns (landfalls between the six-hourly fixes included).

    The columns: date, time, record, status, latitude, longitude, maximum wind [kt], pressure [hPa], radii of
    34, 50 and 64 kt in the quadrants NE, SE, SW, NW, and radius of maximum wind [all in nautical miles].

    Args:
        text: the lines.
        estimate_core: take a radius of maximum wind that is missing, as before 2021, from wind and latitude
            (`core_radius_m`), instead of refusing the fix.

    Raises:
        WeatherError: if a line does not have these columns, naming it.
    """
    fixes = [_parse_fix(line, estimate_core) for line in text.split("\n") if line.strip()]
    lon_rad = np.unwrap([fix.lon_rad for fix in fixes]).tolist()
    return tuple(replace(fix, lon_rad=lon) for fix, lon in zip(fixes, lon_rad, strict=True))


def core_radius_m(max_wind_mps: float, lat_rad: float) -> float:
    """The radius of maximum wind that storms of such a wind at such a latitude have on average [m].

    Willoughby, Darling and Rahn (2006), Monthly Weather Review 134, 1102-1120, equation 7a; their wind is
    that of the flight level. Single storms lie a third off it, or more.
    """
    return 46.4e3 * math.exp(-0.0155 * max_wind_mps + 0.0169 * math.degrees(lat_rad))


def _parse_fix(line: str, estimate_core: bool) -> BestTrackFix:
    cells = [cell.strip() for cell in line.split(",")]
    try:
        lat_rad, max_wind_mps = _angle_rad(cells[4], "NS"), float(cells[6]) * KNOT_MPS
        radii = [float(cell) for cell in cells[8:20]]
        core = float(cells[20]) if len(cells) > 20 and cells[20] else _MISSING
        fix = f"the best track's fix {line.strip()[:14]!r}"
        if _MISSING in radii:
            raise WeatherError(
                f"{fix} has no radii of 34, 50 and 64 kt, from which the wind is made; they are published "
                "for storms of 2004 and later: take one of those"
            )
        if core == _MISSING and not estimate_core:
            raise WeatherError(
                f"{fix} has no radius of maximum wind, which is published for storms of 2021 and later; take "
                'one of those, or have it estimated from wind and latitude: weather.core_radius = "estimated"'
            )
        radii_m = [radius * NAUTICAL_MILE_M for radius in radii]
        return BestTrackFix(
            time_s=_time_s(line),
            lat_rad=lat_rad,
            lon_rad=_angle_rad(cells[5], "EW"),
            max_wind_mps=max_wind_mps,
            max_wind_radius_m=core_radius_m(max_wind_mps, lat_rad)
            if core == _MISSING
            else core * NAUTICAL_MILE_M,
            radii_m=(tuple(radii_m[0:4]), tuple(radii_m[4:8]), tuple(radii_m[8:12])),
        )
    except WeatherError:
        raise
    except (ValueError, IndexError) as error:
        raise WeatherError(f"not a HURDAT2 fix: {line.strip()!r} ({error})") from error


def _time_s(line: str) -> float:
    """The time of a line [s since 1970-01-01 UTC]."""
    day, hour = (cell.strip() for cell in line.split(",")[:2])
    try:
        return datetime.strptime(day + hour, "%Y%m%d%H%M").replace(tzinfo=UTC).timestamp()
    except ValueError as error:
        raise WeatherError(f"not a HURDAT2 fix: {line.strip()!r} ({error})") from error


def _utc(time_s: float) -> str:
    return f"{datetime.fromtimestamp(time_s, UTC):%Y-%m-%d %H:%M}"


def _angle_rad(text: str, letters: str) -> float:
    """A latitude or longitude such as 26.6N or 82.4W; the second letter of the two is negative."""
    sign = (1.0, -1.0)[letters.index(text[-1])]
    return sign * math.radians(float(text[:-1]))
