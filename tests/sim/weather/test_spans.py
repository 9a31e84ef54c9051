"""What time a value is of: windows from real NetCDF and GRIB files, and what lies between them."""

import json

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

from sim.errors import WeatherError
from sim.weather.files import read_values, read_wind
from sim.weather.spans import Spans, joined
from sim.weather.survey import survey
from sim.weather.survey_text import survey_json, survey_text

BEGIN_S, UNITS = 1709164800.0, "hours since 2024-02-29"
LAT_DEG, LON_DEG = np.linspace(50.0, 51.0, 3), np.linspace(4.0, 5.0, 4)
WINDOWS_H = np.array([[0, 3], [6, 9], [9, 12]])
GUST = np.array([20.0, 10.0, 30.0])[:, np.newaxis, np.newaxis] + np.zeros((3, 3, 4))


def hours(spans):
    """Begins and ends [h] from the first of the windows."""
    return [
        ((begin_s - BEGIN_S) / 3600.0, (end_s - BEGIN_S) / 3600.0)
        for begin_s, end_s in zip(spans.begin_s.tolist(), spans.end_s.tolist(), strict=True)
    ]


@st.composite
def windows(draw):
    """Windows that do not overlap, with and without gaps."""
    steps = draw(st.lists(st.tuples(st.integers(0, 3), st.integers(0, 4)), min_size=1, max_size=8))
    edges_h = np.cumsum([part + (number % 2) for pair in steps for number, part in enumerate(pair)])
    return Spans(*(edges_h.reshape(-1, 2).T * 3600.0))


@given(windows(), st.floats(0.0, 20.0), st.floats(0.1, 4.0))
def test_a_stage_has_the_windows_it_has_a_part_of_and_in_a_gap_those_around(spans, begin_h, long_h):
    begin_s, end_s = 3600.0 * begin_h, 3600.0 * (begin_h + long_h)
    if begin_s < spans.begin_s[0] or end_s > spans.end_s[-1]:
        return
    found = spans.during(begin_s, end_s)
    count = spans.begin_s.size
    inside = [n for n in range(count) if spans.end_s[n] > begin_s + 1 and spans.begin_s[n] < end_s - 1]
    before = max(n for n in range(count) if spans.begin_s[n] <= begin_s + 1e-3)
    after = min(n for n in range(count) if spans.end_s[n] >= end_s - 1e-3)
    assert list(range(count))[found] == list(range(min([before, *inside]), max([after, *inside]) + 1))
    in_gap = spans.end_s[before] < begin_s or spans.begin_s[after] > end_s
    assert in_gap or set(list(range(count))[found]) <= {*inside, before, after}


def test_moments_are_as_they_were():
    spans = Spans.at(3600.0 * np.array([0.0, 3.0, 6.0, 9.0]))
    assert not spans.windowed
    assert spans.gaps_s() == []
    assert spans.during(3600.0, 7200.0) == slice(0, 2)
    assert spans.during(3 * 3600.0, 4 * 3600.0) == slice(1, 3)
    spans.refuse_gaps(0.0, 9 * 3600.0, 3600.0, "a.nc", "wind")


def test_windows_since_the_forecasts_start_follow_each_other():
    since_start = Spans(np.zeros(3), 3600.0 * np.array([3.0, 6.0, 9.0]))
    np.testing.assert_array_equal(joined(since_start, "gust").begin_s, [0.0, 10800.0, 21600.0])
    by_six_hours = Spans(3600.0 * np.array([0.0, 0.0, 6.0, 6.0]), 3600.0 * np.array([3.0, 6.0, 9.0, 12.0]))
    assert joined(by_six_hours, "gust").gaps_s() == []
    within = Spans(np.array([10800.0, 0.0]), np.array([14400.0, 21600.0]))
    with pytest.raises(WeatherError, match=r"gust has windows of different kinds, 1970-01-01T03:00:00 to .*"):
        joined(within, "gust")


