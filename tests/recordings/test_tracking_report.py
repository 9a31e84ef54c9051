"""The report as JSON and as lines."""

import json

import numpy as np
import pytest

from recordings.figures import clock, number
from recordings.tracking import track


@pytest.fixture(scope="module")
def report(kept):
    return track(kept.recording(kept.fly(kept.header(kept.straight), right_m=0.5, late_s=2.0)))


def test_keys_come_in_their_order(report):
    content = json.loads(report.to_json(real_time_factor=812.4))
    assert list(content) == [
        "scenario",
        "seed",
        "outcome",
        "arrived",
        "goal",
        "planned_time_s",
        "flight_time_s",
        "planned_length_m",
        "flown_length_m",
        "cross_track_m",
        "altitude_error_m",
        "waypoint_time_error_s",
        "airspeed_mps",
        "wind_mps",
        "hazard_exposure_s",
        "min_clearance_m",
        "samples",
        "waypoints_missed",
        "corner_cut_m",
        "outside_airspeeds_s",
        "position_estimate_error_m",
        "wind_estimate_error_mps",
        "delay_s",
        "holds",
        "forecasts",
        "plan_changes",
        "destination",
        "level_changes",
        "replanning",
        "real_time_factor",
    ]
    assert list(content["cross_track_m"]) == ["mean", "p95", "max"]
    assert list(content["wind_mps"]) == ["min", "mean", "max"]
    assert content["real_time_factor"] == 812.4


def test_values_are_those_of_the_tracking(report):
    content = json.loads(report.to_json())
    assert content["arrived"] is True
    assert content["cross_track_m"]["p95"] == pytest.approx(report.cross_track_m.p95, abs=1e-6)
    assert content["min_clearance_m"] == pytest.approx(report.min_clearance_m, abs=1e-6)


def test_nothing_to_measure_is_null(workshop):
    none = np.zeros(workshop.grid.shape, bool)
    flight = workshop.fly(workshop.header(workshop.straight), sheets=workshop.sheets(none), until_s=-1.0)
    content = json.loads(track(workshop.recording(flight)).to_json())
    assert content["min_clearance_m"] is None
    assert content["cross_track_m"] == {"mean": None, "p95": None, "max": None}


def test_the_summary_of_a_flight(report):
    assert report.summary().splitlines() == [
        "squall, seed 7: arrived at Port",
        "flight time          00:06:02, planned 00:06:00",
        "length               9.1 km, planned 9.0 km",
        "cross-track          0.50 m mean, 0.50 p95, 0.50 max",
        "altitude error       0.00 m mean, 0.00 p95, 0.00 max",
        "waypoint time error  2.00 s mean, 2.00 p95, 2.00 max",
        "plan changed         0 ×, at 1 forecasts",
        "  forecast of 00:00 UTC, stage 1: unchanged",
        "corners cut by       0.0 m at most",
        "airspeed             27.5 to 29.0 m/s, outside the envelope for 0.0 s",
        "wind                 6.0 to 6.0 m/s",
        f"in hazard            0.0 s, nearest hazardous cell {report.min_clearance_m / 1000.0:.1f} km",
        "position believed    1.51 m mean, 1.51 p95, 1.51 max off",
        "wind believed        0.50 m/s mean, 0.50 p95, 0.50 max off",
    ]


def test_the_summary_says_what_went_wrong(workshop):
    short = track(
        workshop.recording(workshop.fly(workshop.header(workshop.straight), until_s=100.0))
    ).summary()
    assert "did not arrive at Port" in short
    assert "outcome              arrived: as it was told" in short
    assert "waypoints missed     3" in short


def test_the_summary_of_no_flight(workshop):
    flight = workshop.fly(workshop.header(workshop.straight), until_s=-1.0)
    assert "no samples after departure" in track(workshop.recording(flight)).summary()


@pytest.mark.parametrize(
    ("time_s", "text"),
    [
        (0.0, "00:00:00"),
        (8046.6, "02:14:07"),
        (-12.0, "-00:00:12"),
        (-0.2, "00:00:00"),
        (360000.0, "100:00:00"),
    ],
)
def test_times_are_written_as_on_a_clock(time_s, text):
    assert clock(time_s) == text


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.62, "0.62"),
        (2.0, "2"),
        (2.004, "2.004"),
        (1e-6, "1e-06"),
        (605975.58, "605975.6"),
        (4801.0, "4801"),
    ],
)
def test_numbers_are_short(value, text):
    assert number(value) == text
