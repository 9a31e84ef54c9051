"""The picture and the section of figure 4."""

from __future__ import annotations

from pathlib import Path

from sim.reproduce.costs import DayCosts
from sim.reproduce.drawing import COLOURS, MARKS, bare, new_figure, save, whole_numbers
from sim.reproduce.figure3 import FIVE
from sim.reproduce.wording import counted, number, table


def draw(costs: DayCosts, path: Path) -> None:
    """Equation (2) by day, of both."""
    figure = new_figure(9.0, 3.4)
    axes = figure.subplots()
    for name, label, values in (("bfs", "plain BFS", costs.bfs), ("score", "staged planner", costs.staged)):
        axes.plot(costs.days + 1, values, color=COLOURS[name], marker=MARKS[name], label=label)
        axes.axhline(values.mean(), color=COLOURS[name], linestyle=":", linewidth=1.2)
    axes.set(xlabel="day (dotted: the mean)", ylabel="f by equation (2), larger is better")
    whole_numbers(axes.xaxis)
    bare(axes)
    axes.legend(frameon=False, ncols=2, loc="upper center", bbox_to_anchor=(0.5, 1.14))
    save(figure, path)


def section(costs: DayCosts) -> list[str]:
    """What the page says of figure 4, without the picture."""
    rows = [
        [f"day {day + 1}", str(goals), f"{bfs:.1f}", f"{staged:.1f}", f"{staged - bfs:.1f}"]
        for day, goals, bfs, staged in zip(
            costs.days.tolist(),
            costs.goals.tolist(),
            costs.bfs.tolist(),
            costs.staged.tolist(),
            strict=True,
        )
    ][:FIVE]
    bfs, staged, difference = (number(part) for part in costs.means())
    rows.append(
        [f"mean of {counted(len(costs.days), 'day')}", str(costs.goals.sum()), bfs, staged, difference]
    )
    return table(["", "goals", "plain BFS", "staged planner", "difference"], rows)
