"""Fuel flow between and beyond the airspeeds at which it was measured."""

import pytest

from planner.consumption import FuelFlow
from planner.errors import PlannerError

FLOW = FuelFlow((20.0, 24.0, 30.0), (4e-5, 3e-5, 6e-5))


def test_flow_is_linear_between_and_kept_beyond():
    assert FLOW.at(22.0) == pytest.approx(3.5e-5)
    assert FLOW.at(27.0) == pytest.approx(4.5e-5)
    assert (FLOW.at(10.0), FLOW.at(50.0)) == (4e-5, 6e-5)


@pytest.mark.parametrize(
    ("bounds_mps", "best_mps"), [((18.0, 40.0), 24.0), ((25.0, 40.0), 25.0), ((20.0, 22.0), 22.0)]
)
def test_the_thriftiest_airspeed_lies_within_bounds(bounds_mps, best_mps):
    assert FLOW.thriftiest(*bounds_mps) == best_mps


@pytest.mark.parametrize(
    ("airspeed_mps", "flow_kgps", "word"),
    [
        ((), (), "0 fuel flows"),
        ((20.0,), (1e-5, 2e-5), "2 fuel flows"),
        ((20.0, 20.0), (1e-5, 2e-5), "rising"),
        ((20.0, 21.0), (1e-5, 0.0), "above 0"),
        ((20.0, 21.0), (1e-5, float("nan")), "above 0"),
    ],
)
def test_what_is_no_consumption_is_refused(airspeed_mps, flow_kgps, word):
    with pytest.raises(PlannerError, match=word):
        FuelFlow(airspeed_mps, flow_kgps)
