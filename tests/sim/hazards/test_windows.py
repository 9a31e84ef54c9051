"""Hazard from what holds over windows of time: in their stages alone, gaps, and the whole mission."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from sim.errors import SimError, WeatherError
from sim.hazard_tables import EnsembleHazard, GustHazard, VariableHazard
from sim.hazards.joining import Around, join_hazards
from sim.weather.files import Reading


def windowed(path, values, edges_h, name="gust", **attributes):
    """A CF file of maxima over windows [h after departure], over the mission's grid and around."""
    unit = {"units": "hours since 2022-09-29"}
    lat_deg, lon_deg = 27.9 + 0.05 * np.arange(14), -82.1 + 0.05 * np.arange(16)
    edges_h = np.array(edges_h, dtype=float)
    words = {"units": "m s-1", "cell_methods": "time: maximum"} | attributes
    xr.Dataset(
        {
            name: (("time", "lat", "lon"), values.astype(np.float32), words),
            "time_bnds": (("time", "bnds"), edges_h),
        },
        {
            "time": ("time", edges_h[:, 1], unit | {"bounds": "time_bnds"}),
            "lat": ("lat", lat_deg, {"units": "degrees_north"}),
            "lon": ("lon", lon_deg, {"units": "degrees_east"}),
        },
    ).to_netcdf(path)
    return path


@pytest.mark.parametrize(
    ("edges_h", "strong", "closed"),
    [
        ([[-1, 0], [0, 1], [1, 2], [2, 3], [3, 4]], 0, []),  # moments would close the first stage
        ([[-1, 0], [0, 1], [1, 2], [2, 3], [3, 4]], 2, [1]),
        ([[0, 3], [3, 6]], 0, [0, 1, 2]),
        ([[0, 3], [3, 6]], 1, []),
        ([[0, 1.5], [1.5, 3]], 1, [1, 2]),
        ([[0, 1], [0, 2], [0, 3]], 2, [2]),  # since the forecast's start
        ([[0, 1], [2, 3]], 0, [0, 1]),  # a gap of an hour is bridged by both sides
        ([[0, 1], [2, 3]], 1, [1, 2]),
    ],
)
@pytest.mark.parametrize("kind", ["gust", "variable", "ensemble"])
def test_a_maximum_is_hazardous_in_its_window_and_in_no_other_stage(
    joined, tmp_path, kind, edges_h, strong, closed
):
    values = 5.0 * np.ones((len(edges_h), 14, 16))
    values[strong] = 25.0
    path = windowed(tmp_path / "max.nc", values, edges_h)
    if kind == "ensemble":
        with xr.open_dataset(path, decode_times=False) as data:
            both = data.load()
        both["gust"] = both.gust.expand_dims(number=[0, 1]).copy()
        both.to_netcdf(path)
    table = {
        "gust": GustHazard(threshold_mps=20.0),
        "variable": VariableHazard("gust", "m s-1", above=20.0),
        "ensemble": EnsembleHazard(more_than=0.5, threshold_mps=20.0, variable="gust"),
    }[kind]
    found = joined(table, files=[path]).planned.closed
    assert found.all(axis=(1, 2)).tolist() == [stage in closed for stage in range(3)]
    assert found.any(axis=(1, 2)).tolist() == [stage in closed for stage in range(3)]


def test_a_gap_between_windows_is_refused_unless_it_is_bridged(joined, stages, tmp_path):
    path = windowed(tmp_path / "max.nc", 25.0 * np.ones((3, 14, 16)), [[-3, 0.5], [2.5, 3], [9, 12]])
    for table in (GustHazard(threshold_mps=20.0), VariableHazard("gust", "m s-1", above=20.0)):
        with pytest.raises(
            WeatherError,
            match=r"gust of max\.nc has no values between 2022-09-29T00:30:00 and 2022-09-29T02:30:00 UTC, "
            r"2 h apart \(limit 1 h\); .* the values on either side with weather\.bridge_gaps_h = 2",
        ):
            joined(table, files=[path])
        bridged = replace(stages, bridge_s=7200.0)
        around = Around(tmp_path, (path,), Reading(), 15.0)
        assert join_hazards((table,), bridged, around).planned.closed.all()


def test_windows_have_to_hold_the_whole_mission(joined, tmp_path):
    path = windowed(tmp_path / "max.nc", np.ones((2, 14, 16)), [[0.5, 2], [2, 3]])
    with pytest.raises(
        SimError, match="holds 2022-09-29T00:30:00 to 2022-09-29T03:00:00 UTC, but the mission"
    ):
        joined(GustHazard(threshold_mps=20.0), files=[path])
