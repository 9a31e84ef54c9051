"""No-fly zones: cells against a geometry of our own, and what a file can get wrong."""

import json
import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.grid import Grid
from planner.hazards import StageClock
from sim.errors import HazardError
from sim.hazards.no_fly import closed_by_zones, read_zones

BEGIN_S = 1664409600.0  # 2022-09-29T00:00Z
CLOCK = StageClock(BEGIN_S, stage_count=3)
AT_1000_M = 1000.0, 1000.0


def grid_of(south=28.0, west=-82.0, rows=9, columns=11, step_deg=0.1):
    return Grid(*map(math.radians, (south, west, step_deg, step_deg)), rows, columns)


def written(folder, document):
    path = folder / "zones.geojson"
    path.write_text(document if isinstance(document, str) else json.dumps(document))
    return path


def polygon(*rings):
    return {"type": "Polygon", "coordinates": [[list(point) for point in ring] for ring in rings]}


def feature(geometry, **properties):
    return {"type": "Feature", "geometry": geometry, "properties": properties}


def closed_ring(points):
    return [*points, points[0]]


# An own geometry: even-odd rule, and crossings of segments by the side that points lie on.


def inside(x, y, rings):
    odd = False
    for ring in rings:
        for (x1, y1), (x2, y2) in pairwise(ring):
            if (y1 > y) != (y2 > y) and x < x1 + (y - y1) * (x2 - x1) / (y2 - y1):
                odd = not odd
    return odd


def side(a, b, c):
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def cross(a, b, c, d):
    return side(a, b, c) * side(a, b, d) < 0 and side(c, d, a) * side(c, d, b) < 0


def touches(box, rings):
    west, south, east, north = box
    corners = [(west, south), (east, south), (east, north), (west, north)]
    edges = list(zip(corners, [*corners[1:], corners[0]], strict=True))
    if any(inside(*corner, rings) for corner in corners):
        return True
    for ring in rings:
        if any(west <= x <= east and south <= y <= north for x, y in ring):
            return True
        for a, b in pairwise(ring):
            if any(cross(a, b, c, d) for c, d in edges):
                return True
    return False


def boxes(grid, corridor_m):
    """Every cell's room by row and column, worked out by itself."""
    radius_m = 6371000.0
    for row, lat in enumerate(grid.lat_rad):
        high = max(0.5 * grid.north_step_rad, corridor_m / radius_m)
        wide = max(0.5 * grid.east_step_rad, corridor_m / (radius_m * math.cos(lat)))
        for column, lon in enumerate(grid.lon_rad):
            yield row, column, tuple(map(math.degrees, (lon - wide, lat - high, lon + wide, lat + high)))


def expected(grid, rings, corridor_m=0.0, turn_deg=0.0):
    cells = np.zeros(grid.shape, dtype=bool)
    for row, column, (west, south, east, north) in boxes(grid, corridor_m):
        cells[row, column] = touches((west + turn_deg, south, east + turn_deg, north), rings)
    return cells


@st.composite
def star(draw, size_deg):
    """A star around a middle: never crosses itself."""
    count = draw(st.integers(3, 9))
    turns = (np.arange(count) + draw(st.floats(0.0, 1.0))) * 2.0 * math.pi / count
    reach = [draw(st.floats(0.2, 1.0)) * size_deg for _ in range(count)]
    return [(r * math.cos(turn), r * math.sin(turn)) for turn, r in zip(turns, reach, strict=True)]


@settings(max_examples=40, deadline=None)
@given(
    star(0.45),
    st.floats(-82.1, -80.9),
    st.floats(27.9, 28.9),
    st.booleans(),
    st.sampled_from([0.0, 1100.0, 9000.0]),
    st.sampled_from([-360.0, 0.0, 360.0]),
)
def test_cells_are_those_that_an_own_geometry_finds(
    tmp_path_factory, points, lon, lat, hole, corridor_m, turn_deg
):
    grid = grid_of()
    rings = [closed_ring([(lon + turn_deg + x, lat + y) for x, y in points])]
    if hole:
        rings.append(closed_ring([(lon + turn_deg + 0.5 * x, lat + 0.5 * y) for x, y in reversed(points)]))
    if any(abs(x) > 360.0 for x, _ in rings[0]):
        return
    zones = read_zones(written(tmp_path_factory.mktemp("z"), polygon(*rings)))
    found = closed_by_zones(zones, grid, CLOCK, corridor_m=corridor_m, altitudes_m=AT_1000_M)
    assert (found == found[0]).all()
    # The own rooms are of a sphere, 0.6 % off: between a smaller and a wider corridor lies the truth.
    least = expected(grid, rings, 0.99 * corridor_m, turn_deg)
    most = expected(grid, rings, 1.01 * corridor_m, turn_deg)
    assert not (least & ~found[0]).any()
    assert not (found[0] & ~most).any()


