"""What goes wrong on purpose: each fault ends as it should, and its recording can be read and judged."""

import math
import resource
import subprocess
from pathlib import Path

import numpy as np
import pytest

from recordings.mcap_reader import read
from recordings.mcap_writer import McapRecorder
from recordings.recorder import Outcome
from recordings.tracking import track
from sim.closed_loop import fly
from sim.errors import ScenarioError
from sim.faults import disturbed
from sim.scenario import Fault, FaultKind, load_scenario


@pytest.fixture
def flown(ready, tmp_path):
    """Flies the short scenario with faults: (faults in TOML, overrides) -> (end, recording, report)."""

    def fly_with(faults, *overrides):
        path = tmp_path / "flight.mcap"
        end = fly(ready(f"faults={faults}", *overrides), McapRecorder(path), lambda _: None)
        recording = read(path)
        assert recording.complete
        assert recording.outcome is end.outcome
        return end, recording, track(recording)

    return fly_with


def told(recording, words):
    """The times of the events with these words."""
    return [event.time_s for event in recording.events if words in event.text]


def test_an_engine_that_fails_in_cruise_is_a_glide_to_the_ground(flown):
    end, recording, report = flown('[{kind = "engine_failure", time_s = 60}]')
    assert end.outcome is Outcome.ENGINE_FAILED
    assert told(recording, "the engine is stopped") == [60.0]
    (gliding_s,) = told(recording, "gliding")
    assert 63.0 <= gliding_s < 68.0
    state = recording.state
    gliding = state["time_s"] > gliding_s + 60.0
    sink_mps = state["down_mps"][gliding]
    assert 0.5 < sink_mps.mean() < 3.0  # a glide, not a fall
    assert state["airspeed_mps"][gliding].min() > 14.0
    assert np.abs(state["roll_rad"][gliding]).max() < math.radians(50.0)
    assert state["altitude_m"][-1] < 10.0
    assert "glided" in end.detail
    assert not report.arrived
    assert report.cross_track_m.p95 < 60.0  # still on its path over ground


def test_fuel_that_is_exhausted_is_the_same_glide_under_its_own_name(flown):
    end, recording, _ = flown('[{kind = "fuel_loss", time_s = 30, fuel_kg = 0.002}]')
    assert end.outcome is Outcome.FUEL_OUT
    assert told(recording, "drained to 0.002 kg") == [30.0]
    (empty_s,) = told(recording, "the tank is empty")
    assert 60.0 < empty_s < 180.0  # two grams last for a minute or so
    assert recording.state["fuel_kg"][-1] == 0.0
    assert "glided" in end.detail


def test_a_glide_that_comes_as_far_as_the_goal_has_arrived(flown):
    end, recording, _ = flown('[{kind = "engine_failure", time_s = 1000}]')
    assert end.outcome is Outcome.ARRIVED
    assert told(recording, "gliding")


@pytest.mark.parametrize(("kind", "names"), [("wind_nan", "wind"), ("state_nan", "fuel_kg")])
def test_what_is_not_a_number_ends_the_flight_before_it_is_recorded(flown, kind, names):
    end, recording, report = flown(f'[{{kind = "{kind}", time_s = 45}}]')
    assert end.outcome is Outcome.NOT_FINITE
    assert end.time_s == pytest.approx(45.0, abs=0.3)
    assert names in end.detail
    assert np.isfinite(recording.state["altitude_m"]).all()
    assert not report.arrived


def test_a_flight_that_never_comes_back_is_given_up(flown):
    end, recording, report = flown(
        '[{kind = "wind_step", time_s = 300, north_mps = 60}]', "flight.late_limit_s=20"
    )
    assert end.outcome is Outcome.CANNOT_FOLLOW
    assert end.time_s == pytest.approx(recording.header.plan.duration_s + 20.0, abs=1.0)
    assert "limit 20 s" in end.detail
    assert not report.arrived


