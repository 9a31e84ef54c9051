import pytest

from recordings.limit_bands import LimitBand, limit_bands


@pytest.mark.parametrize(
    ("limit", "band"),
    [
        ("cross_track_m.p95 <= 2", LimitBand("cross_track_m", "p95 <= 2", (2.0, -2.0))),
        ("altitude_error_m.max<7.5", LimitBand("altitude_error_m", "max < 7.5", (7.5, -7.5))),
        ("time_error_s.p99.9 <= 5", LimitBand("time_error_s", "p99.9 <= 5", (5.0, -5.0))),
        (
            'altitude_error_m within 10 except during "takeoff"',
            LimitBand("altitude_error_m", "within 10", (10.0, -10.0)),
        ),
        ("cross_track_m within 1e1", LimitBand("cross_track_m", "within 1e1", (10.0, -10.0))),
        ("cross_track_m within 0 to 4 until 1:00", LimitBand("cross_track_m", "within 4", (4.0, -4.0))),
        ("altitude_error_m always >= -5", LimitBand("altitude_error_m", "always >= -5", (-5.0,))),
        ("cross_track_m always < 3 from 0:10", LimitBand("cross_track_m", "always < 3", (3.0,))),
    ],
)
def test_a_limit_on_an_error_is_a_band(limit, band):
    assert limit_bands([limit]) == [band]


@pytest.mark.parametrize(
    "limit",
    [
        "arrived == true",
        "cross_track_m.mean <= 1",  # says nothing of one moment
        "cross_track_m.p95 >= 1",
        "hazard_exposure_s == 0",
        'outcome == "arrived"',
        "never crashed",
        "arrived before 12:00",
        'never "within 3"',
    ],
)
def test_other_limits_are_none(limit):
    assert limit_bands([limit]) == []


def test_they_keep_their_order():
    limits = ["altitude_error_m.max <= 9", "arrived == true", "cross_track_m.p95 <= 2"]
    assert [band.text for band in limit_bands(limits)] == ["max <= 9", "p95 <= 2"]
