"""The paper's planner in pure Python, word for word: what the planner's speed is measured against.

Cells are numbers, sheets are lists, no array library is used. It reads the paper as docs/planner.md says: one
label per (step, cell), the best incoming one, double-buffered, the parent kept per (step, cell).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

Sheet = list[bool]


class LiteralWorld:
    """Hazard sheets with a border of hazard, cells numbered row by row."""

    def __init__(self, hazard: Sequence[Sequence[Sequence[bool]]], steps_per_stage: int) -> None:
        self.rows, self.columns = len(hazard[0]), len(hazard[0][0])
        self.width = self.columns + 1
        self.steps_per_stage = steps_per_stage
        self.step_count = steps_per_stage * len(hazard)
        self.sheets = [self._bordered(stage) for stage in hazard]
        self.offsets = (0, self.width, -self.width, 1, -1)  # stay, north, south, east, west

    def _bordered(self, stage: Sequence[Sequence[bool]]) -> Sheet:
        border = [True] * self.width
        sheet = list(border)
        for row in stage:
            sheet.extend(row)
            sheet.append(True)
        return sheet + border

    def number(self, cell: tuple[int, int]) -> int:
        return (cell[0] + 1) * self.width + cell[1]

    def cell(self, number: int) -> tuple[int, int]:
        return number // self.width - 1, number % self.width


def clearance(world: LiteralWorld, cap: int) -> list[list[float]]:
    """Distance to the nearest hazard of each stage, capped: two passes, along columns and along rows."""
    found = []
    for sheet in world.sheets:
        squares = [cap] * len(sheet)
        for order, back in ((range(1, world.rows + 1), -1), (range(world.rows, 0, -1), 1)):
            for row in order:
                for at in range(row * world.width, row * world.width + world.columns):
                    if sheet[at]:
                        squares[at] = 0
                    else:
                        squares[at] = min(squares[at], squares[at + back * world.width] + 1)
        squares = [value * value for value in squares]
        distances = [0.0] * len(sheet)
        for row in range(1, world.rows + 1):
            begin = row * world.width
            line = squares[begin : begin + world.columns]
            for column in range(world.columns):
                best = line[column]
                offset = 1
                while offset * offset < best and offset < cap:
                    if column >= offset:
                        best = min(best, line[column - offset] + offset * offset)
                    if column + offset < world.columns:
                        best = min(best, line[column + offset] + offset * offset)
                    offset += 1
                distances[begin + column] = min(math.sqrt(best), float(cap))
        found.append(distances)
    return found


def earliest_carried(
    world: LiteralWorld, start: tuple[int, int], goals: Sequence[tuple[int, int]]
) -> list[list[tuple[int, int]] | None]:
    """Routes of earliest arrival, every reached cell carried on in every step."""
    begin = world.number(start)
    reached = [] if world.sheets[0][begin] else [begin]
    numbers = [world.number(goal) for goal in goals]
    arrival = dict.fromkeys(set(numbers) & set(reached), 0)
    size = len(world.sheets[0])
    parents = [bytearray(size)]
    for step in range(1, world.step_count):
        sheet = world.sheets[step // world.steps_per_stage]
        parent = bytearray(b"\xff") * size
        following = []
        for code, offset in enumerate(world.offsets):
            for at in reached:
                there = at + offset
                if not sheet[there] and parent[there] == 255:
                    parent[there] = code
                    following.append(there)
        reached = following
        parents.append(parent)
        for goal in numbers:
            if goal not in arrival and parent[goal] != 255:
                arrival[goal] = step

    def back(goal: int) -> list[tuple[int, int]] | None:
        if goal not in arrival:
            return None
        at, route = goal, [world.cell(goal)]
        for step in range(arrival[goal], 0, -1):
            at -= world.offsets[parents[step][at]]
            route.append(world.cell(at))
        return route[::-1]

    return [back(goal) for goal in numbers]


def earliest_queued(
    world: LiteralWorld, start: tuple[int, int], goals: Sequence[tuple[int, int]]
) -> list[list[tuple[int, int]] | None]:
    """Routes of earliest arrival.

    Within a stage a reached cell stays reached, so that each step has only the cells new in it to look around
    from; when a stage begins, all that are still safe look around again.
    """
    per_stage = world.step_count // len(world.sheets)
    reached: set[int] = set()
    since: list[dict[int, int]] = []  # in each stage: the step from which on a cell is occupied
    arrival: dict[int, int] = {}
    wanted = {world.number(goal) for goal in goals}
    fresh: list[int] = []
    for stage, sheet in enumerate(world.sheets):
        begin = stage * per_stage
        entered: dict[int, int] = {}
        if stage == 0:
            fresh = [] if sheet[world.number(start)] else [world.number(start)]
            reached = set(fresh)
            for at in fresh:
                entered[at] = 0
            steps = range(1, per_stage)
        else:
            fresh = list(reached)
            reached = {at for at in fresh if not sheet[at]}
            for at in reached:
                entered[at] = begin
            steps = range(begin, begin + per_stage)
        for step in steps:
            following = []
            for at in fresh:
                for offset in world.offsets[1:]:
                    there = at + offset
                    if not sheet[there] and there not in reached:
                        reached.add(there)
                        entered[there] = step
                        following.append(there)
            fresh = following
        since.append(entered)
        for goal in wanted:
            if goal in entered and goal not in arrival:
                arrival[goal] = entered[goal]

    def back(goal: int) -> list[tuple[int, int]] | None:
        if goal not in arrival:
            return None
        at, route = goal, [world.cell(goal)]
        for step in range(arrival[goal], 0, -1):
            entered = since[(step - 1) // per_stage]
            at = next(
                at - offset for offset in world.offsets if entered.get(at - offset, math.inf) <= step - 1
            )
            route.append(world.cell(at))
        return route[::-1]

    return [back(world.number(goal)) for goal in goals]


def best_score(
    world: LiteralWorld,
    start: tuple[int, int],
    goals: Sequence[tuple[int, int]],
    weights: tuple[float, float, float, float],
    cap: int,
) -> list[tuple[float, list[tuple[int, int]]] | None]:
    """Best-scoring arrival at each goal, by equation (2), with its route."""
    alpha, beta, gamma, delta = weights
    clear = clearance(world, cap)
    size = len(world.sheets[0])
    begin = world.number(start)
    if world.sheets[0][begin]:
        return [None] * len(goals)
    history, moves = {begin: clear[0][begin]}, {begin: 0}
    parents = [bytearray(0)]
    numbers = [world.number(goal) for goal in goals]
    best: list[tuple[float, int] | None] = [None] * len(goals)
    for step in range(world.step_count):
        stage = step // world.steps_per_stage
        sheet, near = world.sheets[stage], clear[stage]
        if step:
            share = beta / (step + 1)
            values: dict[int, float] = {}
            new_history: dict[int, float] = {}
            new_moves: dict[int, int] = {}
            parent = bytearray(size)
            for at, total in history.items():
                length = moves[at]
                value = share * total - gamma * length
                for code, offset in enumerate(world.offsets):
                    there = at + offset
                    arriving = value - gamma if code else value
                    if not sheet[there] and arriving > values.get(there, -math.inf):
                        values[there] = arriving
                        new_history[there] = total + near[there]
                        new_moves[there] = length + 1 if code else length
                        parent[there] = code
            history, moves = new_history, new_moves
            parents.append(parent)
        for index, goal in enumerate(numbers):
            if goal in history:
                mean = history[goal] / (step + 1)
                score = alpha * near[goal] + beta * mean - gamma * moves[goal] - delta * step
                known = best[index]
                if known is None or score > known[0]:
                    best[index] = score, step
    found: list[tuple[float, list[tuple[int, int]]] | None] = []
    for goal, known in zip(numbers, best, strict=True):
        if known is None:
            found.append(None)
            continue
        at, route = goal, [world.cell(goal)]
        for step in range(known[1], 0, -1):
            at -= world.offsets[parents[step][at]]
            route.append(world.cell(at))
        found.append((known[0], route[::-1]))
    return found