@pytest.fixture
def netcdf(tmp_path):
    """Writes gusts over windows beside an instant variable: (method, label) -> path."""

    def written(method="time: maximum", label=1.0, name="gust.nc", **attributes):
        dims, middle = ("time", "lat", "lon"), WINDOWS_H[:, 0] + label * np.diff(WINDOWS_H)[:, 0]
        words = {"standard_name": "wind_speed_of_gust", "units": "m s-1"} | attributes
        methods = {"cell_methods": method} if method else {}
        data = xr.Dataset(
            {
                "gust": (dims, GUST, words | methods),
                "now": (dims, GUST, {"units": "m s-1", "cell_methods": "time: point"}),
                "time_bnds": (("time", "bnds"), WINDOWS_H),
            },
            {
                "time": ("time", middle, {"bounds": "time_bnds", "units": UNITS}),
                "lat": ("lat", LAT_DEG, {"units": "degrees_north"}),
                "lon": ("lon", LON_DEG, {"units": "degrees_east"}),
            },
        )
        path = tmp_path / name
        data.to_netcdf(path)
        return path

    return written


@pytest.mark.parametrize("label", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("method", ["time: maximum", "area: mean time: maximum (interval: 1 minute)", None])
def test_a_maximum_in_a_cf_file_covers_its_bounds_wherever_its_time_lies(netcdf, method, label):
    path = netcdf(method, label)
    assert hours(read_values(path, "gust").spans) == [(0, 3), (6, 9), (9, 12)]
    moments = read_values(path, "now")
    np.testing.assert_array_equal(moments.spans.begin_s, moments.time_s)
    np.testing.assert_array_equal(moments.spans.end_s, moments.time_s)


def test_an_instant_is_one_though_its_times_have_bounds(netcdf):
    assert not read_values(netcdf("time: point"), "gust").spans.windowed
    assert not read_values(netcdf(None, standard_name="wind_speed"), "gust").spans.windowed
    assert read_values(netcdf("time: mean", standard_name="rainfall_rate"), "gust").spans.windowed


def test_what_no_window_covers_is_told_as_a_gap(netcdf):
    found = survey([netcdf()])
    text, told = survey_text(found), json.loads(survey_json(found))["quantity"]
    assert [seen.name for seen in found.variables] == ["gust", "now"]
    assert (
        "times     2024-02-29T00:00:00 to 2024-02-29T12:00:00 UTC, 3 windows of 3 h; each value is the "
        "highest of its window\ngaps      2024-02-29T03:00:00 to 2024-02-29T06:00:00\n"
    ) in text
    assert told["windows_s"][1] == ["2024-02-29T06:00:00Z", "2024-02-29T09:00:00Z"]
    shares = [stage.over[0] for stage in found.quantity.stages]
    np.testing.assert_array_equal(shares, [1, 1, 1, *[np.nan] * 3, 0, 0, 0, 1, 1, 1])
    assert text.count("gap\n") == 3
    assert told["stages"][4]["over"] == [None]
    assert [stage.begin_s for stage in found.quantity.stages] == [BEGIN_S + 3600.0 * n for n in range(12)]


def test_windows_that_share_a_stage_both_count_in_it(netcdf, tmp_path):
    with xr.open_dataset(netcdf(), decode_times=False) as data:
        short = data.load()
    edges_h = np.array([[0.0, 0.5], [0.5, 1.5], [1.5, 3.0]])
    short = short.assign_coords(time=("time", edges_h[:, 1], data.time.attrs))
    short["time_bnds"] = ("time", "bnds"), edges_h
    short["gust"][:] = np.array([1.0, 20.0, 2.0])[:, np.newaxis, np.newaxis]
    short.to_netcdf(tmp_path / "short.nc")
    stages = survey([tmp_path / "short.nc"]).quantity.stages
    assert [stage.over[0] for stage in stages] == [1.0, 1.0, 0.0]


@pytest.mark.parametrize(
    ("bounds", "attributes", "message"),
    [
        (np.zeros((3, 4)), {}, "must be a begin and an end for each of the 3 times time, and are 12 values"),
        (np.array([[0.0, 3.0], [np.nan, 9.0], [9.0, 12.0]]), {}, "or an end at 2024-02-29T09:00:00"),
        (WINDOWS_H, {"units": "m"}, "time 2024-02-29T03:00:00 the window 1970-01-01T00:00:00 to"),
        (WINDOWS_H + 4.0, {}, "2024-02-29T03:00:00 the window 2024-02-29T04:00:00 to 2024-02-29T07:00:00"),
        (WINDOWS_H[:, ::-1], {}, None),
        (60 * WINDOWS_H, {"units": "minutes since 2024-02-29"}, None),
    ],
)
def test_bounds_that_make_no_sense_are_named(netcdf, tmp_path, bounds, attributes, message):
    with xr.open_dataset(netcdf(), decode_times=False) as data:
        broken = data.load()
    broken["time_bnds"] = ("time", "bnds"), bounds, attributes
    broken.to_netcdf(tmp_path / "broken.nc")
    if message is None:
        assert hours(read_values(tmp_path / "broken.nc", "gust").spans) == [(0, 3), (6, 9), (9, 12)]
        return
    with pytest.raises(WeatherError, match=rf"broken\.nc .* the bounds time_bnds .*{message}"):
        read_values(tmp_path / "broken.nc", "gust")


def test_files_with_windows_of_different_lengths_are_refused(netcdf):
    paths = [netcdf(name="a.nc"), netcdf(name="b.nc")]
    for number, path in enumerate(paths):
        with xr.open_dataset(path, decode_times=False) as data:
            one = data.load().expand_dims(number=[number])
            one["time_bnds"] = data["time_bnds"].copy()
        one["time_bnds"][0, 0] -= number
        one.to_netcdf(path)
    with pytest.raises(WeatherError, match=r"gust has windows of different lengths at 2024-02-29T03:00:00"):
        read_values(paths, "gust")


EDITIONS = pytest.mark.parametrize("edition", [1, 2])


def message(edition, span, value, **more):
    """A gust of a window, or a wind of a moment."""
    moment = "-" not in span
    keys = {} if moment or edition == 1 else {"productDefinitionTemplateNumber": 8}
    kind = {"shortName": "10u"} if moment else {"shortName": "10fg3"}
    kind |= {} if moment else {"stepType": "max"}
    ground = {"lat_deg": LAT_DEG, "lon_deg": LON_DEG, "values": np.full((3, 4), value)}
    when = {"dataDate": 20240228, "dataTime": 2100, "stepRange": span}
    return keys | kind | when | ground | more


@EDITIONS
def test_a_maximum_in_a_grib_file_covers_its_step_range(edition, grib):
    pytest.importorskip("cfgrib")
    spans = {"12-15": 30.0, "3-6": 20.0, "9-12": 10.0}  # not in order, as files may be
    own = [message(edition, span, value) for span, value in spans.items()]
    winds = [
        message(edition, span, value, shortName=name)
        for span, value in (("3", 5.0), ("9", 7.0))
        for name in ("10u", "10v")
    ]
    path = grib("gust.grib", edition, [*own, *winds])
    (name,) = {seen.name for seen in survey([path]).variables} - {"u10", "v10"}
    found = read_values(path, name)
    assert hours(found.spans) == [(0, 3), (6, 9), (9, 12)]
    np.testing.assert_allclose(found.values[0, :, 0, 0, 0], [20.0, 10.0, 30.0])
    wind = read_values(path, "u10")
    np.testing.assert_array_equal(wind.spans.begin_s - BEGIN_S, [0.0, 21600.0])
    np.testing.assert_array_equal(wind.spans.end_s, wind.spans.begin_s)
    np.testing.assert_array_equal(read_wind(path).time_s, wind.time_s)


@EDITIONS
def test_windows_of_two_lengths_that_end_together_are_refused_where_they_are_asked_for(edition, grib):
    pytest.importorskip("cfgrib")
    winds = [message(edition, "3", 5.0, shortName=name) for name in ("10u", "10v")]
    both = [message(edition, span, 9.0, shortName="10fg") for span in ("4-6", "2-6")]
    path = grib("both.grib", edition, [*both, *winds])
    assert survey([path]).flyable
    (name,) = {seen.name for seen in survey([path]).variables} - {"u10", "v10"}
    with pytest.raises(
        WeatherError, match=r"both\.grib .* at 2024-02-29T03:00:00, or windows of different lengths end"
    ):
        read_values(path, name)


def test_the_st_jude_gusts_are_of_three_hours_with_three_hours_between(data_folder):
    pytest.importorskip("cfgrib")
    path = data_folder / "ens_stjude_gust_20131025.grib"
    if not path.exists():
        pytest.skip(f"{path} is not there")
    spans = read_values(path, "fg10_3").spans
    issued_s = 1382659200.0  # 2013-10-25 00 UTC
    np.testing.assert_array_equal((spans.begin_s - issued_s) / 3600.0, [69.0, 75.0, 81.0])
    np.testing.assert_array_equal((spans.end_s - issued_s) / 3600.0, [72.0, 78.0, 84.0])
    quantity = survey([path]).quantity
    assert [(begin - issued_s, end - issued_s) for begin, end in quantity.gaps_s] == [
        (72 * 3600.0, 75 * 3600.0),
        (78 * 3600.0, 81 * 3600.0),
    ]
