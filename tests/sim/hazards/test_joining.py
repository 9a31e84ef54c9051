"""Hazards of every kind on a mission's grid: each by its own oracle, joined, and what does not fit."""

import json
import math

import numpy as np
import pytest
import xarray as xr
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from planner.grid import Grid
from planner.hazards import strongest_mps
from planner.survival import probability_from_members
from planner.windfield import WindField
from sim.errors import HazardError, SimError, WeatherError
from sim.hazard_tables import EnsembleHazard, GustHazard, MatricesHazard, NoFlyHazard, VariableHazard

GRID = Grid(*map(math.radians, (28.0, -82.0, 0.05, 0.05)), 9, 11)  # that of `stages`
TIMES = np.arange("2022-09-29T00", "2022-09-29T04", dtype="datetime64[h]").astype("datetime64[ns]")
SHAPE = (3, 9, 11)
SOURCE = (4, 14, 16)  # times, and two or three cells more on each side
INNER = (slice(None), slice(2, 11), slice(2, 13))  # the mission's grid in the source's
RAIN = VariableHazard("rain", "mm h-1", above=5.0)


def random(shape, seed=0, low=0.0, high=30.0):
    return np.random.default_rng(seed).uniform(low, high, shape)


def held(values):
    """The largest of the times at both ends of each hour."""
    return np.maximum(values[:-1], values[1:])


def test_a_variable_over_its_limit_stage_by_stage(weather_file, joined):
    rain = random(SOURCE, high=10.0)
    path = weather_file(rain=("mm h-1", rain))
    found = joined(RAIN, files=[path])
    expected = (held(rain.astype(np.float32)) > 5.0)[INNER]
    np.testing.assert_array_equal(found.planned.closed, expected)
    np.testing.assert_array_equal(found.true, expected)
    assert 0 < expected.sum() < expected.size
    assert found.planned.chance is None


@pytest.mark.parametrize(
    ("unit", "wanted", "limit", "factor"),
    [
        ("kg m-2 s-1", "mm h-1", 5.0, 3600.0),
        ("degC", "K", 5.0, None),
        ("%", "1", 0.3, 0.01),
        ("dBZ", "dBZ", 5.0, 1.0),
    ],
)
def test_units_are_turned(weather_file, joined, unit, wanted, limit, factor):
    asked = random(SOURCE, high=2.0 * limit) + (270.0 if factor is None else 0.0)
    values = asked - 273.15 if factor is None else asked / factor
    above = limit + (270.0 if factor is None else 0.0)
    path = weather_file(field=(unit, values))
    found = joined(VariableHazard("field", wanted, above=above), files=[path])
    sure = np.abs(held(asked) - above)[INNER] > 1e-4
    np.testing.assert_array_equal(found.true[sure], (held(asked) > above)[INNER][sure])


def test_below_and_above_join(weather_file, joined):
    values = random(SOURCE)
    path = weather_file(ceiling=("m", values))
    found = joined(VariableHazard("ceiling", "m", above=25.0, below=3.0), files=[path])
    values = values.astype(np.float32)
    hazard = (values > 25.0) | (values < 3.0)
    np.testing.assert_array_equal(found.true, (hazard[:-1] | hazard[1:])[INNER])


@pytest.mark.parametrize(("gaps", "is_hazard"), [("hazard", True), ("clear", False)])
def test_gaps_are_what_the_scenario_says(weather_file, joined, gaps, is_hazard):
    rain = np.zeros(SOURCE)
    rain[:, 5, 5] = np.nan
    path = weather_file(rain=("mm h-1", rain))
    found = joined(VariableHazard("rain", "mm h-1", above=5.0, gaps=gaps), files=[path])
    assert found.true.any() == is_hazard
    assert found.true[:, 3, 3].all() == is_hazard
    with pytest.raises(HazardError, match=r'has 4 gaps among .*gaps = "hazard" or gaps = "clear"'):
        joined(RAIN, files=[path])


