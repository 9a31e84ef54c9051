"""Lines cut where they cross 180 degrees of longitude, as RFC 7946, section 3.1.9, asks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple


class Fix(NamedTuple):
    """A position [deg, m] at a time since departure [s]."""

    lon_deg: float
    lat_deg: float
    altitude_m: float
    time_s: float


def cut(line: Sequence[Fix]) -> list[list[Fix]]:
    """Split a line at the antimeridian.

    Between its points a line takes the shorter way round and is straight in longitude and latitude, which
    is how GeoJSON reads it; the points added at the cut are interpolated so, in time too.

    Args:
        line: longitudes from -180 (included) to 180 deg.

    Returns:
        Parts that never cross, with longitudes from -180 to 180 deg, both included. A part has one point
        only where the line itself has one.
    """
    parts = [[line[0]]]
    for after in line[1:]:
        part, before = parts[-1], parts[-1][-1]
        lon_deg = after.lon_deg - 360.0 * round((after.lon_deg - before.lon_deg) / 360.0)
        if abs(lon_deg) <= 180.0:
            part.append(after._replace(lon_deg=lon_deg))
            continue
        edge_deg = math.copysign(180.0, lon_deg)
        share = (edge_deg - before.lon_deg) / (lon_deg - before.lon_deg)
        crossing = Fix(
            edge_deg,
            *(a + share * (b - a) for a, b in zip(before[1:], after[1:], strict=True)),
        )
        if share > 0.0:
            part.append(crossing)
        if len(part) == 1:  # the line starts on the antimeridian
            part.clear()
        else:
            parts.append([])
        parts[-1].extend((crossing._replace(lon_deg=-edge_deg), after))
    return parts
