"""The node score of the improved breadth-first search.

Source: "Route planning of UAV based on improved BFS", equation (2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from planner.errors import BadFieldError

T = TypeVar("T", float, NDArray[np.float64])


@dataclass(frozen=True, slots=True)
class Weights:
    """What a route's score trades: f = alpha D + beta Dbar - gamma L - delta T, larger is better.

    D is the clearance of the cell and Dbar its mean over the steps from the start, both in cells and capped
    at `clearance_cap_cells` (without hazard the distance is infinite); L is the number of moves, T the
    number of steps, waits included.
    """

    alpha: float = 1.0
    beta: float = 1.0
    gamma: float = 0.1
    delta: float = 0.1
    clearance_cap_cells: float = 30.0

    def __post_init__(self) -> None:
        for name in ("alpha", "beta", "gamma", "delta", "clearance_cap_cells"):
            value = getattr(self, name)
            if not math.isfinite(value) or value < 0.0:
                raise BadFieldError(f"the weight {name} is {value}; it must be finite and not negative")

    def score(self, *, clearance: T, mean_clearance: T, moves: T, steps: int) -> T:
        """Equation (2), for one node or for arrays of nodes at the same step."""
        return self.alpha * clearance + self.beta * mean_clearance - self.gamma * moves - self.delta * steps