def test_a_hole_that_holds_a_cell_leaves_it_open(tmp_path):
    grid = grid_of()
    outer = closed_ring([(-82.5, 27.5), (-80.5, 27.5), (-80.5, 29.5), (-82.5, 29.5)])
    hole = closed_ring([(-81.56, 28.34), (-81.56, 28.46), (-81.44, 28.46), (-81.44, 28.34)])
    found = closed_by_zones(
        read_zones(written(tmp_path, polygon(outer, hole))),
        grid,
        CLOCK,
        corridor_m=0.0,
        altitudes_m=AT_1000_M,
    )[0]
    assert np.argwhere(~found).tolist() == [[4, 5]]  # 28.4 N 81.5 W


@pytest.mark.parametrize("east_deg", [181.0, -179.0], ids=["counted on across the date line", "counted anew"])
@pytest.mark.parametrize("west_deg", [179.0, -181.0])
def test_a_zone_across_the_date_line(tmp_path, east_deg, west_deg):
    rings = [(179.5, 28.2), (east_deg - 0.5, 28.2), (east_deg - 0.5, 28.5), (179.5, 28.5)]
    zones = read_zones(written(tmp_path, polygon(closed_ring(rings))))
    grid = grid_of(west=west_deg, columns=21)
    found = closed_by_zones(zones, grid, CLOCK, corridor_m=0.0, altitudes_m=AT_1000_M)[0]
    plain = [(179.5, 28.2), (180.5, 28.2), (180.5, 28.5), (179.5, 28.5)]
    turn_deg = 0.0 if west_deg > 0 else 360.0
    np.testing.assert_array_equal(found, expected(grid, [closed_ring(plain)], 0.0, turn_deg))
    assert found.any()
    assert not found.all()


def test_parts_cut_at_the_date_line_as_rfc_7946_has_it(tmp_path):
    west = closed_ring([[179.5, 28.2], [180.0, 28.2], [180.0, 28.5], [179.5, 28.5]])
    east = closed_ring([[-180.0, 28.2], [-179.5, 28.2], [-179.5, 28.5], [-180.0, 28.5]])
    whole = polygon(closed_ring([(179.5, 28.2), (180.5, 28.2), (180.5, 28.5), (179.5, 28.5)]))
    grid = grid_of(west=179.0, columns=21)
    cut = read_zones(written(tmp_path, {"type": "MultiPolygon", "coordinates": [[west], [east]]}))
    assert len(cut) == 2
    found = closed_by_zones(cut, grid, CLOCK, corridor_m=1100.0, altitudes_m=AT_1000_M)
    in_one = read_zones(written(tmp_path, whole))
    np.testing.assert_array_equal(
        found, closed_by_zones(in_one, grid, CLOCK, corridor_m=1100.0, altitudes_m=AT_1000_M)
    )


SQUARE = polygon(closed_ring([(-81.6, 28.3), (-81.3, 28.3), (-81.3, 28.6), (-81.6, 28.6)]))


@pytest.mark.parametrize(
    ("properties", "stages"),
    [
        ({}, [True, True, True]),
        ({"begin": "2022-09-29T01:00:00Z"}, [False, True, True]),
        ({"end": "2022-09-29T01:00:00Z"}, [True, False, False]),
        ({"begin": "2022-09-29T01:30:00", "end": "2022-09-29T01:40:00"}, [False, True, False]),
        ({"begin": "2022-09-29T03:59:00+02:00", "end": "2022-09-29T04:01:00+02:00"}, [False, True, True]),
        ({"begin": "2022-09-30"}, [False, False, False]),
    ],
)
def test_a_zone_holds_in_the_stages_that_its_time_touches(tmp_path, properties, stages):
    zones = read_zones(written(tmp_path, feature(SQUARE, **properties)))
    found = closed_by_zones(zones, grid_of(), CLOCK, corridor_m=0.0, altitudes_m=AT_1000_M)
    assert found.any(axis=(1, 2)).tolist() == stages


