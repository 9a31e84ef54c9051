from dataclasses import replace

import numpy as np
import pytest

from sim.errors import SimError
from sim.reproduce.days import Day, choose_mission, hazard_of
from sim.reproduce.forecasts import DayForecasts
from sim.reproduce.outlook import Window
from sim.reproduce.worlds import PAPER


def test_a_seed_is_a_day(small):
    one, same, other = Day(small, 3), Day(small, 3), Day(small, 4)
    assert (one.truth == same.truth).all()
    assert one.mission == same.mission
    assert (one.truth != other.truth).any()
    assert one.mission != other.mission


def test_the_paper_s_world_is_of_the_paper_s_size():
    assert PAPER.grid.shape == (548, 421)
    assert (PAPER.clock.stage_count, PAPER.clock.steps_per_stage, PAPER.goals) == (18, 30, 10)
    nodes = PAPER.nodes
    assert (nodes.rows - 1) * PAPER.node_cells >= 547
    assert (nodes.columns - 1) * PAPER.node_cells >= 420


def test_so_much_of_the_paper_s_area_is_hazardous_as_in_the_paper():
    share = Day(PAPER, 7).truth.mean(axis=(1, 2))
    assert share.min() >= 0.10
    assert share.max() <= 0.35


def test_systems_move(small):
    """Successive maps overlap more when the second is moved back by some cells than where it lies."""
    drifting = Day(replace(small, drifts_mps=(12.0, 12.0), life_s=24 * 3600.0), 5).truth
    now, later = drifting[0], drifting[3]
    still = (now & later).sum()
    shifts = [np.roll(later, (rows, columns), axis=(0, 1)) for rows in (-9, 0, 9) for columns in (-9, 0, 9)]
    assert max((now & shifted).sum() for shifted in shifts) > still


def test_the_hazard_is_that_of_the_wind_at_the_cells_centres(small):
    day = Day(small, 3)
    on_cells = day.wind.resampled(day.grid)
    begin, end = (
        np.hypot(*on_cells.sheet(day.clock.departure_s + at * day.clock.stage_s)) > small.threshold_mps
        for at in (0, 1)
    )
    differs = (begin | end) != day.truth[0]
    assert differs.mean() < 1e-3  # rounding of float32 right at the threshold


def test_missions_keep_the_world_s_rules(small):
    for seed in range(3, 9):
        day = Day(small, seed)
        start, goals = day.mission
        assert len(set(goals)) == small.goals
        row, column = start
        clear = small.start_clear_cells
        assert not day.truth[0, row - clear : row + clear + 1, column].any()
        assert not day.truth[0, row, column - clear : column + clear + 1].any()
        for goal in goals:
            assert 8 <= abs(goal[0] - row) + abs(goal[1] - column) <= 20
            assert not day.truth[:, goal[0], goal[1]].all()


def test_a_day_without_a_safe_start_says_so(small):
    with pytest.raises(SimError, match="another --seed"):
        choose_mission(np.ones((4, 41, 37), dtype=bool), small, np.random.default_rng(1))


def test_forecasts_without_error_are_the_truth(small):
    day = Day(small, 3)
    forecasts = DayForecasts(day, 1e-9, members=2)
    assert (hazard_of(forecasts.wind(0), small) == day.truth).mean() > 0.999
    p = forecasts.ensemble(0).probability(0.0, Window.whole())
    assert (np.abs(p - day.truth) < 0.5).mean() > 0.9  # members are known on the nodes alone


def test_later_forecasts_are_better(small):
    def wrong(stage):
        return np.mean(
            [
                (hazard_of(DayForecasts(day, 2.0).wind(stage), small) != day.truth)[3].mean()
                for day in (Day(small, seed) for seed in range(3, 9))
            ]
        )

    assert wrong(3) < wrong(0)


def test_members_from_the_errors_are_those_of_the_project_s_forecasts(small):
    """The ensemble is made by a shorter way than `FieldForecasts.members`; it has to be the same wind."""
    forecasts = DayForecasts(Day(small, 3), 2.0, members=3)
    peaks = forecasts.ensemble(0).peaks_mps
    members = forecasts._made.members(0, 3)
    clock = small.clock
    for mine, member in zip(peaks, members, strict=True):
        speed = np.hypot(member.north_mps, member.east_mps)
        first = int(np.searchsorted(member.time_s, clock.departure_s))
        expected = np.maximum(speed[first], speed[first + 1])
        np.testing.assert_allclose(mine[0], expected, atol=0.1)  # metres of a sphere, or not
