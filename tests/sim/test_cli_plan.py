"""Planning from the command line: one's own matrices, exports, the wind-aware planner, the comparison."""

import json
from pathlib import Path

import numpy as np
import pytest

SHORT = str(Path(__file__).parent / "scenarios" / "short.toml")


@pytest.fixture
def matrices(tmp_path):
    """Two sets of matrices: a wall with a door that opens in the second stage, and no hazard at all."""
    hazards = np.zeros((2, 3, 4, 5), dtype=np.int8)
    hazards[0, 0, :, 2] = 7
    path = tmp_path / "hazards.npz"
    np.savez(path, day=hazards, other=np.zeros(3))
    return path


def plan_on(galeway, matrices, *more):
    return galeway("plan", "--hazards", str(matrices), "--key", "day", "--steps-per-stage", "6", *more)


def test_own_matrices_give_a_result_a_goal(galeway, matrices):
    done = plan_on(
        galeway, matrices, "--index", "0", "--start", "0,0", "--goal", "0,4", "--goal", "1,1", "--json"
    )
    assert done.returncode == 0, done.stderr
    wall, near = json.loads(done.stdout)
    keys = {
        "goal",
        "reachable",
        "arrival_step",
        "arrival_min",
        "waits",
        "score",
        "min_clearance_cells",
        "route",
    }
    assert keys <= set(wall)
    assert (wall["goal"], wall["arrival_step"], wall["arrival_min"]) == ([0, 4], 8, 16.0)
    assert wall["waits"] == 4
    assert wall["route"][0] == [0, 0, 0]
    assert wall["route"][-1] == [8, 0, 4]
    assert near["arrival_step"] == 2


def test_options_reach_the_planner(galeway, matrices):
    goal = ("--start", "0,0", "--goal", "0,4")
    strict = plan_on(galeway, matrices, "--index", "0", *goal, "--occupancy", "strict")
    assert json.loads(strict.stdout)[0]["arrival_step"] == 9
    clear = plan_on(
        galeway, matrices, "--index", "1", *goal, "--objective", "score", "--exact", "--gamma", "0.5"
    )
    (found,) = json.loads(clear.stdout)
    assert found["arrival_step"] == 4
    assert found["gap"] == pytest.approx(0.0, abs=1e-6)
    assert found["terms"]["length"] == pytest.approx(-2.0)
    capped = plan_on(galeway, matrices, "--index", "1", *goal, "--clearance-cap-cells", "12.5")
    assert json.loads(capped.stdout)[0]["min_clearance_cells"] == 12.5


def test_a_goal_without_a_way_is_an_answer(galeway, tmp_path):
    np.save(tmp_path / "wall.npy", np.tile([0, 0, 1, 0], (2, 3, 1)))
    done = galeway("plan", "--hazards", str(tmp_path / "wall.npy"), "--start", "0,0", "--goal", "1,3")
    assert done.returncode == 1
    (found,) = json.loads(done.stdout)
    assert not found["reachable"]
    assert "no safe way" in found["reason"]


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (["--start", "0,0", "--goal", "9,9", "--index", "0"], ["(9, 9)", "4 rows and 5 columns"]),
        (["--start", "0;0", "--goal", "0,1", "--index", "0"], ["--start '0;0'", "ROW,COLUMN"]),
        (["--start", "0,0", "--goal", "0,1", "--index", "5"], ["--index 5", "2 sets"]),
        (["--start", "0,0", "--goal", "0,1"], ["[stage, row, column]"]),
        (["--start", "0,0", "--goal", "0,1", "--index", "0", "--alpha", "nan"], ["alpha", "nan"]),
        (["--start", "0,0", "--goal", "0,1", "--index", "0", "--objective", "best"], ["'best'", "earliest"]),
        (
            ["--start", "0,0", "--goal", "0,1", "--index", "0", "--key", "night"],
            ["day", "--key, not 'night'"],
        ),
        (
            ["--start", "0,0", "--goal", "0,1", "--index", "0", "--members", "night"],
            ["day, other; name one with --members, not 'night'"],
        ),
        (
            ["--start", "0,0", "--goal", "0,1", "--index", "0", "--members", "other"],
            ["members of shape (3,); give"],
        ),
        (["--index", "0"], ["--start"]),
    ],
)
def test_bad_matrices_and_cells_are_named(galeway, matrices, more, words):
    done = plan_on(galeway, matrices, *more)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    assert all(word in done.stderr for word in words), done.stderr


