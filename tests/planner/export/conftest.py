"""Plans to export, with what a reader has to find in them."""

import math
from itertools import pairwise
from typing import NamedTuple

import pyproj
import pytest
from hypothesis import strategies as st

from planner.plans import GoalOutcome, Plan, Waypoint


class Visit(NamedTuple):
    lat_deg: float
    lon_deg: float
    altitude_m: float
    arrive_s: float
    leave_s: float

    @property
    def times_s(self):
        return (self.arrive_s, self.leave_s) if self.leave_s > self.arrive_s else (self.arrive_s,)


def plan_of(visits, departure_s=1664323200.0, goals=()):
    waypoints = tuple(Waypoint(*visit[:3], time_s, 0) for visit in visits for time_s in visit.times_s)
    return Plan("staged", "score", departure_s, "Tampa", waypoints, goals)


places = st.tuples(
    st.integers(-89_999_999, 89_999_999).map(lambda number: number / 1e6),
    st.integers(-180_000_000, 179_999_999).map(lambda number: number / 1e6),
    st.integers(-4_000, 200_000).map(lambda number: number / 10.0),
)


@st.composite
def any_journey(draw):
    """A plan, and each stop of it with its arrival and departure; no stop is followed by itself."""
    route = draw(
        st.lists(places, min_size=1, max_size=12).filter(lambda some: all(a != b for a, b in pairwise(some)))
    )
    legs_ms = st.integers(1_000, 3_600_000)
    waits_ms = st.one_of(st.just(0), st.integers(1, 36_000_000))
    visits, now_ms = [], 0
    for place in route:
        leave_ms = now_ms + draw(waits_ms)
        visits.append(Visit(*place, now_ms / 1e3, leave_ms / 1e3))
        now_ms = leave_ms + draw(legs_ms)
    departure_s = draw(st.integers(-2_000_000_000, 4_000_000_000))
    return plan_of(visits, float(departure_s)), visits


@pytest.fixture(scope="session")
def journeys():
    """Strategy for (plan, visits)."""
    return any_journey()


@pytest.fixture(scope="session")
def make_plan():
    """Builds a plan from tuples (latitude, longitude, altitude, arrival, departure)."""
    return lambda visits, **options: plan_of([Visit(*visit) for visit in visits], **options)


@pytest.fixture(scope="session")
def short_plan():
    """Three stops, the second a wait of 600.5 s, with one goal reached and one not."""
    goals = (
        GoalOutcome("Tampa", 24.06, -83.97, True, "", 960.0, 960.0, 9_700.0, 600.5, 12.5),
        GoalOutcome("Ponce & <co>", 18.0, -66.0, False, "no safe way"),
    )
    visits = [
        Visit(24.0, -84.0, 1000.0, 0.0, 0.0),
        Visit(24.03, -83.97, 1000.0, 180.0, 780.5),
        Visit(24.06, -83.97, 1100.0, 960.0, 960.0),
    ]
    return plan_of(visits, goals=goals)


@pytest.fixture(scope="session")
def long_journey():
    """(plan, visits): four hundred stops, every 50th a loiter, at speeds and heights that wander."""
    ellipsoid = pyproj.Geod(ellps="WGS84")
    visits, lat_deg, lon_deg, now_s = [], 24.0, -84.0, 0.0
    for index in range(400):
        leave_s = now_s + (600.0 + index if index % 50 == 25 else 0.0)
        visits.append(Visit(lat_deg, lon_deg, 1000.0 + index, now_s, leave_s))
        now_s = leave_s + 120.0
        course_deg, speed_mps = 40.0 + 30.0 * math.sin(index / 9.0), 29.0 + 3.0 * math.sin(index / 5.0)
        lon_deg, lat_deg, _ = ellipsoid.fwd(lon_deg, lat_deg, course_deg, speed_mps * 120.0)
    return plan_of(visits), visits
