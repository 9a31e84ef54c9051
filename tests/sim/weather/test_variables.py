"""Which variable is what: by standard name, GRIB name and usual name."""

import math

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.errors import WeatherError
from sim.weather.files import Reading, read_wind
from sim.weather.variables import Role, WindNames, find_winds, role_of


def named(name, **attributes):
    return xr.DataArray(0.0, name=name, attrs=attributes)


@pytest.mark.parametrize(
    ("names", "role"),
    [
        (
            ("u", "U", "u10", "10u", "u100", "100u", "ua", "uas", "UGRD", "ugrd10m", "UGRD_10maboveground"),
            Role.EAST,
        ),
        (
            ("u-component_of_wind_height_above_ground", "10m_u_component_of_wind", "u_wind", "uwnd", "U10"),
            Role.EAST,
        ),
        (("v", "V10", "10v", "vas", "VGRD", "vgrd_80m", "v_component_of_wind", "northward_wind"), Role.NORTH),
        (("w", "wa"), Role.UP),
        (("si10", "10si", "ws", "wind_speed", "windspeed_10m", "windspeed", "ws100"), Role.SPEED),
        (("wdir", "10wdir", "wd10", "wind_from_direction", "wind_direction_10m"), Role.FROM),
        (("fg10", "10fg", "i10fg", "gust", "fg10_3", "fg310", "wind_gust", "10fg3", "vmax_10m"), Role.GUST),
        (("z", "gh", "zg", "HGT", "geopotential"), Role.GEOPOTENTIAL),
        (("t2m", "usage", "tp", "uv", "value", "wind", "water", "u*", "lat", "VIS", "ustar"), None),
    ],
)
def test_usual_names(names, role):
    unit = {"units": {Role.GEOPOTENTIAL: "m2 s-2"}.get(role, "m s-1")}
    for name in names:
        assert role_of(named(name, **unit)) is role, name
        assert role_of(named("anything", GRIB_shortName=name, **unit)) is role, name


def test_short_names_need_a_unit_that_fits():
    assert role_of(named("w", units="Pa s-1")) is None
    assert role_of(named("z", units="dBZ")) is None


def test_a_standard_name_wins_over_the_name():
    assert role_of(named("v", standard_name="eastward_wind")) is Role.EAST
    assert role_of(named("u", standard_name="air_temperature")) is None
    assert role_of(named("w", standard_name="lagrangian_tendency_of_air_pressure")) is None
    assert role_of(named("fg10_3", standard_name="unknown")) is Role.GUST
    assert role_of(named("u", standard_name="eastward_wind", GRIB_uvRelativeToGrid=1)) is Role.GRID_X


def test_pairs_belong_together_by_what_is_left_of_their_names():
    names = ["u10", "v100", "v10", "u100", "windspeed_10m", "wind_direction_10m"]
    roles = {name: role_of(named(name)) for name in names}
    assert find_winds(roles, None, "") == [WindNames("u10", "v10"), WindNames("u100", "v100")]
    del roles["u10"], roles["v10"], roles["u100"], roles["v100"]
    assert find_winds(roles, None, "") == [WindNames("windspeed_10m", "wind_direction_10m")]


def test_a_speed_without_a_direction_cannot_be_flown_in():
    with pytest.raises(
        WeatherError, match=r"the speed of the wind \(gust\) and not its direction.*not how the air moves"
    ):
        find_winds({"gust": Role.GUST, "t": None}, None, "gust, t")


def directed(speed, angle, **attributes):
    angle_attributes = {"standard_name": "wind_from_direction", "units": "degree"} | attributes
    dims = ("time", "latitude", "longitude")
    return xr.Dataset(
        {
            "speed": (dims, speed, {"standard_name": "wind_speed", "units": "kt"}),
            "angle": (dims, angle, angle_attributes),
        },
        {
            "time": np.array(["2024-05-01"], dtype="datetime64[ns]"),
            "latitude": ("latitude", [50.0, 51.0], {"units": "degrees_north"}),
            "longitude": ("longitude", [4.0, 5.0], {"units": "degrees_east"}),
        },
    )


@settings(deadline=None, max_examples=20)
@given(
    speed_mps=st.floats(0.0, 90.0),
    from_deg=st.floats(0.0, 360.0),
    radians=st.booleans(),
    toward=st.booleans(),
)
def test_speed_and_direction_make_a_wind_that_blows_the_other_way(
    speed_mps, from_deg, radians, toward, tmp_path_factory
):
    path = tmp_path_factory.mktemp("from") / "wind.nc"
    angle = np.full((1, 2, 2), (from_deg + 180.0) % 360.0 if toward else from_deg)
    attributes = {"standard_name": "wind_to_direction"} if toward else {}
    if radians:
        angle, attributes = np.radians(angle), attributes | {"units": "radian"}
    directed(np.full((1, 2, 2), speed_mps * 3600.0 / 1852.0), angle, **attributes).to_netcdf(path)
    field = read_wind(path)
    assert np.hypot(field.north_mps, field.east_mps) == pytest.approx(speed_mps, abs=1e-9)
    assert field.north_mps[0, 0, 0] == pytest.approx(-speed_mps * math.cos(math.radians(from_deg)), abs=1e-6)
    assert field.east_mps[0, 0, 0] == pytest.approx(-speed_mps * math.sin(math.radians(from_deg)), abs=1e-6)


def test_a_west_wind_is_toward_the_east(tmp_path):
    directed(np.full((1, 2, 2), 20.0), np.full((1, 2, 2), 270.0)).to_netcdf(tmp_path / "wind.nc")
    field = read_wind(tmp_path / "wind.nc")
    assert field.east_mps == pytest.approx(20.0 * 1852.0 / 3600.0)
    assert field.north_mps == pytest.approx(0.0, abs=1e-12)
    named_pair = read_wind(tmp_path / "wind.nc", reading=Reading(("speed", "angle")))
    np.testing.assert_array_equal(named_pair.east_mps, field.east_mps)


def test_a_direction_in_an_unknown_unit_is_refused(tmp_path):
    directed(np.ones((1, 2, 2)), np.ones((1, 2, 2)), units="gon").to_netcdf(tmp_path / "wind.nc")
    with pytest.raises(
        WeatherError, match="wind direction angle has the unit 'gon'; it must be one of degree, rad"
    ):
        read_wind(tmp_path / "wind.nc")
