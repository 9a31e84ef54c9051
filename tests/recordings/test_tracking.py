"""Tracking on flights whose errors are known, and against a slow second opinion."""

import math
from dataclasses import replace

import numpy as np
import pyproj
import pytest

from recordings.recorder import GuidanceSample, Outcome
from recordings.tracking import ARRIVAL_RADIUS_M, track

GEOD = pyproj.Geod(ellps="WGS84")


@pytest.fixture
def tracked(workshop):
    """Fly as told along a path, record, read, track."""

    def tracked(path_m=workshop.straight, leg_s=120.0, **how):
        return track(workshop.recording(workshop.fly(workshop.header(path_m, leg_s), **how)))

    return tracked


def test_a_flight_along_the_reference_has_no_errors(tracked):
    report = tracked()
    assert report.arrived
    assert report.cross_track_m.max == pytest.approx(0.0, abs=1e-5)
    assert report.altitude_error_m.max == 0.0
    assert report.waypoint_time_error_s.max == pytest.approx(0.0, abs=1e-4)
    assert report.corner_cut_m.max == pytest.approx(0.0, abs=1e-6)
    assert report.flight_time_s == report.planned_time_s == 360.0
    assert (report.samples, report.waypoints_missed) == (3601, 0)


@pytest.mark.parametrize("right_m", [3.0, -3.0])
def test_an_offset_is_the_cross_track_error(tracked, right_m):
    report = tracked(right_m=right_m)
    figures = report.cross_track_m
    assert (figures.mean, figures.p95, figures.max) == pytest.approx((3.0, 3.0, 3.0), abs=1e-5)
    assert report.series.cross_track_m == pytest.approx(np.full(3601, right_m), abs=1e-5)


@pytest.mark.parametrize("above_m", [5.0, -5.0])
def test_an_offset_in_height_is_the_altitude_error(tracked, above_m):
    figures = tracked(above_m=above_m).altitude_error_m
    assert (figures.mean, figures.p95, figures.max) == pytest.approx((5.0, 5.0, 5.0))


@pytest.mark.parametrize("late_s", [5.0, -5.0, 0.04])
def test_a_late_flight_is_late_at_every_waypoint(tracked, late_s):
    report = tracked(late_s=late_s)
    assert report.series.waypoint_time_error_s == pytest.approx(np.full(4, late_s), abs=2e-3)
    assert report.waypoint_time_error_s.mean == pytest.approx(abs(late_s), abs=2e-3)


def test_the_lead_in_does_not_count(workshop):
    flight = workshop.fly(workshop.header(workshop.straight))
    wild = [
        state._replace(altitude_m=2000.0, wind_north_mps=40.0, airspeed_mps=99.0)
        if state.time_s < 0
        else state
        for state in flight.states
    ]
    report = track(workshop.recording(replace(flight, states=wild)))
    assert report.altitude_error_m.max == 0.0
    assert report.airspeed_mps.max < 30.0
    assert (report.wind_mps.max, report.hazard_exposure_s) == (pytest.approx(6.0, abs=1e-3), 0.0)


def weaving(workshop):
    """Along the corners and to and fro, 8 m to each side and 40 m ahead and behind."""
    flight = workshop.fly(workshop.header(workshop.corners))
    reference, frame = flight.header.reference, workshop.grid.frame
    states = []
    for state in flight.states:
        point = reference.at(
            reference.path_at_time(state.time_s)
            + 40.0 * math.sin(0.011 * state.time_s) * min(1.0, state.time_s + 30.0)
        )
        off_m = 8.0 * math.sin(0.05 * state.time_s) * point.scale
        lat_rad, lon_rad = frame.to_geodetic(
            point.north_m - off_m * math.sin(point.course_rad),
            point.east_m + off_m * math.cos(point.course_rad),
        )
        states.append(state._replace(lat_rad=lat_rad, lon_rad=lon_rad))
    return replace(flight, states=states)


class SecondOpinion:
    """The nearest point of a reference, by geodesics to points of it that lie ever closer together."""

    def __init__(self, header):
        self.reference, self.frame = header.reference, header.grid.frame

    def nearest(self, lat_rad, lon_rad, low_m, high_m):
        """Path and distance, right of the course positive, between two path distances."""
        while True:
            path_m = np.clip(np.linspace(low_m, high_m, 201), 0.0, self.reference.end_m)
            curve = self.reference.at_many(path_m)
            curve_lat, curve_lon = self.frame.to_geodetic(curve.north_m, curve.east_m)
            here = np.full(201, lon_rad), np.full(201, lat_rad)
            _, azimuth, distance_m = GEOD.inv(curve_lon, curve_lat, *here, radians=True)
            best, step_m = int(np.argmin(distance_m)), (high_m - low_m) / 200.0
            if step_m < 0.001:
                right = math.sin(azimuth[best] - math.pi - curve.course_rad[best]) > 0.0
                return path_m[best], distance_m[best] if right else -distance_m[best]
            low_m, high_m = path_m[best] - step_m, path_m[best] + step_m


