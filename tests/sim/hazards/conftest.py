"""A mission over a small grid, and weather files for it."""

import math

import numpy as np
import pytest
import xarray as xr

from planner.grid import Grid
from planner.hazards import StageClock
from sim.hazards.field import Stages
from sim.hazards.joining import Around, join_hazards
from sim.weather.files import Reading

TIMES = np.array(["2022-09-29T00", "2022-09-29T01", "2022-09-29T02", "2022-09-29T03"], dtype="datetime64[ns]")
GRID = Grid(*map(math.radians, (28.0, -82.0, 0.05, 0.05)), 9, 11)
CLOCK = StageClock(1664409600.0, stage_count=3)


@pytest.fixture
def stages():
    return Stages(GRID, CLOCK, altitude_m=500.0, corridor_m=1100.0)


@pytest.fixture
def weather_file(tmp_path):
    """Writes a CF file: values [time, lat, lon], or with number in front, or with level_m; its path."""

    def written(name="weather.nc", *, step_deg=0.05, south=27.9, west=-82.1, level_m=None, **variables):
        data = {}
        for variable, (unit, values) in variables.items():
            dims = ["time", "lat", "lon"] if level_m is None else ["time", "height", "lat", "lon"]
            if values.ndim > len(dims):
                dims = ["number", *dims]
            data[variable] = (dims, values.astype(np.float32), {"units": unit})
        rows, columns = next(iter(variables.values()))[1].shape[-2:]
        coordinates = {
            "time": ("time", TIMES, {"standard_name": "time"}),
            "lat": ("lat", south + step_deg * np.arange(rows), {"units": "degrees_north"}),
            "lon": ("lon", west + step_deg * np.arange(columns), {"units": "degrees_east"}),
        }
        if level_m is not None:
            coordinates["height"] = ("height", level_m, {"standard_name": "height", "units": "m"})
        path = tmp_path / name
        xr.Dataset(data, coordinates).to_netcdf(path, engine="netcdf4")
        return path

    return written


@pytest.fixture
def joined(stages, tmp_path):
    """Joins the hazards of tables."""

    def join(*tables, files=(), **more):
        around = Around(tmp_path, tuple(files), Reading(), 15.0, **more)
        return join_hazards(tables, stages, around)

    return join
