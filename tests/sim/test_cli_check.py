"""`galeway check` on flights of JSBSim: table, JSON, JUnit, annotations, comparison, exit codes."""

import json
from functools import partial
from pathlib import Path

import junitparser
import pytest

SHORT = str(Path(__file__).parent / "scenarios" / "short.toml")


@pytest.fixture(scope="module")
def recording(flown):
    return str(flown[1] / "flight.mcap")


@pytest.fixture(scope="module")
def other(galeway, tmp_path_factory):
    """The same scenario with other gusts, stronger ones."""
    folder = tmp_path_factory.mktemp("other")
    arguments = ["--seed", "8", "--set", "turbulence.severity=4", "--set", "limits=[]"]
    assert galeway("fly", SHORT, "--out", str(folder), *arguments).returncode == 0
    return str(folder / "flight.mcap")


@pytest.fixture
def check(galeway):
    return partial(galeway, "check")


@pytest.fixture
def cut(recording, tmp_path):
    """Half of the recording."""
    whole = Path(recording).read_bytes()
    path = tmp_path / "cut.mcap"
    path.write_bytes(whole[: len(whole) // 2])
    return str(path)


@pytest.fixture
def limits(tmp_path):
    """Writes a file of limits: (*limits) -> path."""

    def written(*limits):
        path = tmp_path / "limits.toml"
        path.write_text("limits = " + json.dumps(limits, ensure_ascii=False), encoding="utf-8")
        return str(path)

    return written


def test_a_table_of_verdicts(check, recording, limits):
    done = check(
        recording,
        "--limits",
        limits(
            "cross_track_m.p99 <= 3",
            'altitude_error_m within 10 except during "takeoff"',
            "airspeed_mps always >= 40 from 0:05 to 0:06",
            "never crashed",
            "arrived before 1:00",
            'bank_deg within 60 during "loiter"',
        ),
    )
    assert done.returncode == 1
    assert done.stderr == ""
    table = done.stdout.split("\n\n")[-1].splitlines()
    assert table[0].split() == ["limit", "value", "margin", "worst", "broken"]
    assert [line[:4] for line in table[1:]] == ["PASS", "PASS", "FAIL", "PASS", "PASS", "FAIL"]
    assert "for 60.1 s, longest 00:05:00 to 00:06:00" in table[3]
    assert 'no moment of the flight is during "loiter"' in table[6]


def test_several_recordings_are_named_and_each_judged_by_its_own_limits(check, recording, cut):
    done = check(recording, cut)
    assert done.returncode == 1
    assert done.stdout.splitlines()[0] == recording
    assert cut in done.stdout.splitlines()
    assert done.stdout.count("FAIL arrived == true") == 1
    assert "incomplete" in done.stderr
    assert check(recording, recording).returncode == 0


def test_one_bad_recording_does_not_keep_the_others_from_being_checked(check, recording, tmp_path):
    rubbish = tmp_path / "rubbish.mcap"
    rubbish.write_bytes(b"not a recording" * 100)
    done = check(str(rubbish), recording, "--json")
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    first, second = documents(done.stdout)
    assert "rubbish.mcap" in first["error"]
    assert (first["recording"], first["passed"], first["complete"]) == (str(rubbish), False, False)
    assert (second["recording"], second["passed"], second["error"]) == (recording, True, "")


def documents(text):
    """JSON documents one after the other."""
    decoder, found = json.JSONDecoder(), []
    while text := text.lstrip():
        document, end = decoder.raw_decode(text)
        found.append(document)
        text = text[end:]
    return found


def test_json_has_report_and_verdicts(check, flown, recording):
    done = check(recording, "--json")
    assert done.returncode == 0
    told = json.loads(done.stdout)
    report = json.loads((flown[1] / "report.json").read_text())
    report.pop("real_time_factor")
    assert {name: told[name] for name in report} == report
    assert list(told)[len(report) :] == [
        "recording",
        "complete",
        "missing",
        "passed",
        "verdicts",
        "notes",
        "error",
    ]
    assert [verdict["limit"] for verdict in told["verdicts"]] == [
        "arrived == true",
        "cross_track_m.p95 <= 2",
        "altitude_error_m.p95 <= 3",
        "waypoint_time_error_s.p95 <= 5",
    ]
    verdict = told["verdicts"][1]
    assert verdict["passed"] is True
    assert verdict["value"] == report["cross_track_m"]["p95"]
    assert verdict["margin"] == pytest.approx(2.0 - verdict["value"])
    assert verdict["worst"]["value"] == pytest.approx(report["cross_track_m"]["max"], abs=1e-5)
    assert done.stderr.count("PASS") == 4


def test_the_rerun_file_says_the_same(check, recording):
    told, again = (
        json.loads(check(path, "--json").stdout)
        for path in (recording, str(Path(recording).with_suffix(".rrd")))
    )
    assert again["recording"].endswith("flight.rrd")
    assert told | {"recording": ""} == again | {"recording": ""}


def test_junit_and_annotations(check, recording, cut, limits, tmp_path):
    path = tmp_path / "junit.xml"
    arguments = ["--limits", limits("cross_track_m.max <= 0.001", "never crashed")]
    done = check(recording, cut, *arguments, "--junit", str(path), "--github")
    assert done.returncode == 1
    whole, part = junitparser.JUnitXml.fromfile(str(path))
    assert (whole.name, whole.tests, whole.failures) == (recording, 2, 1)
    assert (part.name, part.tests, part.failures) == (cut, 3, 3)
    marked = [line for line in done.stdout.splitlines() if line.startswith("::error ")]
    assert len(marked) == 4
    assert marked[0].startswith(
        f"::error file={recording},title=cross_track_m.max <= 0.001::FAIL cross_track_m.max <= 0.001: "
    )
    quiet = check(recording, "--json", "--github", *arguments)
    json.loads(quiet.stdout)
    assert "::error file=" in quiet.stderr


def test_a_flight_is_no_worse_than_itself_and_worse_in_stronger_gusts(check, recording, other):
    same = check(recording, "--against", recording)
    assert same.returncode == 0, same.stdout
    assert "PASS cross_track_m.p95 at most" in same.stdout
    worse = check(other, "--against", recording)
    assert worse.returncode == 1
    assert "FAIL outside_airspeeds_s at most" in worse.stdout
    assert "note: the seeds differ: 8, before 7" in worse.stderr
    told = json.loads(check(other, "--against", recording, "--json").stdout)
    (exposed,) = [
        verdict for verdict in told["verdicts"] if verdict["limit"].startswith("outside_airspeeds_s")
    ]
    assert exposed["value"] > exposed["before"] + 5.0
    assert exposed["broken_s"] == exposed["value"]
    names = {verdict["limit"].split()[0] for verdict in told["verdicts"] if not verdict["passed"]}
    loose = [part for name in sorted(names) for part in ("--tolerance", f"{name}=1000%")]
    assert check(other, "--against", recording, *loose).returncode == 0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--tolerance", "cross_track_m.p95=10%"], ["--against"]),
        (
            ["--against", "RECORDING", "--tolerance", "cros_track_m.p95=10%"],
            ["did you mean cross_track_m.p95"],
        ),
        (["--against", "RECORDING", "--tolerance", "cross_track_m.p95=1ft"], ["ft"]),
        (["--against", "missing.mcap"], ["missing.mcap"]),
        (["--against", "CUT"], ["incomplete"]),
        (["--limits", "missing.toml"], ["missing.toml"]),
        (["--junit", "/proc/none/junit.xml"], ["/proc/none"]),
    ],
)
def test_bad_input_exits_2(check, recording, cut, arguments, words):
    places = {"RECORDING": recording, "CUT": cut}
    done = check(recording, *(places.get(argument, argument) for argument in arguments))
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    for word in words:
        assert word in done.stderr


def test_no_folder_is_made_for_the_junit_file(check, recording, tmp_path):
    done = check(recording, "--junit", str(tmp_path / "none" / "junit.xml"))
    assert done.returncode == 2
    assert "there is no folder" in done.stderr
    assert not (tmp_path / "none").exists()


def test_an_incomplete_recording_fails_whatever_it_passes(check, cut, limits):
    done = check(cut, "--limits", limits("airspeed_mps always > 1"))
    assert done.returncode == 1
    assert "PASS airspeed_mps always > 1" in done.stdout
    assert "incomplete: " in done.stderr
