"""The pytest plugin, in runs of pytest of their own."""

from importlib.metadata import entry_points
from pathlib import Path

import pytest
from lxml import etree

import recordings.junit  # loaded here once, or each run of pytest below loads it anew
from recordings.mcap_writer import McapRecorder
from recordings.pytest_plugin import find, names

assert recordings.junit

pytest_plugins = ["pytester"]


@pytest.fixture(autouse=True)
def other_plugins_away(pytester, monkeypatch):
    """Ours alone, by its name: others load what they like, and take seconds for it."""
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
    monkeypatch.setenv("PYTEST_ADDOPTS", "-p galeway")


@pytest.fixture
def runs(workshop, pytester):
    """Two flights: runs/good/flight.mcap and runs/aside/flight.mcap, 3 m to the right."""
    header = workshop.header(workshop.straight)
    for name, right_m in (("good", 0.0), ("aside", 3.0)):
        folder = pytester.path / "runs" / name
        folder.mkdir(parents=True)
        workshop.fly(header, right_m=right_m).record(McapRecorder(folder / "flight.mcap"))
    return pytester


def test_it_is_active_where_galeway_is_installed():
    (entry,) = entry_points(group="pytest11", name="galeway")
    assert entry.value == "recordings.pytest_plugin"


def test_a_run_that_does_not_use_it_is_not_touched(pytester):
    pytester.makepyfile(
        """
        import sys

        def test_nothing_heavy_is_loaded():
            heavy = {"numpy", "jsbsim", "rerun", "scipy", "pyproj", "mcap", "aircraft", "planner"}
            assert "recordings.pytest_plugin" in sys.modules
            assert not heavy & set(sys.modules)
        """
    )
    done = pytester.runpytest_subprocess("-W", "error", "--strict-markers")
    done.assert_outcomes(passed=1)


def test_fixtures_and_markers_of_the_same_names_stay_ones_own(pytester):
    pytester.makepyfile(
        """
        import pytest

        @pytest.fixture
        def recording():
            return "of a concert"

        def test_mine(recording):
            assert recording == "of a concert"

        @pytest.mark.parametrize("tracking", [1, 2])
        def test_ours(tracking):
            assert tracking in (1, 2)
        """
    )
    pytester.runpytest_inprocess().assert_outcomes(passed=3)


def test_a_test_runs_once_for_each_recording(runs):
    runs.makepyfile(
        """
        def test_arrives(tracking):
            assert tracking.arrived

        def test_follows(recording, tracking):
            assert recording.header.scenario == "squall"
            assert tracking.cross_track_m.max < 1.0
        """
    )
    done = runs.runpytest_inprocess(
        "-v", "--recording", "runs/good/flight.mcap", "--recording", "runs/a*/*.mcap"
    )
    done.assert_outcomes(passed=3, failed=1)
    done.stdout.fnmatch_lines_random(
        ["*::test_follows?good/flight? PASSED*", "*::test_follows?aside/flight? FAILED*"]
    )


MARKED = """
    import pytest

    @pytest.mark.limits("cross_track_m.p95 <= 2", "never crashed")
    def test_follows():
        pass

    @pytest.mark.limits("arrived == true")
    class TestArrival:
        def test_in_time(self):
            pass

        @pytest.mark.limits("arrived before 0:01")
        def test_too_soon(self, tracking):
            pass

    @pytest.mark.limits
    def test_the_limits_of_the_scenario():
        pass
"""


def test_limits_pass_or_say_what_broke_them_where(runs):
    runs.makepyfile(MARKED)
    done = runs.runpytest_inprocess("--recording", "runs", "--strict-markers")
    done.assert_outcomes(passed=4, failed=4)
    done.stdout.fnmatch_lines(
        [
            "1 of 2 limits broken: squall, seed 7, *aside*flight.mcap",
            "FAIL cross_track_m.p95 <= 2: 3 (over by 1), worst 3 m at 00:0*, 30.00 N *, broken for 360* s, *",
        ]
    )
    done.stdout.fnmatch_lines(["FAIL arrived before 0:01: 00:06:00.0 (missed by 300 s), worst *"])
    done.stdout.no_fnmatch_line("*Traceback*")


def test_without_a_recording_nothing_passes(pytester):
    pytester.makepyfile(MARKED + "\n    def test_arrives(tracking):\n        pass\n")
    done = pytester.runpytest_inprocess()
    done.assert_outcomes(errors=5)
    done.stdout.fnmatch_lines(["*no recording to test: give --recording PATH*"])


