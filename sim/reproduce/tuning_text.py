"""What was tried of the dials, in tables, and what is chosen."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from sim.reproduce.choosing import MOST_LONGER, Choice, Tried, count
from sim.reproduce.experiments import LEVELS
from sim.reproduce.judging import Fate
from sim.reproduce.page import prose
from sim.reproduce.policies import POLICIES
from sim.reproduce.tuning import Tuning
from sim.reproduce.wording import percent, seeds, table

RULE = [
    prose(
        f"""`galeway reproduce --tune` tries every value below on seeded days that no figure is made from, at
        both levels of error, and chooses by one rule: the most safe arrivals at both levels together, the
        first of equals. Survival's flights may moreover take no more than {100 * MOST_LONGER:g} % longer, at
        either level, than those of the paper's score, to the goals that both reach safely. Who does not fly
        does not arrive, so when to abstain is chosen by safe arrivals less aircraft lost. *Used* is what
        the figures are made with (`sim/reproduce/tuning.py`). All is planned once and judged on the grid;
        replanning takes the dials of survival."""
    )
]

_DIALS: Mapping[str, Mapping[str, Callable[[Tuning], float]]] = {
    "score": {
        "beta": lambda dials: dials.weights.beta,
        "clearance at most, cells": lambda dials: dials.weights.clearance_cap_cells,
    },
    "margins": {"margin, cells": lambda dials: dials.margin_cells},
    "survival": {
        "blur, cells": lambda dials: dials.blur_cells,
        "price of a step": lambda dials: dials.price,
    },
    "abstain": {"abstain below": lambda dials: dials.abstain_below},
}
"""Policy to its dials' titles and values."""


def section(choices: Mapping[str, Choice], days: Sequence[int], used: Tuning) -> list[str]:
    """Of days of one size."""
    goals = len(choices["score"].chosen.levels[0])
    lines = [f"{seeds(days).capitalize()}: {goals} goals at each level."]
    for policy, choice in choices.items():
        head = [*_DIALS[policy], *(f"safe, {level}" for level in LEVELS.values()), "safe", "lost"]
        head += [*(f"longer, {level}" for level in LEVELS.values()), ""]
        rows = [_row(one, choice, policy, used) for one in choice.tried]
        title = POLICIES[policy].title
        lines += ["", f"**{title[0].upper()}{title[1:]}**", "", *table(head, rows)]
        lines += ["", _apart(choice, policy, used, len(days))]
    return lines


def _apart(choice: Choice, policy: str, used: Tuning, days: int) -> str:
    """How far what is used is from what is chosen."""
    found = [one for one in choice.tried if _values(one.dials, policy) == _values(used, policy)]
    if not found:
        return "What is used was not among these."
    if found[0] is choice.chosen:
        return "What is used is chosen."
    what = "safe arrivals less aircraft lost" if Fate.LOST in choice.worth else "safe arrivals"
    return (
        f"Chosen above used: {percent(choice.gain(found[0], days), 1)} of the goals in {what}, with the 95 % "
        "interval over days."
    )


def _row(one: Tried, choice: Choice, policy: str, used: Tuning) -> list[str]:
    values = _values(one.dials, policy)
    notes = ["**chosen**"] * (one is choice.chosen) + ["used"] * (values == _values(used, policy))
    return [
        *(f"{value:g}" for value in values),
        *(str(count(rows, Fate.SAFE)) for rows in one.levels),
        str(one.count(Fate.SAFE)),
        str(one.count(Fate.LOST)),
        *(f"{100 * share:.1f} %" for share in one.longer(choice.reference)),
        ", ".join(notes),
    ]


def _values(dials: Tuning, policy: str) -> list[float]:
    return [value(dials) for value in _DIALS[policy].values()]