def test_a_file_that_holds_no_matrices_is_named(galeway, tmp_path):
    (tmp_path / "rubbish.npz").write_bytes(b"PK rubbish")
    for name in ("rubbish.npz", "missing.npz"):
        done = galeway("plan", "--hazards", str(tmp_path / name), "--start", "0,0", "--goal", "0,1")
        assert done.returncode == 2
        assert name in done.stderr
        assert "Traceback" not in done.stderr


@pytest.mark.parametrize("kind", ["staged", "windaware"])
def test_the_route_is_exported(galeway, tmp_path, kind):
    paths = [tmp_path / f"route.{suffix}" for suffix in ("geojson", "kml", "gpx", "plan", "waypoints")]
    exports = [word for path in paths for word in ("--export", str(path))]
    done = galeway("plan", SHORT, "--planner", kind, *exports)
    assert done.returncode == 0, done.stderr
    assert all(path.stat().st_size > 200 for path in paths)
    wrong = galeway("plan", SHORT, "--export", str(tmp_path / "route.docx"))
    assert wrong.returncode == 2
    assert ".geojson" in wrong.stderr


def test_the_wind_aware_plan_is_flown_on_time(galeway, tmp_path):
    done = galeway("fly", SHORT, "--planner", "windaware", "--out", str(tmp_path))
    assert done.returncode == 0, done.stdout + done.stderr
    report = json.loads((tmp_path / "report.json").read_text())
    assert report["arrived"]
    assert report["flight_time_s"] == pytest.approx(report["planned_time_s"], rel=0.005)
    assert report["waypoint_time_error_s"]["p95"] < 3.0
    staged = json.loads(galeway("plan", SHORT, "--json").stdout)
    aware = json.loads((tmp_path / "plan.json").read_text())
    assert aware["goals"][0]["length_m"] < staged["goals"][0]["length_m"]


def test_planners_are_compared(galeway):
    done = galeway("compare", SHORT, "--only", "staged,bfs,astar-steps,windaware")
    assert done.returncode == 0, done.stderr
    assert done.stderr.split() == ["staged", "...", "bfs", "...", "astar-steps", "...", "windaware", "..."]
    assert "There" in done.stdout
    summary = done.stdout.rpartition("planner ")[2].splitlines()[1:]
    kept = {line.split()[0]: line.split()[2] for line in summary if line}
    assert kept == dict.fromkeys(("staged", "bfs", "astar-steps", "windaware"), "1/1")
    unknown = galeway("compare", SHORT, "--only", "oracle")
    assert unknown.returncode == 2
    assert "'oracle'" in unknown.stderr


def test_a_scenario_and_matrices_exclude_each_other(galeway, matrices):
    done = galeway("plan", "ian", "--hazards", str(matrices), "--start", "0,0", "--goal", "1,3")
    assert done.returncode == 2
    assert "give the scenario 'ian' or --hazards, not both" in done.stderr


@pytest.mark.parametrize("option", ["--out", "--export", "--isochrones"])
def test_a_folder_that_is_not_there_is_found_before_the_planning(galeway, tmp_path, option):
    done = galeway("plan", "ian", option, str(tmp_path / "no" / "plan.npy"))
    assert done.returncode == 2
    assert f"there is no folder {tmp_path / 'no'} for plan.npy; make it first" in done.stderr
    assert done.stdout == ""
