"""What is not made ready to fly."""

import pytest

from sim.errors import ScenarioError


def test_a_plan_that_is_abstained_from_is_not_made_ready(ready):
    too_risky = ("hazard.forecast_error_mps=4", "hazard.threshold_mps=13", "planner.abstain_below=0.999999")
    with pytest.raises(ScenarioError, match=r"not to be flown: .* below planner.abstain_below 0.999999"):
        ready(*too_risky)
    assert ready(*too_risky[:2]).header.plan.outcome.survival < 0.999999
