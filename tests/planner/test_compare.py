"""The comparison: rows that agree with the routes, a table that can be read, a picture."""

import math
import sys
from dataclasses import replace

import numpy as np
import pytest

from planner.compare import cells_by_step, compare
from planner.comparison_picture import draw
from planner.comparison_table import rows_table, summary_table
from planner.errors import BadFieldError, OutsideGridError, PlannerError
from planner.grid import Grid
from planner.hazards import StageClock, clearance_cells
from planner.peers import PEERS, Peer, PeerRoute, TrackPoint
from planner.pictures import check_picture
from planner.score import Weights
from planner.staged import StagedProblem, search

QUICK = {
    name: PEERS[name]
    for name in ("dfs", "bfs", "astar-cells", "astar-steps", "dstar-lite", "replanning", "paper", "staged")
}
GRID = Grid.covering(*map(math.radians, (29.0, 29.4, -91.0, -90.4)), rows=9, columns=12)
START, GOALS = (0, 0), [(0, 11), (8, 11), (4, 11)]


@pytest.fixture
def problem():
    """Two gaps in a wall; the nearer one shuts after the first stage. The last goal is never free."""
    hazard = np.zeros((8, 9, 12), dtype=bool)
    hazard[:, :, 8] = True
    hazard[0, 0:2, 8] = False
    hazard[:, 6:8, 8] = False
    hazard[:, 4, 11] = True
    return StagedProblem(hazard, StageClock(0.0, 8, 5), Weights(clearance_cap_cells=4.0))


def without_time(rows):
    return [replace(row, wall_s=0.0) for row in rows]


def test_a_row_for_each_planner_and_goal_the_same_every_time(problem):
    rows = compare(problem, START, GOALS, QUICK, truth=problem.hazard)
    assert [(row.peer, row.goal) for row in rows] == [(name, goal) for name in QUICK for goal in GOALS]
    assert without_time(rows) == without_time(compare(problem, START, GOALS, QUICK, truth=problem.hazard))
    assert all(row.wall_s > 0.0 for row in rows)


def test_delay_and_score_are_those_of_the_staged_search(problem):
    rows = {(row.peer, row.goal): row for row in compare(problem, START, GOALS, QUICK)}
    for goal, found in zip(GOALS, search(problem, START, GOALS), strict=True):
        for name in QUICK:
            row = rows[name, goal]
            if found.earliest is None:
                assert not row.keeps_rules
            elif row.keeps_rules:
                assert row.delay_steps == row.arrival_step - found.earliest.arrival_step >= 0
        if found.best:
            assert rows["paper", goal].score == pytest.approx(found.best.score)
            assert rows["staged", goal].delay_steps == rows["astar-steps", goal].delay_steps == 0
            assert rows["staged", goal].score <= found.best.score + 1e-9


