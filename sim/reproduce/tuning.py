"""What the policies' dials stand at. They were turned on days that no figure is made from."""

from __future__ import annotations

from dataclasses import dataclass

from planner.score import Weights


@dataclass(frozen=True, slots=True)
class Tuning:
    """The dials of all policies.

    `weights`: of the paper's score. `margin_cells`: kept from forecast hazard where there is a way, else half
    of it, else none. `blur_cells`: of the share of members. `price`: of a step, in units of -log(1 - p).
    `abstain_below`: the least share of members in which a route has to survive to be flown.
    """

    weights: Weights = Weights(beta=16.0)  # noqa: RUF009 - frozen
    margin_cells: float = 24.0
    blur_cells: float = 3.0
    price: float = 0.005
    abstain_below: float = 0.2


TUNED = Tuning()
"""For the paper's size."""

TUNED_SMALL = Tuning(
    weights=Weights(clearance_cap_cells=12.0), margin_cells=6.0, blur_cells=1.0, price=0.05, abstain_below=0.6
)
"""For weather of a seventh of that size: lengths in cells are so much shorter."""