def test_limits_that_are_misspelt_or_on_something_else_fail(runs):
    runs.makepyfile(
        """
        import unittest
        import pytest

        @pytest.mark.limits("cros_track_m.p95 <= 2")
        def test_misspelt():
            pass

        class TestOfSomebodyElse:
            @pytest.fixture
            def tracking(self):
                return "a fox"

            @pytest.mark.limits("cross_track_m.p95 <= 2")
            def test_the_fox(self):
                pass

        class TestOld(unittest.TestCase):
            @pytest.mark.limits("cross_track_m.p95 <= 2")
            def test_old(self):
                pass
        """
    )
    done = runs.runpytest_inprocess("--recording", "runs/good")
    done.assert_outcomes(failed=3)
    done.stdout.fnmatch_lines(["*did you mean cross_track_m.p95?*"])
    done.stdout.no_fnmatch_line("*During handling*")
    done.stdout.fnmatch_lines(
        ["*limits are judged on the fixture tracking, which test_the_fox does not have"]
    )


def test_recordings_that_are_not_there_are_bad_usage(pytester):
    pytester.mkdir("empty")
    for given in ("empty", "missing.mcap", "no/*.mcap"):
        done = pytester.runpytest_inprocess("--recording", given)
        assert done.ret == pytest.ExitCode.USAGE_ERROR
        done.stderr.fnmatch_lines([f"*--recording {given}: no recording is there*"])


def test_a_recording_that_cannot_be_read_is_an_error(pytester):
    (pytester.path / "rubbish.mcap").write_bytes(b"not a recording" * 100)
    pytester.makepyfile("def test_arrives(tracking): pass")
    # without the summary, which tells the message again in full where the variable CI is set
    done = pytester.runpytest_inprocess("-rN", "--recording", "rubbish.mcap")
    done.assert_outcomes(errors=1)
    done.stdout.fnmatch_lines(["*rubbish.mcap*"])
    done.stdout.no_fnmatch_line("*During handling*")
    assert str(done.stdout).count("is not an MCAP file") == 1


def test_an_incomplete_recording_fails_its_limits(workshop, pytester):
    recorder = McapRecorder(pytester.path / "flight.mcap")
    workshop.fly(workshop.header(workshop.straight)).record(recorder, finish=False)
    recorder.abandon()
    pytester.makepyfile(
        """
        import pytest

        @pytest.mark.limits("airspeed_mps always > 1")
        def test_flies():
            pass
        """
    )
    done = pytester.runpytest_inprocess("--recording", ".")
    done.assert_outcomes(failed=1)
    done.stdout.fnmatch_lines(["*the recording is incomplete: how the flight ended*"])


def test_the_junit_file_says_what_was_flown(runs):
    runs.makepyfile(
        """
        def test_arrives(tracking): pass
        def test_reads(recording): pass
        def test_else(): pass
        """
    )
    runs.runpytest_inprocess("--recording", "runs/aside", "--junitxml", "junit.xml").assert_outcomes(passed=3)
    cases = etree.parse(str(runs.path / "junit.xml")).findall(".//testcase")
    told = {
        case.get("name").split("[")[0]: {
            held.get("name"): held.get("value") for held in case.iter("property")
        }
        for case in cases
    }
    assert told["test_arrives"]["scenario"] == "squall"
    assert told["test_arrives"]["seed"] == "7"
    assert float(told["test_arrives"]["cross_track_m.p95"]) == pytest.approx(3.0, abs=1e-3)
    assert told["test_arrives"]["recording"].endswith("flight.mcap")
    assert told["test_reads"]["scenario"] == "squall"
    assert told["test_else"] == {}


def test_paths_are_found_once_and_in_order(tmp_path):
    for name in ("b/flight.mcap", "a/flight.mcap", "a/flight.rrd", "a/deep/flight.partial.mcap"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    found = find(["b/flight.mcap", ".", str(tmp_path / "a" / "*.rrd")], tmp_path)
    assert [path.relative_to(tmp_path).as_posix() for path in found] == [
        "b/flight.mcap",
        "a/deep/flight.partial.mcap",
        "a/flight.mcap",
        "a/flight.rrd",
    ]


@pytest.mark.parametrize(
    ("paths", "expected"),
    [
        (["/x/runs/ian/flight.mcap"], ["ian/flight"]),
        (["/x/tests/../flight.mcap"], ["x/flight"]),
        (["/x/a/ian/flight.mcap", "/x/b/ian/flight.mcap"], ["a/ian/flight", "b/ian/flight"]),
        (["/x/a/flight.mcap", "/x/a/flight.rrd"], ["/x/a/flight.mcap", "/x/a/flight.rrd"]),
    ],
)
def test_names_are_short_and_tell_recordings_apart(paths, expected):
    assert names([Path(path) for path in paths]) == expected
