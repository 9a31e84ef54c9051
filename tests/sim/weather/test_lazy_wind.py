"""Files that are read where they are asked for: the same wind, in little memory."""

import math
import subprocess
import sys
from pathlib import Path

import netCDF4
import numpy as np
import pytest

from planner.grid import Grid
from planner.tiled import is_tiled
from sim.errors import WeatherError
from sim.scenario import load_scenario
from sim.weather import lazy_wind
from sim.weather.files import read_wind
from sim.weather.source import bring_weather

HEIGHTS_M = np.array([10.0, 100.0, 250.0, 500.0, 1000.0, 2000.0, 4000.0])


def write(path, side, times, *, heights=HEIGHTS_M, falling=False, spoil=None):
    """A breeze that grows with height and time, and a gale in one place; 1 km cells."""
    with netCDF4.Dataset(path, "w") as file:
        lat_deg, lon_deg = 29.0 + 0.009 * np.arange(side), -91.0 + 0.01 * np.arange(side)
        axes = {
            "time": ("hours since 2022-09-29 00:00:00", np.arange(times)),
            "height": ("m", heights),
            "lat": ("degrees_north", lat_deg[::-1] if falling else lat_deg),
            "lon": ("degrees_east", lon_deg),
        }
        for name, (unit, values) in axes.items():
            file.createDimension(name, len(values))
            variable = file.createVariable(name, "f8", (name,))
            variable.units = unit
            variable[:] = values
        file["height"].standard_name = "height"
        chunk = (1, 1, min(side, 200), min(side, 200))
        for name, factor in (("eastward_wind", 1.0), ("northward_wind", -0.5)):
            wind = file.createVariable(name, "f4", tuple(axes), zlib=True, complevel=1, chunksizes=chunk)
            wind.standard_name, wind.units = name, "m s-1"
            for time in range(times):
                for height in range(len(heights)):
                    sheet = np.full((side, side), 3.0 + 0.1 * height + 0.1 * time, np.float32)
                    sheet += 0.001 * np.arange(side, dtype=np.float32)[:, np.newaxis]
                    sheet[side // 2 : side // 2 + 8, side // 4 : side // 4 + 8] = 20.0
                    wind[time, height] = factor * sheet
        if spoil is not None:
            file["eastward_wind"][2, 3, 5, 7] = spoil
    return path


@pytest.fixture
def small(tmp_path, monkeypatch):
    """A small file, which counts as large or not: (is_large, how it is written) -> field."""

    def made(large, **how):
        path = tmp_path / "wind.nc"
        if not path.exists():
            write(path, 120, 4, **how)
        monkeypatch.setattr(lazy_wind, "LARGE_BYTES", 0 if large else 1e12)
        return read_wind(path)

    return made


@pytest.mark.parametrize("how", [{}, {"falling": True}, {"heights": np.array([300.0])}])
def test_the_wind_is_the_same_however_it_is_read(small, how):
    there, unread = small(False, **how), small(True)
    assert is_tiled(unread.north_mps)
    assert not is_tiled(there.north_mps)
    assert unread.grid == there.grid
    np.testing.assert_array_equal(unread.time_s, there.time_s)
    np.testing.assert_array_equal(unread.height_m, there.height_m)
    for name in ("north_mps", "east_mps"):
        np.testing.assert_array_equal(getattr(unread, name)[:], getattr(there, name))
    probes, random = (there.probe(), unread.probe()), np.random.default_rng(2)
    for share in random.uniform(0.0, 1.0, (200, 4)):
        point = [
            float(axis[0] + part * (axis[-1] - axis[0]))
            for axis, part in zip(
                (there.time_s, there.grid.lat_rad, there.grid.lon_rad, np.array([20.0, 3000.0])),
                share,
                strict=True,
            )
        ]
        assert probes[0](*point) == probes[1](*point)


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (math.nan, r"eastward_wind has 1 gaps .* among 14400 values at 2022-09-29T02:00:00"),
        (1e6, r"eastward_wind has a wind of 1e\+06 m/s at 2022-09-29T02:00:00, which blows nowhere"),
    ],
)
def test_what_cannot_be_used_is_found_before_take_off(small, spoil, message):
    with pytest.raises(WeatherError, match=message):
        small(True, spoil=spoil)