def test_levels_around_the_altitude_count(weather_file, joined):
    ice = np.zeros((4, 4, *SOURCE[1:]))
    ice[:, 0, 4, 4] = ice[:, 1, 5, 5] = ice[:, 2, 6, 6] = ice[:, 3, 7, 7] = 1.0
    path = weather_file(level_m=np.array([10.0, 300.0, 700.0, 1500.0]), ice=("1", ice))
    found = joined(VariableHazard("ice", "1", above=0.5), files=[path])
    assert np.argwhere(found.true[0]).tolist() == [[3, 3], [4, 4]]
    high = weather_file("high.nc", level_m=np.array([600.0, 700.0, 800.0, 900.0]), ice=("1", ice))
    with pytest.raises(
        HazardError, match=r"600, 700, 800, 900 m above ground, and the mission is flown at 500 m"
    ):
        joined(VariableHazard("ice", "1", above=0.5), files=[high])


def test_gusts_of_a_file(weather_file, joined):
    gust = random(SOURCE)
    path = weather_file(gust=("m s-1", gust), other=("K", gust))
    found = joined(GustHazard(threshold_mps=24.0), files=[path], truth_factor=1.25)
    expected = held(gust.astype(np.float32))[INNER]
    # On the file's own nodes nothing is interpolated; the room around a cell only adds.
    assert not ((expected > 24.001) & ~found.planned.closed).any()
    np.testing.assert_array_equal(found.true, 1.25 * expected > 24.0)
    named = joined(GustHazard(threshold_mps=24.0, variable="gust"), files=[path])
    np.testing.assert_array_equal(named.planned.closed, found.planned.closed)
    assert joined(GustHazard(threshold_mps=24.0), files=[path], truth_factor=None).true is None


def test_gusts_in_knots_on_another_grid_lose_no_peak(weather_file, joined):
    gust = np.zeros((4, 70, 80))
    gust[:, 33, 41] = 60.0  # kt: 30.9 m/s in a cell a fifth as wide as the planner's
    path = weather_file(step_deg=0.01, gust=("kt", gust))
    found = joined(GustHazard(threshold_mps=30.0), files=[path])
    assert np.argwhere(found.true[0]).tolist() == [[5, 6]]  # 28.23 N, 81.69 W
    assert not joined(GustHazard(threshold_mps=31.0), files=[path]).planned.closed.any()


def test_an_ensemble_of_gusts(weather_file, joined):
    gust = random((5, *SOURCE))
    path = weather_file(gust=("m s-1", gust))
    table = EnsembleHazard(more_than=0.5, threshold_mps=20.0, file=str(path), variable="gust", blur_cells=2.0)
    found = joined(table)
    by_member = np.stack(
        [
            joined(GustHazard(threshold_mps=20.0), files=[alone]).planned.closed
            for alone in _each(weather_file, gust)
        ]
    )
    np.testing.assert_array_equal(found.planned.closed, by_member.mean(axis=0) > 0.5)
    expected = probability_from_members(by_member, blur_cells=2.0)
    np.testing.assert_allclose(found.planned.chance, expected, atol=1e-12)
    assert found.true is None
    assert 0 < found.planned.closed.sum() < found.planned.closed.size


def _each(weather_file, gust):
    return [weather_file(f"{n}.nc", gust=("m s-1", member)) for n, member in enumerate(gust)]


def test_an_ensemble_of_winds_from_files_or_the_weathers_own(weather_file, joined, stages):
    u, v = random((2, 4, *SOURCE), low=-20.0, high=20.0).astype(np.float32)
    path = weather_file(u=("m s-1", u), v=("m s-1", v))
    found = joined(EnsembleHazard(more_than=0.6, file=path.name, blur_cells=0.0))
    winds = [
        WindField(stages.grid, 1664409600.0 + 3600.0 * np.arange(4), north[INNER].copy(), east[INNER].copy())
        for north, east in zip(v, u, strict=True)
    ]
    share = np.mean([strongest_mps(wind, stages.clock, corridor_m=1100.0) > 15.0 for wind in winds], axis=0)
    inside = (slice(None), slice(1, -1), slice(1, -1))  # at the edge the file goes on where the grid ends
    np.testing.assert_allclose(found.planned.chance[inside], share[inside], atol=0.26)
    own = joined(
        EnsembleHazard(more_than=0.6, blur_cells=0.0), members=lambda stage: winds if stage == 0 else []
    )
    np.testing.assert_array_equal(own.planned.chance, share)
    np.testing.assert_array_equal(own.planned.closed, share > 0.6)


