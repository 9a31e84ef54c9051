"""Routes found anew at the forecast of each stage, from where the aircraft has come to."""

from __future__ import annotations

from collections.abc import Sequence

from planner.ground import Cell
from sim.reproduce.judging import first_hazard
from sim.reproduce.outlook import Case, Way, Window
from sim.reproduce.safest import Safest
from sim.reproduce.tuning import Tuning

ROOM_CELLS = 50
"""How far around what is left of the old route a new one is looked for."""

MORE_STAGES = 2
"""How many stages later than the old one it may arrive."""


SURE = 0.99
"""The chance to survive from which on the rest of a route is not looked at again at a stage."""


def replanned(case: Case, ways: Sequence[Way], tuning: Tuning) -> list[Way]:
    """The ways that are flown in the end.

    Where a new forecast leaves no way, the old one is kept. A flight that is already lost is left as it is,
    which saves time and changes nothing.

    Args:
        case: with later forecasts.
        ways: as planned at departure.
        tuning: the dials of survival.
    """
    assert case.later is not None  # such a policy is not asked without
    flown, clock = list(ways), case.truth.clock
    for stage in range(1, clock.stage_count):
        step = stage * clock.steps_per_stage
        flying = [at for at, way in enumerate(flown) if way is not None and _under_way(way, step, case)]
        if not flying:
            break
        outlook = case.later(stage)
        for at in flying:
            way = flown[at]
            assert way is not None
            safest = Safest(
                outlook,
                blur_cells=tuning.blur_cells,
                price=tuning.price,
                window=_around(way, step, case),
            )
            if safest.chance(way[step:], step) >= SURE:
                continue
            (rest,) = safest.find(way[step], [case.goals[at]], step)
            if rest is not None:
                flown[at] = way[:step] + rest
    return flown


def _under_way(way: tuple[Cell, ...], step: int, case: Case) -> bool:
    return len(way) - 1 > step and first_hazard(way[: step + 1], case.truth) is None


def _around(way: tuple[Cell, ...], step: int, case: Case) -> Window:
    """The surroundings of what is left of a route, in space and time."""
    clock, shape = case.truth.clock, case.truth.shape
    rows, columns = (
        slice(max(min(axis) - ROOM_CELLS, 0), min(max(axis) + ROOM_CELLS + 1, size))
        for axis, size in zip(zip(*way[step:], strict=True), shape, strict=True)
    )
    last = min(clock.stage_of_step(len(way) - 1) + MORE_STAGES, clock.stage_count - 1)
    return Window(slice(clock.stage_of_step(step), last + 1), rows, columns)