def test_length_waits_and_clearance_are_counted_on_the_route(problem):
    clearance = clearance_cells(problem.hazard, 4.0)
    for row in compare(problem, START, GOALS, QUICK):
        if row.route.cells is None:
            assert (row.arrival_step, row.length_cells, row.score) == (None, None, None)
            assert row.route.reason
            continue
        assert row.length_cells + row.waits == row.arrival_step == len(row.route.cells) - 1
        clear = [clearance[(step // 5, *cell)] for step, cell in enumerate(row.route.cells)]
        assert row.min_clearance_cells == min(clear)
        assert row.mean_clearance_cells == pytest.approx(np.mean(clear))


def test_a_route_through_hazard_has_a_breach_and_no_delay(problem):
    rows = {row.goal: row for row in compare(problem, START, GOALS, {"bfs": PEERS["bfs"]})}
    assert "is in hazard" in rows[GOALS[0]].breach
    assert rows[GOALS[0]].delay_steps is None
    assert rows[GOALS[0]].min_clearance_cells == 0.0


def test_truth_is_judged_apart_from_the_forecast(problem):
    worse = problem.hazard.copy()
    worse[:, 6:8, 8] = True  # in truth no gap stays open
    for truth, safe in ((problem.hazard, True), (worse, False), (np.zeros_like(worse), True), (None, None)):
        (row,) = compare(problem, START, GOALS[:1], {"staged": PEERS["staged"]}, truth=truth)
        assert row.keeps_rules
        assert row.safe_in_truth is safe


def test_routes_in_the_plane_are_sampled_at_whole_steps(problem):
    track = (TrackPoint(0.0, 0.0, 0.0), TrackPoint(6.0, 0.0, 6.0), TrackPoint(8.0, 0.0, 6.0))
    track = (*track, TrackPoint(13.5, 5.5, 6.0))
    route = PeerRoute(track=track)
    cells = cells_by_step(route)
    assert cells[6:10] == ((0, 6), (0, 6), (0, 6), (1, 6))
    assert len(cells) == 15
    peers = {"fixed": Peer(lambda *_, **__: route, "a fixed track", False)}
    (row,) = compare(problem, START, [(6, 6)], peers)
    assert row.breach is None
    assert row.length_cells == pytest.approx(11.5)
    assert row.waits == pytest.approx(2.0)
    assert row.delay_steps == pytest.approx(13.5 - 12.0)
    assert cells_by_step(PeerRoute(reason="none")) == ()


def test_wrong_truth_and_cells_off_the_grid_are_errors(problem):
    with pytest.raises(BadFieldError, match="does not fit the problem's"):
        compare(problem, START, GOALS, QUICK, truth=problem.hazard[:2])
    with pytest.raises(OutsideGridError):
        compare(problem, (9, 0), GOALS, QUICK)


def test_tables_hold_what_the_rows_hold(problem):
    rows = compare(problem, START, GOALS, QUICK, truth=problem.hazard)
    lines = rows_table(rows, [(GOALS[0], "Miami")]).splitlines()
    assert len(lines) == 1 + len(rows)
    first = lines[1].split()
    assert first[:2] == ["dfs", "Miami"]
    assert "8,11" in lines[2]
    assert all(any(row.breach in line for line in lines) for row in rows if row.breach)
    summary = {line.split()[0]: line.split()[1:] for line in summary_table(rows).splitlines()}
    assert summary["planner"][:4] == ["found", "kept", "first", "truth"]
    assert summary["staged"][:6] == ["2/3", "2/3", "2/3", "2/3", "0", "0"]
    assert summary["bfs"][:2] == ["2/3", "0/3"]
    early = [replace(row, delay_steps=-0.04) for row in rows if row.keeps_rules]
    assert summary_table(early).splitlines()[1].split()[5:7] == ["0", "0"]
    assert rows_table(early).splitlines()[1].split()[3] == "0"
    assert summary_table([replace(row, safe_in_truth=None) for row in rows]).splitlines()[1].split()[4] == "-"


def test_the_picture_is_a_png_and_shows_routes(problem, tmp_path):
    pytest.importorskip("matplotlib")
    from matplotlib import image

    rows = compare(problem, START, GOALS, {name: QUICK[name] for name in ("bfs", "staged")})
    draw(problem, GRID, START, rows, tmp_path / "with.png")
    draw(
        problem,
        GRID,
        START,
        [replace(row, route=PeerRoute(reason="-")) for row in rows],
        tmp_path / "without.png",
    )
    shown, empty = (image.imread(tmp_path / name) for name in ("with.png", "without.png"))
    assert min(shown.shape[:2]) > 200
    blue = (shown[..., 2] > 0.6) & (shown[..., 0] < 0.3)
    assert blue.any()
    assert not ((empty[..., 2] > 0.6) & (empty[..., 0] < 0.3)).any()
    again = tmp_path / "again.png"
    draw(problem, GRID, START, rows, again)
    assert again.read_bytes() == (tmp_path / "with.png").read_bytes()


def test_the_picture_shows_what_is_around_the_routes_in_kilometres(problem, monkeypatch, tmp_path):
    pytest.importorskip("matplotlib")
    from matplotlib.figure import Figure

    figures = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_, **__: figures.append(figure))
    near, far = (compare(problem, START, [goal], {"staged": PEERS["staged"]}) for goal in ((0, 2), (8, 11)))
    for rows in (near, far):
        draw(problem, GRID, START, rows, tmp_path / "routes.png")
    edges_km = [(*figure.axes[0].get_xlim(), *figure.axes[0].get_ylim()) for figure in figures]
    side_km = GRID.east_cell_m.mean() / 1e3
    for (west, east, south, _), columns in zip(edges_km, (2, 11), strict=True):
        assert (west, south) == pytest.approx((-side_km / 2.0, -GRID.north_cell_m.mean() / 2e3))  # the grid's
        assert columns * side_km < east <= 11.5 * side_km + 1e-9
    assert edges_km[0][1] < 6.0 * side_km
    (line,) = (
        line for line in figures[1].axes[0].lines if line.get_linestyle() == "-" and len(line.get_xdata()) > 2
    )
    assert line.get_xdata()[-1] == pytest.approx(11 * side_km)


def test_a_picture_that_cannot_be_written_is_refused_before_the_planners_run(tmp_path):
    pytest.importorskip("matplotlib")
    check_picture(tmp_path / "routes.png")
    with pytest.raises(PlannerError, match=r"does not end in \.png"):
        check_picture(tmp_path / "routes.docx")
    with pytest.raises(PlannerError, match=r"there is no folder .*nowhere"):
        check_picture(tmp_path / "nowhere" / "routes.png")


def test_what_is_not_installed_is_named(problem, monkeypatch, tmp_path):
    for name in ("ompl.base", "pygad", "matplotlib.figure"):
        monkeypatch.setitem(sys.modules, name, None)  # as if it were not there
    for name in ("prm", "rrt", "rrt-star", "rrt-time", "genetic"):
        assert "galeway[peers]" in PEERS[name].find(problem, START, GOALS[0]).reason
    with pytest.raises(PlannerError, match=r"galeway\[plot\]"):
        draw(problem, GRID, START, [], tmp_path / "picture.png")
    with pytest.raises(PlannerError, match=r"galeway\[plot\]"):
        check_picture(tmp_path / "picture.png")


def test_no_route_arrives_never():
    assert PeerRoute(reason="none").arrival_step == math.inf