@settings(max_examples=10, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.integers(0, 2**32 - 1))
def test_joined_hazard_holds_each_part_and_no_more(tmp_path, weather_file, joined, seed):
    np.save(tmp_path / "mine.npy", random(SHAPE, seed) > 25.0)
    path = weather_file(
        f"{seed}.nc",
        rain=("mm h-1", random(SOURCE, seed, high=6.0)),
        gust=("m s-1", random(SOURCE, seed + 1)),
    )
    ring = [[-81.9, 28.1], [-81.7, 28.1], [-81.8, 28.3], [-81.9, 28.1]]
    (tmp_path / "zones.geojson").write_text(json.dumps({"type": "Polygon", "coordinates": [ring]}))
    tables = [
        MatricesHazard("mine.npy"),
        NoFlyHazard("zones.geojson"),
        VariableHazard("rain", "mm h-1", above=5.0, file=path.name),
        GustHazard(28.0, file=path.name),
        GustHazard(20.0, factor=1.4),
    ]
    whole, parts = joined(*tables), [joined(table) for table in tables[:-1]]
    np.testing.assert_array_equal(
        whole.planned.closed, np.any([part.planned.closed for part in parts], axis=0)
    )
    np.testing.assert_array_equal(whole.true, np.any([part.true for part in parts], axis=0))
    assert not (whole.true & ~whole.planned.closed).any()


def test_a_gust_factor_closes_no_cell_by_itself(joined):
    found = joined(GustHazard(20.0, factor=1.4))
    assert found.planned is None
    assert found.true is None


@pytest.mark.parametrize("name", ["mine.npz", "mine.npy"])
def test_matrices_of_ones_own(tmp_path, joined, name):
    cells = random(SHAPE) > 20.0
    if name == "mine.npz":
        np.savez(tmp_path / name, storms=cells, other=cells[0])
    else:
        np.save(tmp_path / name, cells.astype(np.int8))
    found = joined(MatricesHazard(name, key="storms" if name == "mine.npz" else None))
    np.testing.assert_array_equal(found.planned.closed, cells)
    np.testing.assert_array_equal(found.true, cells)


@pytest.mark.parametrize(
    ("array", "message"),
    [
        (np.zeros((2, 9, 11)), r"shape \(2, 9, 11\), but the mission has 3 stages of 9 rows and 11 columns"),
        (np.zeros((3, 11, 9)), r"shape \(3, 11, 9\)"),
        (np.full(SHAPE, np.nan), "no finite numbers"),
        (np.full(SHAPE, "x"), "no finite numbers"),
    ],
)
def test_matrices_that_do_not_fit_are_refused(tmp_path, joined, array, message):
    np.save(tmp_path / "mine.npy", array)
    with pytest.raises(HazardError, match=message):
        joined(MatricesHazard("mine.npy"))


def test_matrices_that_are_not_there_are_named(tmp_path, joined):
    with pytest.raises(SimError, match=r"cannot read hazard matrices from .*none\.npz"):
        joined(MatricesHazard("none.npz"))
    (tmp_path / "notes.npz").write_text("fair weather")
    with pytest.raises(SimError, match=r"notes\.npz: it is no whole file .* give \.npz or \.npy") as error:
        joined(MatricesHazard("notes.npz"))
    assert "pickle" not in str(error.value)
    np.savez(tmp_path / "two.npz", a=np.zeros(1), b=np.zeros(1))
    with pytest.raises(SimError, match="holds a, b; name one with key"):
        joined(MatricesHazard("two.npz"))