SCENARIO = """\
name = "large"
[mission]
departure = 2022-09-29T00:00:00Z
goal = "There"
start = { name = "Here", lat_deg = 29.30, lon_deg = -90.60 }
goals = [{ name = "There", lat_deg = 29.52, lon_deg = -90.35 }]
[weather]
file = "wind.nc"
[weather.truth]
speed_factor = 1.1
[planner]
objective = "earliest"
"""


AREA = """
steps = 120
step_s = 30.0
[hazard]
corridor_m = 400.0
[grid]
south_deg = 29.0
north_deg = 32.0
west_deg = -91.0
east_deg = -88.0
"""


def scenario(folder, stages, area=""):
    path = folder / "large.toml"
    path.write_text(f"{SCENARIO}[stages]\ncount = {stages}\n{area}")
    return path


def test_forecast_and_truth_of_a_scenario_are_the_same(tmp_path, monkeypatch):
    write(tmp_path / "wind.nc", 130, 3)
    loaded = load_scenario(str(scenario(tmp_path, 2)), ())
    there = bring_weather(loaded)
    monkeypatch.setattr(lazy_wind, "LARGE_BYTES", 0)
    unread = bring_weather(loaded)
    assert is_tiled(unread.truth.north_mps)
    np.testing.assert_array_equal(unread.forecast.east_mps, there.forecast.east_mps)
    grid = Grid.covering(*np.radians([29.1, 29.9, -90.9, -90.1]).tolist(), rows=9, columns=9)
    np.testing.assert_allclose(
        unread.truth.level(1000.0, grid).east_mps, there.truth.level(1000.0, grid).east_mps, rtol=1e-6
    )


FLY = """
from sim.job import Files, run
from sim.scenario import load_scenario
loaded, files = load_scenario(sys.argv[1], ()), Files(Path(sys.argv[2]))
flown = run(loaded, files, on_plan=lambda _: None, on_time=lambda _: None, tell=lambda _: None)
assert flown.end.outcome == "arrived", flown.end
"""
CROSS = """
import numpy as np
from planner.grid import Grid
from sim.weather.files import read_wind
wind = read_wind(Path(sys.argv[1]))
ends = wind.time_s[[0, -1]], wind.grid.lat_rad[[1, -2]], wind.grid.lon_rad[[1, -2]], [990.0, 1010.0]
probe, share = wind.probe(), np.linspace(0.0, 1.0, 20_000)
for point in np.transpose([low + share * (high - low) for low, high in ends]).tolist():
    probe(*point)
area = Grid.covering(*ends[1], *ends[2], rows=300, columns=300)
assert wind.level(1000.0, area).north_mps.shape == (19, 300, 300)
"""
PEAK = """
status = Path("/proc/self/status").read_text()
print(next(line.split()[1] for line in status.splitlines() if line.startswith("VmHWM")))
"""


def peak_mb(script, *arguments):
    """The largest resident size of a process that runs a script."""
    command = [sys.executable, "-c", f"import sys\nfrom pathlib import Path\n{script}{PEAK}", *arguments]
    root = Path(__file__).parents[3]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=root)
    assert done.returncode == 0, done.stderr
    return float(done.stdout.split()[-1]) / 1e3


@pytest.mark.slow
def test_two_gigabytes_are_flown_through_in_less_than_half_of_that(tmp_path):
    side, times = 1400, 19
    path = write(tmp_path / "wind.nc", side, times)
    field_mb = 2 * 4 * times * len(HEIGHTS_M) * side * side / 1e6
    assert field_mb > 2000.0
    mission = scenario(tmp_path, 3, AREA)
    for script, *arguments in ((CROSS, path), (FLY, mission, tmp_path / "out")):
        assert peak_mb(script, *arguments) < field_mb / 2.0