def test_a_fault_behind_the_end_of_the_plan_is_refused(ready):
    late = 'faults=[{kind = "engine_failure", time_s = 5}, {kind = "wind_step", time_s = 99999}]'
    with pytest.raises(
        ScenarioError, match=r"faults\[1\].time_s is 99999, but .* ends after 1080 s.*earlier"
    ):
        ready(late)
    with pytest.raises(
        ScenarioError, match=r"faults\[1\].time_s is 99999, but the last stage ends after 3600 s"
    ):
        ready(late, "planner.replan=each_stage")


def test_a_fault_that_the_flight_was_over_before_is_a_warning(flown):
    later = '{kind = "wind_step", time_s = 900}, {kind = "engine_failure", time_s = 901}'
    end, recording, _ = flown(f'[{{kind = "wind_nan", time_s = 45}}, {later}]')
    assert told(recording, "wind_step of 900 s did not strike") == [pytest.approx(end.time_s)]
    assert told(recording, "engine_failure of 901 s did not strike") == [pytest.approx(end.time_s)]
    assert len(told(recording, "did not strike")) == 2


def test_a_wind_step_of_20_mps_in_a_second_is_come_through(flown):
    step = '[{kind = "wind_step", time_s = 300, north_mps = 14.2, east_mps = -14.2, duration_s = 1.0}]'
    end, recording, report = flown(step, "flight.off_path_limit_m=2000", "stages.count=3")
    assert end.outcome in (Outcome.ARRIVED, Outcome.LEFT_WEATHER)
    state = recording.state
    struck = (state["time_s"] > 300.0) & (state["time_s"] < 360.0)
    assert np.abs(state["altitude_m"][struck] - 1000.0).max() < 60.0
    assert state["airspeed_mps"][struck].min() > 12.0
    assert told(recording, "the wind changes by 20.0818 m/s") == [pytest.approx(300.0)]
    assert report.worst


def test_the_wind_step_ramps_and_stays():
    def wind(time_s, lat_rad, lon_rad, altitude_m):
        return 1.0, 2.0, 0.5

    fault = Fault(FaultKind.WIND_STEP, 100.0, north_mps=10.0, east_mps=-20.0, duration_s=2.0)
    felt = disturbed(wind, [fault], departure_s=1000.0)
    assert felt(1099.0, 0, 0, 0) == (1.0, 2.0, 0.5)
    assert felt(1101.0, 0, 0, 0) == (6.0, -8.0, 0.5)
    assert felt(9999.0, 0, 0, 0) == (11.0, -18.0, 0.5)
    assert disturbed(wind, [Fault(FaultKind.ENGINE_FAILURE, 1.0)], departure_s=0.0) is wind


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        ('{kind = "engine_failur", time_s = 1}', "engine_failur"),
        ('{kind = "engine_failure"}', "time_s"),
        ('{kind = "wind_step", time_s = -1}', "-1"),
        ('{kind = "wind_step", time_s = 1, duration_s = 0}', "0"),
        ('{kind = "wind_step", time_s = 1, nort_mps = 1}', "north_mps"),
    ],
)
def test_a_fault_that_makes_no_sense_is_refused(fault, words):
    with pytest.raises(ScenarioError, match=words):
        load_scenario("ian", [f"faults=[{fault}]"])


@pytest.mark.parametrize("limit", [400_000, 1_000_000])
def test_a_disk_that_is_full_ends_in_one_message_and_what_was_recorded_can_be_read(
    command, galeway, tmp_path, limit
):
    def full():
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    short = str(Path(__file__).parent / "scenarios" / "short.toml")
    done = subprocess.run(
        [*command, "fly", short, "--out", str(tmp_path)],
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=full,
    )
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    assert "make room" in done.stderr
    (recording,) = tmp_path.glob("flight.partial.mcap")
    checked = galeway("check", str(recording))
    assert checked.returncode == 1
    assert "incomplete" in checked.stdout + checked.stderr
    assert not (tmp_path / "flight.mcap").exists()
    assert not (tmp_path / "report.json").exists()