@pytest.mark.parametrize(
    ("table", "message"),
    [
        (VariableHazard("snow", "mm h-1", above=1.0), "lacks snow and has"),
        (
            VariableHazard("rain", "K", above=1.0),
            r"rain of weather.nc has the unit 'mm h-1', the scenario's limit 'K'",
        ),
        (VariableHazard("gust", "m s-1", above=1.0), "has 5 members"),
        (GustHazard(20.0), "5 members; for an ensemble"),
        (GustHazard(20.0, variable="rain"), "has the unit 'mm h-1', which is that of no speed"),
        (GustHazard(20.0, variable="holes"), "has 4 gaps"),
        (EnsembleHazard(0.5, variable="holes"), "has 4 gaps"),
        (EnsembleHazard(0.5, variable="plain"), "ensemble of 1 member says nothing"),
        (EnsembleHazard(0.5), "wind"),
    ],
)
def test_files_that_do_not_fit_are_refused(weather_file, joined, table, message):
    holes = np.zeros(SOURCE)
    holes[:, 5, 5] = np.nan
    path = weather_file(
        gust=("m s-1", random((5, *SOURCE))),
        rain=("mm h-1", random(SOURCE)),
        holes=("m s-1", holes),
        plain=("m s-1", random(SOURCE)),
    )
    with pytest.raises((HazardError, WeatherError), match=message):
        joined(table, files=[path])


def test_gusts_that_cannot_be_told_apart_or_are_not_there(weather_file, joined):
    both = weather_file(gust=("m s-1", random(SOURCE)), fg10=("m s-1", random(SOURCE)))
    with pytest.raises(HazardError, match=r"there is several \(gust, fg10\); name one with variable"):
        joined(GustHazard(20.0), files=[both])
    none = weather_file("none.nc", rain=("mm h-1", random(SOURCE)))
    with pytest.raises(HazardError, match="there is none, but rain"):
        joined(GustHazard(20.0), files=[none])


def test_files_elsewhere_are_refused(weather_file, joined):
    far = weather_file(south=40.0, rain=("mm h-1", random(SOURCE)), gust=("m s-1", random(SOURCE)))
    for table in (RAIN, GustHazard(20.0)):
        with pytest.raises((HazardError, WeatherError), match="latitude runs from 40"):
            joined(table, files=[far])
    near = weather_file(
        "near.nc", south=28.2, rain=("mm h-1", random(SOURCE)), gust=("m s-1", random(SOURCE))
    )
    with pytest.raises(HazardError, match=r"reaches from 28\.175"):
        joined(RAIN, files=[near])
    with pytest.raises(HazardError, match="does not hold the mission's area"):
        joined(GustHazard(20.0), files=[near])


def test_an_ensemble_that_nobody_brought(joined):
    with pytest.raises(HazardError, match="the weather has none; name the files"):
        joined(EnsembleHazard(0.5))


def test_the_weathers_own_ensemble_comes_anew_with_each_forecast(joined, tmp_path, stages):
    np.save(tmp_path / "mine.npy", random(SHAPE) > 28.0)
    time_s = 1664409600.0 + 3600.0 * np.arange(4)

    def members(issue):
        east = random((3, 4, *SHAPE[1:]), issue, high=20.0)
        return [WindField(stages.grid, time_s, np.zeros_like(part), part) for part in east]

    found = joined(MatricesHazard("mine.npy"), EnsembleHazard(more_than=0.5, blur_cells=0.0), members=members)
    mine = np.load(tmp_path / "mine.npy")
    for issue in range(3):
        over = np.stack(
            [strongest_mps(wind, stages.clock, corridor_m=1100.0) > 15.0 for wind in members(issue)]
        )
        closures = found.issued(issue)
        np.testing.assert_array_equal(closures.chance, over.mean(axis=0))
        np.testing.assert_array_equal(closures.closed, mine | (over.mean(axis=0) > 0.5))
        visited = [(0, (2, 3)), (2, (8, 10))]
        survivors = sum(not any(member[stage][cell] for stage, cell in visited) for member in over)
        assert closures.members.survivors(visited) == survivors
    np.testing.assert_array_equal(found.planned.chance, found.issued(0).chance)
    assert (found.issued(1).chance != found.planned.chance).any()
    np.testing.assert_array_equal(found.true, mine)
    assert joined(MatricesHazard("mine.npy"), members=members).issued is None


