import numpy as np
import pytest

from sim.reproduce.flights import CROSS_EDGES_M, FlownTask, fly_task
from sim.reproduce.flown_figures import flown_figures, tracking_by_wind, why_lost, with_abstention
from sim.reproduce.worlds import FLOWN


@pytest.fixture(scope="module")
def flown():
    """The oracle's flight to a goal nearby."""
    return fly_task(FlownTask(FLOWN, 2, 1.0, "oracle", 0))


def test_the_oracle_s_plan_is_flown_safely_and_closely(flown):
    assert flown["planned"] == flown["flown"] == "safe"
    assert flown["outcome"] == "arrived"
    assert flown["hazard_exposure_s"] == 0.0
    assert abs(flown["flight_time_s"] - flown["planned_s"]) < 60.0
    samples = np.sum(flown["cross_track_by_wind"])
    assert samples == pytest.approx(5 * flown["flight_time_s"], rel=0.02)


def test_the_percentiles_are_those_of_the_histogram(flown):
    winds = tracking_by_wind([flown, flown])
    assert sum(wind.samples for wind in winds) == 2 * np.sum(flown["cross_track_by_wind"])
    for wind in winds:
        assert 0.0 < wind.median_m < wind.p95_m <= wind.p99_m < CROSS_EDGES_M[-1]


def test_a_goal_without_a_plan_is_not_flown():
    walled = FlownTask(FLOWN, 1, 1.0, "bfs", 0)
    row = fly_task(walled)
    assert row["planned"] == "no route"
    assert "flown" not in row


def row(seed, planned, flown=None, **more):
    told = {"seed": seed, "scale": 1.0, "policy": "survival", "goal": 0, "planned": planned}
    return told | ({} if flown is None else {"flown": flown}) | more


def test_shares_count_goals_that_nobody_flew_to():
    rows = [row(1, "safe", "safe"), row(1, "safe", "lost"), row(2, "no route"), row(2, "lost", "safe")]
    found = flown_figures(rows)
    assert (found.goals, found.unflown) == (4, 1)
    assert (found.planned.value, found.flown.value, found.lost.value) == (0.5, 0.5, 0.25)
    assert found.counts == {("safe", "safe"): 1, ("safe", "lost"): 1, ("lost", "safe"): 1}


def test_who_abstains_flies_what_survival_flies_and_no_more():
    rows = [row(1, "safe", "safe", abstained=False), row(2, "lost", "lost", abstained=True)]
    flies, stays = with_abstention(rows)
    assert flies["flown"] == "safe"
    assert stays["planned"] == "abstained"
    assert "flown" not in stays


@pytest.mark.parametrize(
    ("more", "why"),
    [
        ({"outcome": "refused"}, "no flyable curve"),
        ({"outcome": "cannot_follow", "arrived": False}, "ended before its goal: cannot follow"),
        ({"planned": "lost"}, "by its plan"),
        ({"late_at_hazard_s": 90.0}, "but late"),
        ({"late_at_hazard_s": -90.0}, "but early"),
        ({"late_at_hazard_s": 3.0}, "beside its cells"),
    ],
)
def test_why_a_flight_was_lost(more, why):
    told = {"outcome": "arrived", "arrived": True, "planned": "safe", "late_at_hazard_s": None} | more
    assert why in why_lost(told)
