"""Best tracks of tropical cyclones: the published fixes, and those of Hurricane Ian."""

from __future__ import annotations

import math
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import pairwise
from pathlib import Path

from sim.errors import WeatherError

KNOT_MPS = 1852.0 / 3600.0
NAUTICAL_MILE_M = 1852.0

RADIUS_SPEEDS_MPS = tuple(knots * KNOT_MPS for knots in (34.0, 50.0, 64.0))
"""The wind speeds whose extents are published [m/s]."""

QUADRANT_BEARINGS_RAD = tuple(math.radians(bearing) for bearing in (45.0, 135.0, 225.0, 315.0))
"""The middle of each quadrant as seen from the centre: north-east, south-east, south-west, north-west."""


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
        when = f"the best track's fix of {datetime.fromtimestamp(self.time_s, UTC):%Y-%m-%d %H:%M} UTC"
        if not (0.0 < self.lat_rad < math.pi / 2.0 and math.isfinite(self.lon_rad)):
            raise WeatherError(
                f"{when} lies at {math.degrees(self.lat_rad):.1f} deg; it must lie in the north"
            )
        if not (self.max_wind_mps > 0.0 and self.max_wind_radius_m > 0.0):
            raise WeatherError(
                f"{when} has a top wind of {self.max_wind_mps:.1f} m/s at {self.max_wind_radius_m:.0f} m; "
                "both must be positive: take fixes of 2021 or later, which carry them"
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


def read_best_track(path: Path, storm: str) -> tuple[BestTrackFix, ...]:
    """The fixes of one storm, such as "AL092022", from a file in NOAA's HURDAT2 format.

    Raises:
        WeatherError: if the file cannot be read, lacks the storm, or a line makes no sense.
    """
    try:
        lines = path.read_text(encoding="ascii").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise WeatherError(f"cannot read the best track {path}: {error}; give a HURDAT2 text file") from error
    for number, line in enumerate(lines):
        if line.startswith(storm + ","):
            count = int(line.split(",")[2])
            return parse_fixes("\n".join(lines[number + 1 : number + 1 + count]))
    raise WeatherError(
        f"the best track {path} has no storm {storm!r}; write basin, number and year: AL092022"
    )


def parse_fixes(text: str) -> tuple[BestTrackFix, ...]:
    """Fixes from lines in HURDAT2's columns (landfalls between the six-hourly fixes included).

    The columns: date, time, record, status, latitude, longitude, maximum wind [kt], pressure [hPa], radii of
    34, 50 and 64 kt in the quadrants NE, SE, SW, NW, and radius of maximum wind [all in nautical miles].

    Raises:
        WeatherError: if a line does not have these columns, naming it.
    """
    return tuple(_parse_fix(line) for line in text.split("\n") if line.strip())


def _parse_fix(line: str) -> BestTrackFix:
    cells = [cell.strip() for cell in line.split(",")]
    try:
        time = datetime.strptime(cells[0] + cells[1], "%Y%m%d%H%M").replace(tzinfo=UTC)
        radii_m = [float(cell) * NAUTICAL_MILE_M for cell in cells[8:21]]
        return BestTrackFix(
            time_s=time.timestamp(),
            lat_rad=_angle_rad(cells[4], "NS"),
            lon_rad=_angle_rad(cells[5], "EW"),
            max_wind_mps=float(cells[6]) * KNOT_MPS,
            max_wind_radius_m=radii_m[12],
            radii_m=(tuple(radii_m[0:4]), tuple(radii_m[4:8]), tuple(radii_m[8:12])),
        )
    except WeatherError:
        raise
    except (ValueError, IndexError) as error:
        raise WeatherError(f"not a HURDAT2 fix of 2021 or later: {line.strip()!r} ({error})") from error


def _angle_rad(text: str, letters: str) -> float:
    """A latitude or longitude such as 26.6N or 82.4W; the second letter of the two is negative."""
    sign = (1.0, -1.0)[letters.index(text[-1])]
    return sign * math.radians(float(text[:-1]))


HURRICANE_IAN = parse_fixes("""
20220928,1800, ,HU,26.6N,82.4W,135,938,130,150,100,150, 50, 60, 70, 80, 30, 40, 30, 45, 20
20220928,1905,L,HU,26.7N,82.2W,130,941,130,150,100,150, 50, 60, 70, 80, 30, 40, 30, 45, 20
20220928,2035,L,HU,26.8N,82.0W,125,945,130,150,100,150, 50, 60, 70, 80, 30, 40, 30, 45, 20
20220929,0000, ,HU,27.2N,81.7W,100,960,180,120,120,220, 50, 60, 50, 70, 30, 40, 30, 45, 20
20220929,0600, ,HU,27.7N,81.1W, 65,985,360,120,150,200, 60, 50, 40, 70, 30,  0,  0, 30, 20
20220929,1200, ,TS,28.4N,80.6W, 60,987,360,120,150,200, 60, 50, 40, 70,  0,  0,  0,  0, 40
20220929,1800, ,HU,28.9N,80.1W, 65,986,360,140,150,200, 60,  0, 50,100,  0,  0,  0, 40, 40
20220930,0000, ,HU,29.6N,79.4W, 70,986,420,150,120,220, 60, 80, 80,120,  0,  0, 40, 60, 40
20220930,0600, ,HU,30.3N,79.1W, 75,984,420,130,100,160, 80, 60, 80,120,  0,  0, 40, 60, 40
20220930,1200, ,HU,31.5N,79.0W, 75,980,240,130,120,140, 80, 60, 80, 80, 40,  0, 40, 60, 40
20220930,1800, ,HU,33.3N,79.2W, 70,978,190,130,100, 60, 80, 60, 80, 40,  0, 30, 40,  0, 40
20220930,1805,L,HU,33.3N,79.2W, 70,978,190,130,100, 60, 80, 60, 80, 40,  0, 30, 40,  0, 40
20221001,0000, ,EX,34.4N,79.3W, 50,990,160,170,  0,  0,  0, 90,  0,  0,  0,  0,  0,  0, 80
""")
"""Hurricane Ian (AL092022) from Florida to the Carolinas, 2022-09-28 18:00 to 2022-10-01 00:00 UTC.

Source: NOAA National Hurricane Center, Atlantic hurricane database HURDAT2 (public domain); described in
Landsea and Franklin (2013), Monthly Weather Review 141, 3576-3592.
"""