def test_a_variable_on_the_grid_of_a_map_projection(tmp_path, joined):
    """A grid turned by 20 degrees: where any of the four points around is hazardous, the cell is."""
    turn = np.radians(20.0)
    x, y = np.meshgrid(0.04 * np.arange(-15, 16), 0.04 * np.arange(-15, 16))
    lat, lon = 28.2 + x * np.sin(turn) + y * np.cos(turn), -81.75 + x * np.cos(turn) - y * np.sin(turn)
    rain = np.zeros((4, *lat.shape))
    rain[:, 16, 14] = 9.0
    data = xr.Dataset(
        {"rain": (("time", "y", "x"), rain, {"units": "mm h-1"})},
        {
            "time": ("time", TIMES, {"standard_name": "time"}),
            "lat": (("y", "x"), lat, {"standard_name": "latitude", "units": "degrees_north"}),
            "lon": (("y", "x"), lon, {"standard_name": "longitude", "units": "degrees_east"}),
        },
    )
    data["rain"].encoding["coordinates"] = "lat lon"
    path = tmp_path / "curved.nc"
    data.to_netcdf(path, engine="netcdf4")
    found = joined(RAIN, files=[path]).true[0]
    row, column = GRID.nearest_cell(np.radians(lat[16, 14]), np.radians(lon[16, 14]))
    assert found[row, column]
    rows, columns = np.nonzero(found)
    assert 1 <= len(rows) <= 12
    assert np.abs(rows - row).max() <= 2
    assert np.abs(columns - column).max() <= 2


def test_moments_that_are_missing_are_refused_of_other_files_too(weather_file, joined, tmp_path):
    rain = weather_file("whole.nc", rain=("mm h-1", random(SOURCE)))
    winds = weather_file("winds.nc", u=("m s-1", random((2, *SOURCE))), v=("m s-1", random((2, *SOURCE))))
    for path, table, what in (
        (rain, RAIN, r"rain of holed\.nc has no values"),
        (winds, EnsembleHazard(more_than=0.5), r"the ensemble of holed\.nc has no wind"),
    ):
        with xr.open_dataset(path) as data:
            longer = data.load().isel(time=[0, 1, 2, 3])
        times = longer.time.values[0] + np.array([-1, 0, 2, 4]) * np.timedelta64(3600, "s")
        longer.assign_coords(time=("time", times, {"standard_name": "time"})).to_netcdf(tmp_path / "holed.nc")
        assert joined(table, files=[path]).planned is not None
        joined(table, files=[tmp_path / "holed.nc"])  # two hours apart, as those after them
        times = longer.time.values[0] + np.array([0, 1, 3, 4]) * np.timedelta64(3600, "s")
        longer.assign_coords(time=("time", times, {"standard_name": "time"})).to_netcdf(tmp_path / "holed.nc")
        with pytest.raises(
            WeatherError, match=rf"{what} between 2022-09-29T01:00:00 and 2022-09-29T03:00:00"
        ):
            joined(table, files=[tmp_path / "holed.nc"])


def test_a_gust_that_is_looked_for_in_vain_is_told_with_the_file(weather_file, joined):
    rain = weather_file("rain.nc", rain=("mm h-1", random(SOURCE)))
    with pytest.raises(
        HazardError, match=r"looked for in rain\.nc, and there is none, but rain .* name one with"
    ):
        joined(GustHazard(threshold_mps=20.0), files=[rain])