@pytest.mark.parametrize(
    ("properties", "altitudes_m", "holds"),
    [
        ({}, AT_1000_M, True),
        ({"floor_m": 1000}, AT_1000_M, True),
        ({"floor_m": 1000.5}, AT_1000_M, False),
        ({"ceiling_m": 1000.0}, AT_1000_M, True),
        ({"ceiling_m": 999.0}, AT_1000_M, False),
        ({"floor_m": 0, "ceiling_m": 600}, AT_1000_M, False),
        ({"floor_m": 600, "ceiling_m": 1500}, AT_1000_M, True),
        ({"floor_m": None, "ceiling_m": 1500}, AT_1000_M, True),
        ({"floor_m": 0, "ceiling_m": 600}, (500.0, 1000.0), True),
        ({"floor_m": 1200}, (500.0, 1000.0), False),
    ],
)
def test_a_zone_holds_between_its_floor_and_its_ceiling(tmp_path, properties, altitudes_m, holds):
    zones = read_zones(written(tmp_path, feature(SQUARE, **properties)))
    found = closed_by_zones(zones, grid_of(), CLOCK, corridor_m=0.0, altitudes_m=altitudes_m)
    assert found.any() == holds


def test_a_collection_joins_its_features(tmp_path):
    other = polygon(closed_ring([(-81.2, 28.0), (-81.0, 28.0), (-81.1, 28.2)]))
    both = {"type": "FeatureCollection", "features": [feature(SQUARE), feature(other)]}
    found = closed_by_zones(
        read_zones(written(tmp_path, both)), grid_of(), CLOCK, corridor_m=0.0, altitudes_m=AT_1000_M
    )
    parts = [
        closed_by_zones(
            read_zones(written(tmp_path, part)), grid_of(), CLOCK, corridor_m=0.0, altitudes_m=AT_1000_M
        )
        for part in (SQUARE, other)
    ]
    np.testing.assert_array_equal(found, parts[0] | parts[1])
    assert (parts[1] & ~parts[0]).any()


RING = [[-81.6, 28.3], [-81.3, 28.3], [-81.3, 28.6], [-81.6, 28.3]]


@pytest.mark.parametrize(
    ("document", "message"),
    [
        ("{", "are not JSON"),
        ([], "feature 0 is no object"),
        ({"type": "FeatureCollection", "features": []}, "hold no polygon"),
        ({"type": "Point", "coordinates": [1, 2]}, "is of type 'Point'; give Polygon or MultiPolygon"),
        (feature(None), "is of type None"),
        ({"type": "MultiPolygon", "coordinates": []}, "has no coordinates"),
        ({"type": "Polygon", "coordinates": []}, "polygon without a ring"),
        ({"type": "Polygon", "coordinates": [[]]}, "less than four positions"),
        ({"type": "Polygon", "coordinates": [RING[:3]]}, "less than four positions"),
        ({"type": "Polygon", "coordinates": [[*RING[:3], [-81.0, 28.0]]]}, "close it"),
        ({"type": "Polygon", "coordinates": [[[28.3, -181.0], *RING]]}, "latitude -181"),
        ({"type": "Polygon", "coordinates": [[["a", 1], *RING]]}, r"write \[longitude, latitude\]"),
        ('{"type": "Polygon", "coordinates": [[[NaN, 1], [1, 1], [1, 2], [NaN, 1]]]}', "has the position"),
        (
            polygon(closed_ring([(-81.6, 28.3), (-81.3, 28.6), (-81.3, 28.3), (-81.6, 28.6)])),
            "Self-intersection.*without crossing itself",
        ),
        (polygon(closed_ring([(-81.6, 28.3), (-81.3, 28.3), (-81.4, 28.3)])), "polygon that is none"),
        (polygon(closed_ring([(-120, 80), (0, 80), (120, 80)])), "around a pole"),
        (feature(SQUARE, begin="soon"), "begin is 'soon'; write a time"),
        (feature(SQUARE, begin="2022-09-30", end="2022-09-29"), "swap them"),
        (feature(SQUARE, floor_m="FL100"), "floor_m is 'FL100'; write a number of metres"),
        (feature(SQUARE, ceiling_m=True), "ceiling_m is True; write a number of metres"),
        (feature(SQUARE, floor_m=900, ceiling_m=300), "the floor 900 m and the ceiling 300 m; swap them"),
        ({"type": "Feature", "geometry": SQUARE, "properties": [1]}, "properties that are no object"),
    ],
)
def test_what_makes_no_sense_is_named(tmp_path, document, message):
    with pytest.raises(HazardError, match=message) as refused:
        read_zones(written(tmp_path, document))
    assert "zones.geojson" in str(refused.value)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(HazardError, match=r"cannot read no-fly zones from .*none\.geojson"):
        read_zones(tmp_path / "none.geojson")
