"""What a wind-aware way is worth: its score, its chance to survive and its fuel, in continuous time.

Score and survival are counted in the units of the staged planner, cells and steps: a step in a cell is a
step's time in it, a move is a cell's length flown.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from planner.cheapest import Arrivals
from planner.clearance import capped_clearance
from planner.closures import chance_of_hazard
from planner.errors import PlannerError
from planner.grid import Grid
from planner.hazards import Bools
from planner.legs import Country
from planner.levels import stacked
from planner.planning import PlanningRequest
from planner.price import TIME, Price, over_way
from planner.route import ScoreTerms
from planner.survival import CERTAIN
from planner.timetable import length_m, waiting_s
from planner.way import Cell, Leg
from planner.windfield import FieldArray, Floats

Legs = Sequence[Leg]

_ENOUGH_SCORE = 0.005
_ENOUGH_RISK = 1e-3
_ENOUGH_RISK_SHARE = 0.01
_RISK_OF_A_STEP = 1e-8  # so that of equally safe ways the earlier is taken
_TURN_RISK = 1e-5


@dataclass(frozen=True, eq=False)
class Appraisal:
    """The measures of ways from one start.

    `hazard` and `speed_mps`, the strongest wind near each cell in each stage: [stage, north, east], of
    several levels in tall sheets.
    """

    grid: Grid
    request: PlanningRequest
    country: Country
    hazard: Bools
    speed_mps: FieldArray
    start: Cell
    loiter_mps: float

    @cached_property
    def clearance(self) -> Floats:
        """D of the score [cells], shape [stage, north, east]."""
        levels, cap_cells = self.country.chart.levels, self.request.weights.clearance_cap_cells
        if levels.count == 1:
            return capped_clearance(self.hazard, cap_cells)
        parts = [capped_clearance(part, cap_cells) for part in levels.parts(self.hazard)]
        return stacked(np.stack(parts, axis=1), 0.0)

    @cached_property
    def risk(self) -> Floats:
        """-log(1 - p) of a step in each cell, shape [stage, north, east].

        Raises:
            PlannerError: if the forecast has no error and there is no ensemble.
        """
        request = self.request
        chance = chance_of_hazard(
            self.speed_mps,
            threshold_mps=request.threshold_mps,
            error_mps=request.forecast_error_mps,
            closures=request.closures,
        )
        if chance is None:
            raise PlannerError(
                "there is no chance to survive without an error of the forecast or an ensemble"
            )
        risk: Floats = -np.log1p(-np.minimum(chance, CERTAIN))
        return risk

    @cached_property
    def cell_m(self) -> float:
        """What the score counts as a move [m]."""
        grid = self.grid
        return float(np.concatenate([grid.north_cell_m, grid.east_cell_m]).mean())

    @property
    def begin_s(self) -> float:
        """When ways begin; what counts is the time since then."""
        return self.country.begin_s

    def _took_s(self, legs: Legs) -> float:
        return _arrival_s(legs) - self.begin_s if legs else 0.0

    def worth(self, objective: str, legs: Legs) -> float:
        """What the objective makes large."""
        measure = {"score": self.score, "survival": self.log_survival, "fuel": self._saved_kg}
        return measure[objective](legs) if objective in measure else -_arrival_s(legs)

    def score(self, legs: Legs) -> float:
        """Equation (2) at the arrival."""
        return self.terms(legs).total

    def terms(self, legs: Legs) -> ScoreTerms:
        """Its terms: D at the goal, Dbar over time, L in cells flown, T in steps."""
        clock, weights = self.request.clock, self.request.weights
        arrival_s = self.begin_s + self._took_s(legs)
        goal = legs[-1].end if legs else self.start
        return ScoreTerms(
            weights.alpha * float(self.clearance[(clock.stage_at(arrival_s), *goal)]),
            weights.beta * self.mean_clearance(legs),
            -weights.gamma * length_m(self.country, legs) / self.cell_m,
            -weights.delta * self._took_s(legs) / clock.step_s,
        )

    def mean_clearance(self, legs: Legs) -> float:
        """Dbar, over the time since the beginning [cells]."""
        if not legs:
            return float(self.clearance[(self.request.clock.stage_at(self.begin_s), *self.start)])
        return over_way(self.clearance, self.country, legs) / self._took_s(legs)

    def log_survival(self, legs: Legs) -> float:
        """The logarithm of the chance to survive, each step an independent draw."""
        return -over_way(self.risk, self.country, legs) / self.request.clock.step_s

    def fuel_kg(self, legs: Legs) -> float | None:
        """What is burned on the legs at their airspeeds and on waits at the loiter's, if that is known."""
        flow = self.request.fuel_flow
        if flow is None:
            return None
        flying = sum(float(flow.at(leg.airspeed_mps)) * (leg.arrive_s - leg.leave_s) for leg in legs)
        return flying + float(flow.at(self.loiter_mps)) * waiting_s(legs, self.begin_s)

    def _saved_kg(self, legs: Legs) -> float:
        return -(self.fuel_kg(legs) or 0.0)

    def price(self, objective: str, took_s: float, mean_clearance: float) -> Price:
        """What a search adds up for "score" or "survival".

        The score is no sum, but for one time of arrival it is (as in `exact`); this is its change around a
        way that took such a time, with such a mean clearance.
        """
        step_s = self.request.clock.step_s
        if objective == "survival":
            per_s = _RISK_OF_A_STEP / step_s
            rate = self.risk / step_s
            return Price(per_s, 0.0, rate, _TURN_RISK, _ENOUGH_RISK, _ENOUGH_RISK_SHARE)
        weights, steps = self.request.weights, max(took_s / step_s, 1.0)
        per_s = (weights.delta + weights.beta * mean_clearance / steps) / step_s
        return Price(
            per_s,
            per_m=weights.gamma / self.cell_m,
            rate=self.clearance * (-weights.beta / (steps * step_s)),
            per_turn=TIME.per_turn * per_s,
            enough=_ENOUGH_SCORE,
        )

    def worth_of_arrivals(self, objective: str, goal: Cell, arrivals: Arrivals, reference_s: float) -> Floats:
        """The worth of labels at a goal, found by the price around a way that takes the reference time."""
        if objective == "survival":
            return -arrivals.integral
        weights, clock = self.request.weights, self.request.clock
        stages = (arrivals.time_s / clock.stage_s).astype(np.intp)
        clearance = self.clearance[stages, goal[0], goal[1]]
        return np.asarray(
            weights.alpha * clearance
            - self.rescaled(objective, arrivals, reference_s)
            - weights.gamma * arrivals.length_m / self.cell_m
            - weights.delta * (arrivals.time_s - self.begin_s) / clock.step_s
        )

    def rescaled(self, objective: str, arrivals: Arrivals, reference_s: float) -> Floats:
        """The integrals of labels as by the prices around their own times of arrival."""
        if objective == "survival":
            return arrivals.integral
        step_s = self.request.clock.step_s
        return (
            arrivals.integral * max(reference_s, step_s) / np.maximum(arrivals.time_s - self.begin_s, step_s)
        )

    def score_bound_s(self, goal: Cell, better_than: float) -> float:
        """The arrival after which no way's score can be above a value [s]."""
        weights, chart = self.request.weights, self.country.chart
        if not weights.delta:
            return math.inf
        most = weights.alpha * float(self.clearance[:, goal[0], goal[1]].max())
        most += weights.beta * float(self.clearance.max())
        (_, first), (_, last) = (chart.levels.split(cell) for cell in (self.start, goal))
        north_m, east_m = (
            line_m[end] - line_m[begin]
            for line_m, begin, end in zip((chart.north_m, chart.east_m), first, last, strict=True)
        )
        least_m = math.hypot(north_m, east_m) / float(chart.scale.max())
        steps = (most - weights.gamma * least_m / self.cell_m - better_than) / weights.delta
        return self.begin_s + steps * self.request.clock.step_s


def _arrival_s(legs: Legs) -> float:
    return legs[-1].arrive_s if legs else 0.0