def test_a_slow_second_opinion_agrees(workshop):
    flight = weaving(workshop)
    report = track(workshop.recording(flight))
    second, series = SecondOpinion(flight.header), report.series
    states = [state for state in flight.states if state.time_s >= 0.0][::7]
    paths_m = []
    for index, state in enumerate(states):
        expected_m = second.reference.path_at_time(state.time_s)
        path_m, cross_m = second.nearest(state.lat_rad, state.lon_rad, expected_m - 100.0, expected_m + 100.0)
        assert series.cross_track_m[7 * index] == pytest.approx(cross_m, abs=0.003)
        assert series.to_go_m[7 * index] == pytest.approx(
            second.reference.waypoint_path_m[-1] - path_m, abs=0.05
        )
        paths_m.append(path_m)
    for waypoint in (1, 2, 3):
        waypoint_m = second.reference.waypoint_path_m[waypoint]
        passed_s = states[int(np.argmax(np.array(paths_m) >= waypoint_m))].time_s
        found_s = series.waypoint_time_s[waypoint] + series.waypoint_time_error_s[waypoint]
        assert passed_s - 0.71 < found_s <= passed_s
    assert report.cross_track_m.max == pytest.approx(8.0, abs=0.1)


def test_corners_are_cut_by_the_distance_of_the_waypoint_from_the_reference(workshop):
    flight = workshop.fly(workshop.header(workshop.corners))
    report = track(workshop.recording(flight))
    second, waypoints = SecondOpinion(flight.header), flight.header.plan.waypoints
    for waypoint, cut_m in list(zip(waypoints, report.series.corner_cut_m, strict=True))[1:-1]:
        expected_m = second.reference.path_at_time(waypoint.time_s)
        place = math.radians(waypoint.lat_deg), math.radians(waypoint.lon_deg)
        _, cross_m = second.nearest(*place, expected_m - 300.0, expected_m + 300.0)
        assert cut_m == pytest.approx(abs(cross_m), abs=0.01)
    assert report.corner_cut_m.max == report.series.corner_cut_m.max() > 60.0
    assert report.worst["corner_cut_m.max"].time_s in (120.0, 240.0, 360.0)


def test_lengths_are_true_lengths(workshop):
    """Far from the origin the plane is stretched; the reference is two straight legs."""
    header = workshop.header(((90000.0, 0.0), (90000.0, 3000.0), (90000.0, 6000.0)))
    report = track(workshop.recording(workshop.fly(header)))
    first, _, last = header.plan.waypoints
    _, _, parallel_m = GEOD.inv(first.lon_deg, first.lat_deg, last.lon_deg, last.lat_deg)
    assert parallel_m < 5990.0
    assert report.planned_length_m == pytest.approx(parallel_m, rel=1e-6)
    assert report.flown_length_m == pytest.approx(parallel_m, rel=1e-6)


def test_waiting_is_tracked_round_the_circle(tracked):
    report = tracked(path_m=((0.0, 0.0), (0.0, 3600.0), (0.0, 3600.0), (0.0, 7200.0)))
    assert report.arrived
    assert report.cross_track_m.max == pytest.approx(0.0, abs=1e-4)
    assert report.waypoint_time_error_s.max == pytest.approx(0.0, abs=0.02)
    assert report.planned_length_m > 7200.0 + 1000.0
    assert report.flown_length_m == pytest.approx(report.planned_length_m, rel=1e-3)


def test_arrival_is_what_the_positions_say(workshop):
    """The run claims to have arrived, a hundred metres too early."""
    short = workshop.fly(workshop.header(workshop.straight), until_s=356.0)
    report = track(workshop.recording(short))
    assert (report.outcome, report.arrived, report.waypoints_missed) == ("arrived", False, 1)
    assert report.worst["arrived"].value == pytest.approx(100.0, abs=0.1)


def test_who_crashed_behind_the_goal_had_arrived(workshop):
    flight = workshop.fly(workshop.header(workshop.straight))
    report = track(workshop.recording(replace(flight, outcome=Outcome.CRASHED)))
    assert (report.outcome, report.arrived) == ("crashed", True)


@pytest.mark.parametrize(
    ("right_m", "arrived"), [(ARRIVAL_RADIUS_M - 1.0, True), (ARRIVAL_RADIUS_M + 1.0, False)]
)
def test_passing_by_at_a_distance_is_no_arrival(tracked, right_m, arrived):
    report = tracked(right_m=right_m)
    assert (report.arrived, report.waypoints_missed) == (arrived, 0)


