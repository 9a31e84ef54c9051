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

from planner.departures import Departures
from planner.errors import BadFieldError
from planner.ground import Cell, Ground
from planner.hazards import Bools, StageClock
from planner.route import Route, evaluate
from planner.score import Weights
from planner.staged import StageEnd
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
    return blurred(np.asarray(members.mean(axis=0, dtype=np.float64)), blur_cells)


def blurred(share: Floats, blur_cells: float) -> Floats:
    """Shares of members, [stage, north, east], blurred in each stage; see `probability_from_members`."""
    if blur_cells == 0.0:
        return share
    wide = ndimage.gaussian_filter(share, blur_cells, axes=(1, 2), mode="nearest")
    return np.asarray(np.clip(wide, 0.0, 1.0), dtype=np.float64)


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
class Survival:
    """A route's chance to survive, between two bounds, and counted in an ensemble if there is one.

    `at_least`: the product of (1 - p) over its steps, each an independent draw. `at_most`: the least (1 - p)
    of them, as if one draw decided the whole flight. Errors of one sign go together in space and time, so
    that the truth lies between (Slepian's inequality). `members_survived`: of `members`.
    """

    at_least: float
    at_most: float
    members_survived: int | None = None
    members: int | None = None

    def below(self, level: float) -> bool:
        """Whether the chance is less than a level: the share of members, or without them the product."""
        if self.members is None or self.members_survived is None:
            return self.at_least < level
        return self.members_survived / self.members < level


def survival_of(
    cells: Sequence[Cell],
    first_step: int,
    probability: Floats,
    clock: StageClock,
    members: Bools | None = None,
) -> Survival:
    """The chance that no cell of a route is hazardous when it is occupied.

    Args:
        cells: occupied at each step from `first_step` on.
        first_step: the step of departure.
        probability: that a cell is hazardous, shape [stage, north, east].
        clock: the stages.
        members: an ensemble [member, stage, north, east] in which the route is counted.
    """
    at = _visited(cells, first_step, clock)
    safe = 1.0 - probability[at]
    chance = Survival(float(safe.prod()), float(safe.min()))
    if members is None:
        return chance
    survived = int((~members[:, *at].any(axis=1)).sum())
    return replace(chance, members_survived=survived, members=len(members))


