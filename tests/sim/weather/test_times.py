"""Times of weather files: units, single precision, leap days, reference times and steps, gaps."""

import numpy as np
import pytest
import xarray as xr
from hypothesis import assume, given
from hypothesis import strategies as st

from sim.errors import WeatherError
from sim.weather.axes import find_axes
from sim.weather.times import gaps_s, moments_s

ANGLES = {
    "latitude": ("latitude", [50.0, 51.0], {"units": "degrees_north"}),
    "longitude": ("longitude", [4.0, 5.0], {"units": "degrees_east"}),
}
UNITS_S = {"seconds": 1.0, "minutes": 60.0, "hours": 3600.0, "days": 86400.0}
DAY_S = 86400.0


@given(
    unit=st.sampled_from(sorted(UNITS_S)),
    base_day=st.sampled_from(
        [-25567, -719162, 0, 10957, 18262, 19782]
    ),  # 1900, 0001, 1970, 2000, 2020, 2024-02-29
    first_h=st.integers(0, 2400),
    spacing_h=st.sampled_from([1, 3, 6]),
    kind=st.sampled_from(["float32", "float64", "int64"]),
)
def test_whole_hours_come_back_whole_in_any_precision_that_can_tell_them_apart(
    unit, base_day, first_h, spacing_h, kind
):
    """From 2024-02-20 on, so that most series hold or reach the leap day."""
    begin_s = 19773 * DAY_S + 3600.0 * first_h
    expected_s = begin_s + 3600.0 * spacing_h * np.arange(4)
    counts = ((expected_s - base_day * DAY_S) / UNITS_S[unit]).astype(kind)
    if kind == "int64":
        assume(((counts * UNITS_S[unit]) == expected_s - base_day * DAY_S).all())
    assume(
        UNITS_S[unit] * np.spacing(np.abs(counts).max().astype("float32" if kind == "float32" else "float64"))
        < 1800
    )
    base = np.datetime64("1970-01-01", "D") + base_day
    attributes = {"units": f"{unit} since {base}", "calendar": "proleptic_gregorian"}
    time = xr.DataArray(counts, dims="time", name="time", attrs=attributes)
    np.testing.assert_array_equal(moments_s(time), expected_s)


def test_uneven_times_stay_as_they_are():
    time = xr.DataArray(
        [0.0, 0.013, 1.7], dims="time", name="time", attrs={"units": "hours since 2024-02-29"}
    )
    np.testing.assert_allclose(moments_s(time) - 1709164800.0, [0.0, 46.8, 6120.0], atol=1e-3)


def variable(times, dims=("time",)):
    shape = [size for _, size in dims] if isinstance(dims[0], tuple) else [len(times["time"][1])]
    names = [name for name, _ in dims] if isinstance(dims[0], tuple) else list(dims)
    values = np.zeros((*shape, 2, 2))
    return xr.DataArray(values, dims=(*names, "latitude", "longitude"), coords=ANGLES | times, name="u")


REFERENCE = ((), 12.0, {"standard_name": "forecast_reference_time", "units": "hours since 2024-02-28"})


def test_a_reference_time_and_steps_make_times():
    steps = ("step", [0, 90, 1440], {"standard_name": "forecast_period", "units": "minutes"})
    axes = find_axes(variable({"time": REFERENCE, "step": steps}, (("step", 3),)))
    assert axes.time == "step"
    assert axes.issued_s == 1709121600.0
    np.testing.assert_array_equal(axes.time_s - axes.issued_s, [0.0, 5400.0, DAY_S])


def test_valid_times_win_over_reference_time_and_steps():
    valid = ("step", [15, 18], {"standard_name": "time", "units": "hours since 2024-02-28"})
    steps = ("step", [3, 6], {"standard_name": "forecast_period", "units": "hours"})
    axes = find_axes(variable({"time": REFERENCE, "step": steps, "valid_time": valid}, (("step", 2),)))
    np.testing.assert_array_equal(axes.time_s - axes.issued_s, [10800.0, 21600.0])


def test_a_single_time_needs_no_axis():
    step = ((), 6, {"standard_name": "forecast_period", "units": "hours"})
    axes = find_axes(variable({"time": REFERENCE, "step": step}, (("x1", 1),)))
    assert axes.time is None
    np.testing.assert_array_equal(axes.time_s - axes.issued_s, [21600.0])


def test_several_forecasts_in_one_file_are_refused():
    references = ("time", [0.0, 12.0], REFERENCE[2])
    steps = ("step", [0, 6], {"standard_name": "forecast_period", "units": "hours"})
    with pytest.raises(WeatherError, match=r"u holds 2 forecasts \(time\); give the files of one"):
        find_axes(variable({"time": references, "step": steps}, (("time", 2), ("step", 2))))
    valid = (
        ("time", "step"),
        [[0, 6], [12, 18]],
        {"standard_name": "time", "units": "hours since 2024-02-28"},
    )
    with pytest.raises(WeatherError, match=r"valid_time on \(time, step\), several forecasts"):
        find_axes(variable({"time": references, "valid_time": valid}, (("time", 2), ("step", 2))))


def test_a_step_without_a_unit_is_no_time():
    steps = ("step", [0, 6], {"standard_name": "forecast_period"})
    with pytest.raises(
        WeatherError, match=r"lacks a time axis .* or a reference time and a forecast step.*step \(no unit\)"
    ):
        find_axes(variable({"time": REFERENCE, "step": steps}, (("step", 2),)))


@pytest.mark.parametrize(
    ("hours", "gaps"),
    [
        ([0, 1, 2, 3], []),
        ([0, 3, 6, 9], []),
        ([0, 6], []),
        ([0, 1, 3, 4], [(1, 3)]),
        ([0, 3, 9, 12], [(3, 9)]),
        ([0, 1, 2, 5, 8, 11], []),  # hourly, then three-hourly, as forecasts are
        ([0, 0.25, 1.25, 1.5], []),  # no more than an hour
        ([0, 3, 9], [(3, 9)]),
        ([5], []),
    ],
)
def test_a_gap_is_where_a_time_is_missing(hours, gaps):
    assert [(a / 3600.0, b / 3600.0) for a, b in gaps_s(3600.0 * np.array(hours, dtype=float))] == gaps
