"""A plan as text: every figure that an outcome has, and why a plan is not flown."""

from dataclasses import replace

from planner.plans import GoalOutcome, NearestPlace, Plan, Waypoint
from sim.plan_text import plan_lines, why_not_flown

WAY = GoalOutcome(
    "A",
    1.0,
    2.0,
    reachable=True,
    earliest_arrival_s=3600.0,
    arrival_s=5400.0,
    length_m=81_000.0,
    waiting_s=600.0,
    min_clearance_m=7_000.0,
    survival=0.25,
    survival_at_most=0.5,
    members_survived=3,
    members=8,
)
NO_WAY = GoalOutcome(
    "B",
    1.0,
    2.0,
    reachable=False,
    reason="no safe way",
    nearest=NearestPlace(-33.5, 151.25, 12_000.0, 7260.0),
    last_door_stage=4,
)
PLAN = Plan("staged", "survival", 0.0, "A", (Waypoint(0.0, 0.0, 1e3, 0.0, 0),), (WAY, NO_WAY))


def test_a_line_for_each_goal():
    assert list(plan_lines(PLAN)) == [
        "plan (staged, by survival), departure 1970-01-01T00:00Z",
        " > A              1:30 h (earliest 1:00), 81 km, waits 10 min, 7 km clear of hazard, "
        "survives 25 % to 50 % (3 of 8 members)",
        "   B              no route: no safe way; nearest 33.50 S 151.25 E, 12 km off, at 2:01 h, "
        "last door in stage 4",
    ]
    assert len(list(plan_lines(PLAN, goal_alone=True))) == 2
    shut = replace(NO_WAY, last_door_stage=None)
    assert list(plan_lines(replace(PLAN, goals=(WAY, shut))))[-1].endswith("cut off all along")


def test_why_a_plan_is_not_flown():
    assert why_not_flown(PLAN, 0.0) is None
    risky = replace(PLAN, goals=(replace(WAY, abstained=True), NO_WAY))
    assert "chance to survive on the way to A is 25 %" in why_not_flown(risky, 0.5)
    assert "is 50 %" in why_not_flown(risky, 0.5)
    nowhere = replace(PLAN, goal="B", waypoints=())
    assert why_not_flown(nowhere, 0.0) == "no route to B: no safe way"
