"""`galeway weather`: told, saved and drawn, of files and of scenarios; what it cannot do is named."""

import json
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

from planner.errors import PlannerError
from sim.cli_weather import weather
from sim.errors import SimError, WeatherError
from sim.weather.files import Reading, read_wind
from sim.weather_job import Wanted, files_weather, moment_s

SHORT = ["--set", "stages.count=2", "--set", "grid.cell_m=20000"]


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    """The wind of a scenario as a file, a picture of it, and what was said."""
    folder = tmp_path_factory.mktemp("weather")
    zone = [[-90.0, 24.0], [-86.0, 24.0], [-86.0, 27.0], [-90.0, 24.0]]
    (folder / "zones.geojson").write_text(json.dumps({"type": "Polygon", "coordinates": [zone]}))
    also = f'hazard.also=[{{kind="no_fly",file="{folder}/zones.geojson"}}]'
    files = ["--save", f"{folder}/ian.nc", "--picture", f"{folder}/ian.png"]
    done = CliRunner().invoke(weather, ["ian", *SHORT, "--set", also, *files], catch_exceptions=False)
    assert done.exit_code == 0, done.output
    return folder, done.output


def test_a_scenarios_forecast_is_told_saved_and_drawn(saved):
    folder, said = saved
    assert "hazard: wind over 15 m/s" in said
    assert "no-fly zones" in said
    besides = [float(line.split()[-2]) for line in said.splitlines()[-2:]]
    assert besides[0] == besides[1] > 3.0
    assert (folder / "ian.png").read_bytes().startswith(b"\x89PNG")
    wind = read_wind(folder / "ian.nc")
    assert wind.time_s[0] == 1664409600.0
    assert np.hypot(wind.north_mps, wind.east_mps).max() > 40.0


def test_a_saved_file_is_weather_like_any_other(saved, tmp_path):
    folder, _ = saved
    again = tmp_path / "again.nc"
    files = ["--save", str(again), "--picture", f"{tmp_path}/a.png", "--at", "2022-09-29T00:30"]
    done = CliRunner().invoke(weather, [str(folder / "ian.nc"), *files], catch_exceptions=False)
    assert done.exit_code == 0, done.output
    assert "flying    yes" in done.output
    with xr.open_dataset(folder / "ian.nc") as one, xr.open_dataset(again) as other:
        for name in ("u", "v", "time", "lat", "lon"):
            np.testing.assert_array_equal(one[name].values, other[name].values)
    assert (tmp_path / "a.png").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["ian", "--save", "ian.grib"], ["name it ian.nc"]),
        (["ian", "--picture", "ian.jpg"], ["ian.jpg does not end in .png"]),
        (["ian", "--picture", "nowhere/ian.png"], ["there is no folder nowhere"]),
        (["ian", "--at", "2022-09-29"], ["--at and --altitude say what --picture draws"]),
        (["ian", "--picture", "a.png", "--at", "2022-09-29", "--at", "2022-09-30"], ["given 2 times"]),
        (["ian", "--picture", "ian.png", "--at", "noon"], ["'noon' is no time"]),
        (["ian", "--picture", "ian.png", "--at", "2022-10-20"], ["2022-10-20"]),
        (["ian", "--threshold", "20"], ["--threshold belongs to files"]),
        (["ian", "--json"], ["--json belongs to files"]),
        (["missing.toml"], ["no scenario 'missing.toml'"]),
        (["wind.nc", "--set", "a=1"], ["--set belongs to a scenario"]),
        (["ian", "--set", 'hazard.also=[{kind="no_fly",file="none.geojson"}]'], ["cannot read no-fly zones"]),
    ],
)
def test_what_cannot_be_done_is_named(tmp_path, monkeypatch, arguments, words):
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(weather, [*arguments, *(SHORT if arguments[0] == "ian" else [])])
    assert isinstance(done.exception, SystemExit | SimError | PlannerError), done.exception
    assert done.exit_code in (1, 2)  # an error that the command line turns into its own message is a 1 here
    for word in words:
        assert word in f"{done.output}{done.exception}"


def test_a_mistake_is_one_message(galeway, tmp_path):
    done = galeway("weather", "ian", "--save", "ian.grib", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith("galeway: weather is saved as NetCDF")
    assert done.stderr.count("\n") == 1


def test_gusts_without_direction_are_drawn_and_not_saved(data_folder, tmp_path):
    pytest.importorskip("cfgrib")
    gusts = data_folder / "ens_stjude_gust_20131025.grib"
    if not gusts.exists():
        pytest.skip(f"{gusts} is not there")
    asked = {"threshold_mps": 20.0, "member": 7, "gust": "fg10_3"}
    wanted = Wanted(picture=tmp_path / "g.png", at_s=moment_s("2013-10-28T06:00"))
    files_weather([gusts], Reading(), wanted, **asked)
    drawn = (tmp_path / "g.png").read_bytes()
    files_weather([gusts], Reading(), replace(wanted, at_s=moment_s("2013-10-28T03:30")), **asked)
    assert (tmp_path / "g.png").read_bytes() == drawn  # of the same window
    with pytest.raises(
        WeatherError, match=r"windows that end at 2013-10-28T00:00:00, .*, not 2013-10-28T01:00"
    ):
        files_weather([gusts], Reading(), replace(wanted, at_s=moment_s("2013-10-28T01:00")), **asked)
    with pytest.raises(WeatherError, match="not its direction"):
        files_weather([gusts], Reading(), Wanted(save=tmp_path / "g.nc"), **asked)