@dataclass(frozen=True, slots=True)
class SafestRoute:
    """The most likely surviving route to a goal.

    `cells`: occupied at each step from `first_step` on; empty where there is no route, and `chance` is None.
    `abstained`: the chance lies below the level asked for, so the route should not be flown. `by_stage`: the
    safest route so far at the end of each stage from the departure's on, if asked for, empty while there is
    none.
    """

    goal: Cell
    cells: tuple[Cell, ...]
    first_step: int
    chance: Survival | None
    abstained: bool
    by_stage: tuple[tuple[Cell, ...], ...] = ()

    def evaluated(
        self, clearance: Floats, clock: StageClock, weights: Weights
    ) -> tuple[Route, tuple[StageEnd, ...]]:
        """The route, which there must be, and the safest ones so far, with their clearance and score."""
        known = {
            cells: evaluate(cells, clearance, clock, weights, self.first_step)
            for cells in {self.cells, *self.by_stage}
            if cells
        }
        begins = clock.stage_of_step(self.first_step)
        ends = (StageEnd(begins + at, known.get(cells)) for at, cells in enumerate(self.by_stage))
        return known[self.cells], tuple(ends)

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
    by_stage: bool = False,
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
        by_stage: whether the safest routes so far are wanted for the end of each stage.

    Raises:
        BadFieldError: if probabilities are not numbers in [0, 1] or shapes disagree.
        OutsideGridError: if the start or a goal lies off the grid.
    """
    check_level(abstain_below)
    for name, cell in (("start", start), *(("goal", goal) for goal in goals)):
        ground.check_cell(name, cell)
    open_ground, clock = without_certain_hazard(ground, probability), ground.clock
    none = [SafestRoute(goal, (), first_step, None, abstained=True) for goal in goals]
    if open_ground.hazard[clock.stage_of_step(first_step)][start]:
        return none
    swept = sweep(open_ground, _worth(probability, open_ground), start, goals, first_step=first_step)
    values = swept.values()
    begins = clock.stage_of_step(first_step) if by_stage else clock.stage_count - 1
    ends = [
        values[: (stage + 1) * clock.steps_per_stage].argmax(axis=0)
        for stage in range(begins, clock.stage_count)
    ]
    wanted = {
        (goal, int(end[index])): ()
        for end in ends
        for index, goal in enumerate(goals)
        if np.isfinite(values[end[index], index])
    }
    traced = dict(zip(wanted, routes(swept, list(wanted)), strict=True))
    found = []
    for index, missed in enumerate(none):
        so_far = tuple(traced.get((missed.goal, int(end[index])), ()) for end in ends)
        if not so_far[-1]:
            found.append(missed)
            continue
        chance = survival_of(so_far[-1], first_step, probability, clock, members)
        abstained = chance.below(abstain_below)
        reported = so_far if by_stage else ()
        found.append(SafestRoute(missed.goal, so_far[-1], first_step, chance, abstained, reported))
    return found


def survival_by_departure(
    probability: Floats, ground: Ground, start: Cell, goals: Sequence[Cell], slots: Sequence[int]
) -> Departures:
    """The safest arrival for each departure, with its chance to survive.

    Args:
        probability: that a cell is hazardous, shape [stage, north, east].
        ground: the clock, occupancy and moves; its hazard is closed besides.
        start: where all slots depart.
        goals: the goals.
        slots: steps of departure, within the horizon.
    """
    open_ground = without_certain_hazard(ground, probability)
    open_ground.check_departures(start, goals, slots)
    worth = _worth(probability, open_ground)
    chances = np.zeros((len(slots), len(goals)))
    arrivals = np.full(chances.shape, -1, dtype=np.int32)
    for row, slot in enumerate(slots):
        if not open_ground.hazard[ground.clock.stage_of_step(slot)][start]:
            values = sweep(open_ground, worth, start, goals, first_step=slot, keep=False).values()
            best = values.max(axis=0)
            chances[row] = np.exp(best)
            arrivals[row] = np.where(np.isfinite(best), values.argmax(axis=0), -1)
    return Departures(tuple(slots), tuple(goals), ground.clock.step_s, arrivals, chances)


def check_level(abstain_below: float) -> None:
    """Raise BadFieldError if a chance to survive that is asked for is none."""
    if not 0.0 <= abstain_below <= 1.0:
        raise BadFieldError(f"abstain below {abstain_below}; give a probability between 0 and 1")


def without_certain_hazard(ground: Ground, probability: Floats) -> Ground:
    """The ground with the cells closed besides that are certain to be hazard.

    Raises:
        BadFieldError: if probabilities are not numbers in [0, 1] or shapes disagree.
    """
    if probability.shape != ground.hazard.shape:
        raise BadFieldError(
            f"probabilities of shape {probability.shape} do not fit hazard of {ground.hazard.shape}"
        )
    if not ((probability >= 0.0) & (probability <= 1.0)).all():
        raise BadFieldError("a probability is not a number between 0 and 1; clip or fill the field first")
    return replace(ground, hazard=ground.hazard | (probability >= CERTAIN))


def _worth(probability: Floats, ground: Ground) -> Worth:
    """log(1 - p) as the worth of a step."""
    logs = np.log1p(-np.where(ground.hazard, 0.0, probability))
    return Worth(logs, 1.0, float(-logs.min()))


def _visited(
    cells: Sequence[Cell], first_step: int, clock: StageClock
) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
    """The stage, row and column of every step."""
    rows, columns = np.array(cells, dtype=np.intp).T
    stages = np.arange(first_step, first_step + len(cells)) // clock.steps_per_stage
    return stages, rows, columns