def test_being_where_the_goal_is_before_the_end_is_no_arrival(tracked):
    out_and_back = ((0.0, 0.0), (0.0, 6000.0), (1500.0, 6000.0), (1500.0, 0.0), (0.0, 0.0))
    assert not tracked(path_m=out_and_back, until_s=1.0).arrived
    assert not tracked(path_m=out_and_back, until_s=200.0).arrived
    assert tracked(path_m=out_and_back).arrived


def test_ending_a_hand_before_the_last_waypoint_is_an_arrival(workshop):
    flight = workshop.fly(workshop.header(workshop.straight), until_s=359.9)
    assert track(workshop.recording(flight)).waypoints_missed == 1
    flight = workshop.fly(workshop.header(workshop.straight), late_s=0.003, until_s=360.0)
    report = track(workshop.recording(flight))
    assert (report.arrived, report.waypoints_missed) == (True, 0)
    assert report.waypoint_time_error_s.max < 0.01


def test_waypoints_that_were_never_reached_are_counted(tracked):
    report = tracked(until_s=130.0)
    assert (report.arrived, report.waypoints_missed) == (False, 2)
    assert report.waypoint_time_error_s.max == pytest.approx(0.0, abs=1e-4)
    assert np.isnan(report.series.waypoint_time_error_s[2:]).all()


def test_time_in_strong_wind_is_exposure(tracked):
    report = tracked(wind_mps=lambda time_s: 15.5 if 60.0 <= time_s < 90.0 else 6.0)
    assert report.hazard_exposure_s == pytest.approx(30.0)
    assert report.worst["hazard_exposure_s"].time_s == 60.0
    assert report.worst["hazard_exposure_s"].value == pytest.approx(15.5, abs=1e-3)
    assert (report.wind_mps.min, report.wind_mps.max) == pytest.approx((6.0, 15.5), abs=1e-3)


def test_strong_wind_at_the_last_sample_alone_is_exposure(tracked):
    assert tracked(
        wind_mps=lambda time_s: 16.0 if time_s >= 360.0 else 6.0
    ).hazard_exposure_s == pytest.approx(0.1)


def test_time_outside_the_envelope_of_airspeeds(workshop):
    flight = workshop.fly(workshop.header(workshop.straight))  # whose envelope is 20 to 40 m/s
    speeds_mps = {600: 19.5, 601: 16.0, 602: 41.0, 603: 20.0, 604: 40.0}  # by sample
    states = [
        state._replace(airspeed_mps=speeds_mps.get(round(10.0 * state.time_s), 30.0))
        for state in flight.states
    ]
    report = track(workshop.recording(replace(flight, states=states)))
    assert report.outside_airspeeds_s == pytest.approx(0.3)
    assert report.worst["outside_airspeeds_s"].value == 16.0
    assert report.worst["outside_airspeeds_s"].time_s == pytest.approx(60.1)


def test_airspeed(tracked):
    report = tracked()
    assert report.airspeed_mps.min == pytest.approx(28.0 + math.sin(3.6), abs=1e-3)
    assert report.airspeed_mps.max == pytest.approx(29.0, abs=1e-3)
    assert report.worst["airspeed_mps.min"].time_s == 360.0


def test_figures_that_the_run_wrote_are_not_believed(workshop):
    flight = workshop.fly(workshop.header(workshop.corners), right_m=1.0)
    lies = [GuidanceSample(0.0, 99.0, 99.0, 99.0, 2, sample.command) for sample in flight.guidance]
    honest = track(workshop.recording(flight)).to_json()
    assert track(workshop.recording(replace(flight, guidance=lies))).to_json() == honest


def test_the_worst_moment_is_where_it_happened(workshop):
    flight = workshop.fly(workshop.header(workshop.straight))
    flight = flight.changed(1234, altitude_m=1017.0)
    report = track(workshop.recording(flight))
    worst, state = report.worst["altitude_error_m.p95"], flight.states[1234]
    assert (worst.value, worst.time_s) == (pytest.approx(17.0), state.time_s)
    assert (worst.lat_deg, worst.lon_deg) == pytest.approx(
        (math.degrees(state.lat_rad), math.degrees(state.lon_rad))
    )


def test_a_flight_that_never_departed_has_nothing_to_measure(tracked):
    report = tracked(until_s=-1.0)
    assert (report.samples, report.arrived, report.waypoints_missed) == (0, False, 4)
    assert report.cross_track_m.mean is None
    assert report.airspeed_mps.min is None
    assert report.hazard_exposure_s is None
    assert report.min_clearance_m is None
    assert report.flown_length_m == 0.0


def test_a_recording_that_stops_is_incomplete(workshop):
    from recordings.mcap_reader import read
    from recordings.mcap_writer import McapRecorder

    recorder = McapRecorder(workshop.folder / "flight.mcap")
    workshop.fly(workshop.header(workshop.straight), until_s=100.0).record(recorder, finish=False)
    recorder.abandon()
    report = track(read(recorder.partial_path))
    assert (report.outcome, report.arrived, report.waypoints_missed) == ("incomplete", False, 3)
