"""D* Lite: replanning every stage that repairs the last search instead of starting again.

Source: S. Koenig and M. Likhachev, "D* Lite", AAAI 2002, figure 3 (the basic version).
"""

from __future__ import annotations

import heapq
import math

from planner.hazards import OFFSETS, Move
from planner.peers.hourly import follow
from planner.peers.route import PeerRoute
from planner.staged import Cell, StagedProblem

_MOVES = [(move, offset) for move, offset in OFFSETS.items() if move is not Move.STAY]

Key = tuple[float, float]


def find(problem: StagedProblem, start: Cell, goal: Cell, *, seed: int = 0) -> PeerRoute:  # noqa: ARG001
    """Fly a shortest way on the map of the hour, repaired when the map changes."""
    return follow(problem, start, goal, DStarLite(problem, start, goal))


class DStarLite:
    """The search, from the goal toward the cell that is occupied; `expansions` counts its work."""

    def __init__(self, problem: StagedProblem, start: Cell, goal: Cell) -> None:
        self._problem, self._goal = problem, goal
        self._here = self._last = start
        self._offset = 0.0  # k_m: what the start has moved since keys were made
        self._cost: dict[Cell, float] = {}  # g
        self._ahead: dict[Cell, float] = {goal: 0.0}  # rhs, one step of look-ahead
        self._keys: dict[Cell, Key] = {}
        self._heap: list[tuple[Key, Cell]] = []
        self._stage = -1
        self.expansions = 0
        self._insert(goal)

    def see(self, stage: int, here: Cell) -> None:
        """Take a stage's map: update the cells whose moves changed, then repair the search."""
        self._here = here
        self._offset += _distance(self._last, here)
        self._last = here
        changed = self._changed_sources(stage)
        self._stage = stage
        for cell in changed:
            self._update(cell)
        self._repair()

    def next_cell(self, here: Cell) -> Cell | None:
        """The neighbour with the least cost to go, the first of equals."""
        ahead = self._next_cells(here)
        best = min(ahead, key=lambda cell: self._cost.get(cell, math.inf), default=None)
        return best if best is not None and self._cost.get(best, math.inf) < math.inf else None

    def _changed_sources(self, stage: int) -> list[Cell]:
        if self._stage < 0:
            return []
        hazard, flyable = self._problem.hazard, self._problem.flyable
        cells: set[Cell] = set()
        for row, column in zip(*(hazard[stage] != hazard[self._stage]).nonzero(), strict=True):
            cells.update(_neighbours((int(row), int(column)), hazard.shape[1:]))
        if flyable is not None:
            changed = (flyable[stage] != flyable[self._stage]).any(axis=0).nonzero()
            cells.update((int(row), int(column)) for row, column in zip(*changed, strict=True))
        return sorted(cells)

    def _may(self, cell: Cell, move: Move, target: Cell) -> bool:
        flyable = self._problem.flyable
        safe = not self._problem.hazard[self._stage][target]
        return safe and (flyable is None or bool(flyable[(self._stage, move, *cell)]))

    def _next_cells(self, cell: Cell) -> list[Cell]:
        rows, columns = self._problem.hazard.shape[1:]
        near = ((move, (cell[0] + north, cell[1] + east)) for move, (north, east) in _MOVES)
        return [
            target
            for move, target in near
            if 0 <= target[0] < rows and 0 <= target[1] < columns and self._may(cell, move, target)
        ]

    def _key(self, cell: Cell) -> Key:
        least = min(self._cost.get(cell, math.inf), self._ahead.get(cell, math.inf))
        return least + _distance(self._here, cell) + self._offset, least

    def _insert(self, cell: Cell) -> None:
        self._keys[cell] = self._key(cell)
        heapq.heappush(self._heap, (self._keys[cell], cell))

    def _update(self, cell: Cell) -> None:
        if cell != self._goal:
            costs = [self._cost.get(target, math.inf) for target in self._next_cells(cell)]
            self._ahead[cell] = 1.0 + min(costs, default=math.inf)
        self._keys.pop(cell, None)
        if self._cost.get(cell, math.inf) != self._ahead.get(cell, math.inf):
            self._insert(cell)

    def _repair(self) -> None:
        shape = self._problem.hazard.shape[1:]
        while self._heap:
            old, cell = self._heap[0]
            if self._keys.get(cell) != old:
                heapq.heappop(self._heap)  # left behind by an update
                continue
            here = self._here
            settled = self._ahead.get(here, math.inf) == self._cost.get(here, math.inf)
            if settled and old >= self._key(here):
                return
            heapq.heappop(self._heap)
            del self._keys[cell]
            if old < self._key(cell):
                self._insert(cell)
                continue
            self.expansions += 1
            if self._cost.get(cell, math.inf) > self._ahead[cell]:
                self._cost[cell] = self._ahead[cell]
            else:
                self._cost[cell] = math.inf
                self._update(cell)
            for before in _neighbours(cell, shape):
                self._update(before)


def _distance(here: Cell, there: Cell) -> float:
    return float(abs(here[0] - there[0]) + abs(here[1] - there[1]))


def _neighbours(cell: Cell, shape: tuple[int, ...]) -> list[Cell]:
    near = ((cell[0] + north, cell[1] + east) for _, (north, east) in _MOVES)
    return [(row, column) for row, column in near if 0 <= row < shape[0] and 0 <= column < shape[1]]
