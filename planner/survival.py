"""The chance to survive: hazard as probability, and the routes that meet the least of it.

The sweep of the paper with another sum: every step in a cell costs -log(1 - p). So the best route is the
one of the largest product of (1 - p), each step taken as an independent draw. Neighbouring cells and hours
share their fate, hence that product is a cautious figure; where there is an ensemble, the share of its
members that a route survives is the better one, and both are reported.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage, special

from planner.errors import BadFieldError
from planner.ground import Cell, Ground
from planner.hazards import Bools
from planner.sweep import Worth, sweep
from planner.trace import routes

Floats = NDArray[np.float64]

CERTAIN = 1.0 - 1e-9
"""A probability from which on a cell counts as closed."""


def probability_from_members(members: Bools, *, blur_cells: float = 3.0) -> Floats:
    """Probability of hazard as the share of members, blurred.

    The blur stands for storms that lie a little elsewhere than in any member.

    Args:
        members: hazard matrices of each member, shape [member, stage, north, east].
        blur_cells: standard deviation of the blur, in cells; 0 for none.

    Returns:
        Shape [stage, north, east].
    """
    if members.ndim != 4 or not members.size:
        raise BadFieldError(f"members of shape {members.shape}; give [member, stage, north, east]")
    if not (np.isfinite(blur_cells) and blur_cells >= 0.0):
        raise BadFieldError(f"a blur of {blur_cells} cells; give a finite number, 0 or more")
    share = members.mean(axis=0, dtype=np.float64)
    if blur_cells == 0.0:
        return np.asarray(share, dtype=np.float64)
    blurred = ndimage.gaussian_filter(share, blur_cells, axes=(1, 2), mode="nearest")
    return np.asarray(np.clip(blurred, 0.0, 1.0), dtype=np.float64)


def probability_from_forecast(speed_mps: Floats, *, threshold_mps: float, error_mps: float) -> Floats:
    """Probability that the wind exceeds the threshold, if the forecast errs normally.

    Args:
        speed_mps: forecast wind speed, shape [stage, north, east].
        threshold_mps: wind speed above which a cell is hazardous [m/s].
        error_mps: standard deviation of the forecast's error [m/s], more than 0.

    Returns:
        Shape [stage, north, east].
    """
    if not (np.isfinite(error_mps) and error_mps > 0.0):
        raise BadFieldError(f"a forecast error of {error_mps} m/s; give a finite number above 0")
    return np.asarray(special.ndtr((speed_mps - threshold_mps) / error_mps), dtype=np.float64)


@dataclass(frozen=True, slots=True)
class SafestRoute:
    """The most likely surviving route to a goal.

    `cells`: occupied at each step from `first_step` on; empty where there is no route. `survival`: product of
    (1 - p) over its steps. `members_survived`: of `members`, None without an ensemble. `abstained`: the
    survival lies below the level asked for, so the route should not be flown.
    """

    goal: Cell
    cells: tuple[Cell, ...]
    first_step: int
    survival: float
    members_survived: int | None
    members: int | None
    abstained: bool

    @property
    def arrival_step(self) -> int | None:
        """The step at which the goal is reached, None without a route."""
        return self.first_step + len(self.cells) - 1 if self.cells else None


def search_survival(
    probability: Floats,
    ground: Ground,
    start: Cell,
    goals: Sequence[Cell],
    *,
    members: Bools | None = None,
    abstain_below: float = 0.0,
    first_step: int = 0,
) -> list[SafestRoute]:
    """Find the route of the greatest chance to survive to each goal, over all arrivals in the horizon.

    Of equally safe arrivals the earliest is taken, and of equally safe labels the one with fewer moves.

    Args:
        probability: that a cell is hazardous, shape [stage, north, east].
        ground: the clock, occupancy and moves; its hazard is closed besides.
        start: the cell occupied at departure.
        goals: the goals.
        members: an ensemble [member, stage, north, east] in which routes are counted.
        abstain_below: the least chance to survive: the share of members, or without them the product.
        first_step: the step of departure.

    Raises:
        BadFieldError: if probabilities are not numbers in [0, 1] or shapes disagree.
        OutsideGridError: if the start or a goal lies off the grid.
    """
    if not 0.0 <= abstain_below <= 1.0:
        raise BadFieldError(f"abstain below {abstain_below}; give a probability between 0 and 1")
    for name, cell in (("start", start), *(("goal", goal) for goal in goals)):
        ground.check_cell(name, cell)
    open_ground, worth = _as_worth(probability, ground)
    none = [SafestRoute(goal, (), first_step, 0.0, None, None, True) for goal in goals]
    if open_ground.hazard[ground.clock.stage_of_step(first_step)][start]:
        return none
    swept = sweep(open_ground, worth, start, goals, first_step=first_step)
    values = swept.values()
    arrivals = values.argmax(axis=0)
    found = [index for index in range(len(goals)) if np.isfinite(values[arrivals[index], index])]
    traced = routes(swept, [(goals[index], int(arrivals[index])) for index in found])
    for index, cells in zip(found, traced, strict=True):
        at = _visited(cells, first_step, ground)
        survival = float(np.exp(worth.sheets[at].sum()))
        survived = None if members is None else int((~members[:, *at].any(axis=1)).sum())
        chance = survival if survived is None or members is None else survived / len(members)
        count = None if members is None else len(members)
        none[index] = SafestRoute(
            goals[index], cells, first_step, survival, survived, count, chance < abstain_below
        )
    return none


def survival_by_departure(
    probability: Floats, ground: Ground, start: Cell, goals: Sequence[Cell], slots: Sequence[int]
) -> Floats:
    """The greatest chance to survive for each departure, shape [slot, goal], 0 where there is no route.

    Args:
        probability: that a cell is hazardous, shape [stage, north, east].
        ground: the clock, occupancy and moves; its hazard is closed besides.
        start: where all slots depart.
        goals: the goals.
        slots: steps of departure, within the horizon.
    """
    open_ground, worth = _as_worth(probability, ground)
    chances = np.zeros((len(slots), len(goals)))
    for row, slot in enumerate(slots):
        if not open_ground.hazard[ground.clock.stage_of_step(slot)][start]:
            swept = sweep(open_ground, worth, start, goals, first_step=slot, keep=False)
            chances[row] = np.exp(swept.values().max(axis=0))
    return chances


def _as_worth(probability: Floats, ground: Ground) -> tuple[Ground, Worth]:
    """The ground without what is certain to be hazard, and log(1 - p) as the worth of a step."""
    if probability.shape != ground.hazard.shape:
        raise BadFieldError(
            f"probabilities of shape {probability.shape} do not fit hazard of {ground.hazard.shape}"
        )
    if not ((probability >= 0.0) & (probability <= 1.0)).all():
        raise BadFieldError("a probability is not a number between 0 and 1; clip or fill the field first")
    closed = ground.hazard | (probability >= CERTAIN)
    logs = np.log1p(-np.where(closed, 0.0, probability))
    return replace(ground, hazard=closed), Worth(logs, 1.0, float(-logs.min()))


def _visited(
    cells: tuple[Cell, ...], first_step: int, ground: Ground
) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
    """The stage, row and column of every step."""
    rows, columns = np.array(cells, dtype=np.intp).T
    stages = np.arange(first_step, first_step + len(cells)) // ground.clock.steps_per_stage
    return stages, rows, columns
