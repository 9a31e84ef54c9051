"""Plans come back from their files as they were."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner.errors import BadPlanError
from planner.plans import GoalOutcome, Plan, Waypoint

finite = st.floats(allow_nan=False, allow_infinity=False)
waypoints = st.builds(Waypoint, finite, finite, finite, finite, st.integers(0, 17))
outcomes = st.builds(GoalOutcome, st.text(), finite, finite, st.booleans(), st.text())
plans = st.builds(
    Plan,
    planner=st.text(),
    objective=st.text(),
    departure_s=finite,
    goal=st.text(),
    waypoints=st.lists(waypoints, max_size=4).map(tuple),
    goals=st.lists(outcomes, max_size=3).map(tuple),
)


@given(plans)
def test_json_round_trip(plan):
    assert Plan.from_json(plan.to_json()) == plan


def test_file_round_trip(tmp_path):
    plan = Plan("staged", "score", 0.0, "a", (Waypoint(1.0, 2.0, 3.0, 4.0, 0),), ())
    plan.save(tmp_path / "plan.json")
    assert Plan.load(tmp_path / "plan.json") == plan
    assert plan.duration_s == 4.0


def test_other_files_are_refused(tmp_path):
    with pytest.raises(BadPlanError, match="cannot read"):
        Plan.load(tmp_path / "missing.json")
    with pytest.raises(BadPlanError, match="not a galeway plan"):
        Plan.from_json(b'{"planner": 1}')
    newer = Plan("staged", "score", 0.0, "a", (), (), format=99).to_json()
    with pytest.raises(BadPlanError, match="format 99"):
        Plan.from_json(newer)
