"""No-fly zones: polygons from GeoJSON, and the cells that touch them."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from planner.closures import room_cells
from planner.grid import Grid
from planner.hazards import Bools, StageClock
from sim.errors import HazardError

if TYPE_CHECKING:  # shapely takes a tenth of a second to import
    from shapely import Polygon

_HALF_TURN_DEG, _TURN_DEG = 180.0, 360.0
_NEITHER = "give Polygon or MultiPolygon, alone, in a Feature or in a FeatureCollection"


@dataclass(frozen=True, slots=True)
class Zone:
    """A polygon with its holes, in degrees east and north, and when it holds [s since 1970-01-01 UTC].

    It reaches from `floor_m` to `ceiling_m` above the ellipsoid, both included.

    Longitudes run on without a break, beyond 180 deg where the polygon lies across the date line. Its edges
    are straight in longitude and latitude (RFC 7946).
    """

    polygon: Polygon
    begin_s: float = -math.inf
    end_s: float = math.inf
    floor_m: float = -math.inf
    ceiling_m: float = math.inf

    def between(self, altitudes_m: tuple[float, float]) -> bool:
        """Whether it reaches into a range of altitudes."""
        lowest_m, highest_m = altitudes_m
        return self.floor_m <= highest_m and self.ceiling_m >= lowest_m


def read_zones(path: Path) -> tuple[Zone, ...]:
    """The polygons of a GeoJSON file, as the properties of each say: when, from which altitude, up to which.

    These are `begin` and `end`, `floor_m` and `ceiling_m`; what is left out has no bounds.

    An edge over more than half a turn of longitude is taken to cross the date line the short way, so that
    both 179 to -179 deg and 179 to 181 deg may be written.

    Raises:
        HazardError: if it cannot be read, has no polygon, or one makes no sense.
    """
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        raise HazardError(f"cannot read no-fly zones from {path}: {error}; give a GeoJSON file") from error
    except ValueError as error:
        raise HazardError(f"the no-fly zones {path} are not JSON: {error}; give a GeoJSON file") from error
    features = document.get("features") if isinstance(document, dict) else None
    if not isinstance(features, list):
        features = [document]
    zones = [
        zone
        for number, feature in enumerate(features)
        for zone in _zones(feature, f"the no-fly zones {path}: feature {number}")
    ]
    if not zones:
        raise HazardError(f"the no-fly zones {path} hold no polygon; {_NEITHER}")
    return tuple(zones)


def closed_by_zones(
    zones: Sequence[Zone],
    grid: Grid,
    clock: StageClock,
    *,
    corridor_m: float,
    altitudes_m: tuple[float, float],
) -> Bools:
    """Cells whose room (see `planner.closures.room_cells`) touches a zone at any time of a stage.

    Args:
        zones: where it is not allowed to fly.
        grid: the planner's.
        clock: the stages.
        corridor_m: half width of the room that the aircraft needs [m]; 0 for the cells alone.
        altitudes_m: the lowest and the highest that are flown at; zones below or above do not count.

    Returns:
        Shape [stage, north, east].
    """
    closed = np.zeros((clock.stage_count, *grid.shape), dtype=np.bool_)
    spans = [clock.span_s(stage) for stage in range(clock.stage_count)]
    for zone in zones:
        if not zone.between(altitudes_m):
            continue
        stages = [end_s > zone.begin_s and begin_s < zone.end_s for begin_s, end_s in spans]
        if any(stages):
            closed[stages] |= _touched(zone.polygon, grid, corridor_m)
    return closed


def _touched(polygon: Polygon, grid: Grid, corridor_m: float) -> Bools:
    """Cells whose room touches a polygon, shape [north, east]."""
    import shapely

    north, east = (reach[:, np.newaxis] for reach in room_cells(grid, corridor_m))
    lat_deg, lon_deg = np.degrees(grid.lat_rad)[:, np.newaxis], np.degrees(grid.lon_rad)
    half_lat_deg = np.broadcast_to(north * math.degrees(grid.north_step_rad), (grid.rows, 1))
    half_lon_deg = np.broadcast_to(east * math.degrees(grid.east_step_rad), (grid.rows, 1))
    shapely.prepare(polygon)
    west, south, east_end, north_end = polygon.bounds
    touched = np.zeros(grid.shape, dtype=np.bool_)
    first = math.floor((lon_deg[0] - half_lon_deg.max() - east_end) / _TURN_DEG)
    last = math.ceil((lon_deg[-1] + half_lon_deg.max() - west) / _TURN_DEG)
    for turns in range(first, last + 1):  # the grid as seen from the polygon's own count of longitude
        seen_deg = lon_deg - turns * _TURN_DEG
        near = (np.abs(lat_deg - (south + north_end) / 2.0) <= (north_end - south) / 2.0 + half_lat_deg) & (
            np.abs(seen_deg - (west + east_end) / 2.0) <= (east_end - west) / 2.0 + half_lon_deg
        )
        rows, columns = np.nonzero(near)
        middle_lat, middle_lon = lat_deg[rows, 0], seen_deg[columns]
        high, wide = half_lat_deg[rows, 0], half_lon_deg[rows, 0]
        rooms = shapely.box(middle_lon - wide, middle_lat - high, middle_lon + wide, middle_lat + high)
        touched[rows, columns] |= shapely.intersects(polygon, rooms)
    return touched


def _zones(feature: Any, where: str) -> list[Zone]:
    if not isinstance(feature, dict):
        _refuse(where, "is no object", _NEITHER)
    featured = feature.get("type") == "Feature"
    geometry: Any = feature.get("geometry") if featured else feature
    properties: Any = (featured and feature.get("properties")) or {}
    kind = geometry.get("type") if isinstance(geometry, dict) else None
    if kind not in ("Polygon", "MultiPolygon"):
        _refuse(where, f"is of type {kind!r}", _NEITHER)
    if not isinstance(properties, dict):
        _refuse(where, "has properties that are no object", "write {} for none")
    parts = geometry.get("coordinates")
    parts = [parts] if kind == "Polygon" else parts
    if not isinstance(parts, list) or not parts:
        _refuse(where, "has no coordinates", "write [[[lon, lat], ...]], the outer ring first")
    begin_s, end_s = (
        _moment_s(properties.get(name), f"{where}: {name}", otherwise)
        for name, otherwise in (("begin", -math.inf), ("end", math.inf))
    )
    if not begin_s < end_s:
        _refuse(
            where, f"begins at {properties.get('begin')} and ends at {properties.get('end')}", "swap them"
        )
    floor_m, ceiling_m = (
        _altitude_m(properties.get(name), f"{where}: {name}", otherwise)
        for name, otherwise in (("floor_m", -math.inf), ("ceiling_m", math.inf))
    )
    if not floor_m < ceiling_m:
        _refuse(where, f"has the floor {floor_m:g} m and the ceiling {ceiling_m:g} m", "swap them")
    return [Zone(_polygon(part, where), begin_s, end_s, floor_m, ceiling_m) for part in parts]


def _polygon(rings: Any, where: str) -> Polygon:
    import shapely

    if not isinstance(rings, list) or not rings:
        _refuse(where, "has a polygon without a ring", "write [[[lon, lat], ...]], the outer ring first")
    shell, *holes = [_ring(ring, where) for ring in rings]
    middle_deg = sum(lon for lon, _ in shell) / len(shell)
    placed = [_near(hole, middle_deg) for hole in holes]
    polygon = shapely.Polygon(shell, placed)
    if not polygon.is_valid or polygon.area == 0.0:
        reason = shapely.is_valid_reason(polygon) if not polygon.is_valid else "no area"
        _refuse(where, f"has a polygon that is none ({reason})", "draw it anew without crossing itself")
    return polygon


def _ring(ring: Any, where: str) -> list[tuple[float, float]]:
    """A closed ring as (longitude, latitude) [deg], without jumps."""
    if not isinstance(ring, list) or len(ring) < 4:
        _refuse(where, "has a ring of less than four positions", "close it: the last position is the first")
    points = [_position(position, where) for position in ring]
    if points[0] != points[-1]:
        _refuse(
            where, f"has a ring from {points[0]} to {points[-1]}", "close it: the last position is the first"
        )
    lon_deg = points[0][0]
    placed = [points[0]]
    for (before, _), (lon, lat) in pairwise(points):
        step = lon - before
        if abs(step) > _HALF_TURN_DEG:
            step -= _TURN_DEG * round(step / _TURN_DEG)
        lon_deg += step
        placed.append((lon_deg, lat))
    if abs(placed[-1][0] - placed[0][0]) > _HALF_TURN_DEG:
        _refuse(where, "has a ring around a pole", "split it along the date line")
    return placed


def _position(position: Any, where: str) -> tuple[float, float]:
    numbers = isinstance(position, list) and all(
        isinstance(value, int | float) and not isinstance(value, bool) for value in position
    )
    if not numbers or len(position) < 2:
        _refuse(where, f"has the position {position!r}", "write [longitude, latitude] in degrees")
    lon, lat = float(position[0]), float(position[1])
    if not (abs(lat) <= 90.0 and abs(lon) <= _TURN_DEG):
        _refuse(
            where,
            f"has the position {position!r}, latitude {lat}",
            "write [longitude, latitude] in degrees, latitude from -90 to 90 and longitude from -360 to 360",
        )
    return lon, lat


def _near(ring: list[tuple[float, float]], middle_deg: float) -> list[tuple[float, float]]:
    """A hole by the count of longitude of its shell."""
    own_deg = sum(lon for lon, _ in ring) / len(ring)
    moved_deg = _TURN_DEG * round((middle_deg - own_deg) / _TURN_DEG)
    return [(lon + moved_deg, lat) for lon, lat in ring]


def _moment_s(text: Any, where: str, otherwise: float) -> float:
    if text is None:
        return otherwise
    try:
        moment = datetime.fromisoformat(text)
    except (TypeError, ValueError):
        _refuse(where, f"is {text!r}", "write a time such as 2022-09-29T06:00:00Z")
    return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()


def _altitude_m(value: Any, where: str, otherwise: float) -> float:
    if value is None:
        return otherwise
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        _refuse(where, f"is {value!r}", "write a number of metres above the ellipsoid, such as 600")
    return float(value)


def _refuse(where: str, what: str, remedy: str) -> NoReturn:
    raise HazardError(f"{where} {what}; {remedy}")
