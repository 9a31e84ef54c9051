"""What commands have in common: the scenario with all that overrides a part of it, and exit codes."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from planner.plans import Plan
    from sim.scenario import LoadedScenario

BAD_INPUT = 2
FAILED = 1
INTERRUPTED = 130
TERMINATED = 143
"""In place of it where SIGTERM interrupted: 128 and the number of the signal, as for Ctrl-C."""


def scenario_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """The scenario and everything that overrides a part of it."""
    return click.argument("scenario", default="ian")(override_options(command))


def override_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Everything that overrides a part of a scenario; see `settings`."""
    for decorate in (
        click.option("--set", "overrides", multiple=True, metavar="KEY=VALUE", help="Override any value."),
        click.option("--goal", help="Fly to this goal; short for --set mission.goal=NAME."),
        click.option("--seed", type=int, help="Short for --set seed=N."),
        click.option("--planner", help="Short for --set planner.kind=KIND."),
    ):
        command = decorate(command)
    return command


def load(
    scenario: str,
    overrides: tuple[str, ...],
    goal: str | None,
    seed: int | None,
    planner: str | None,
    **more: Any,
) -> LoadedScenario:
    """Read a scenario with its overrides; `more` are values of keys in [planner], None where not given."""
    from sim.scenario import load_scenario

    return load_scenario(scenario, settings(overrides, goal, seed, planner, **more))


def settings(
    overrides: tuple[str, ...], goal: str | None, seed: int | None, planner: str | None, **more: Any
) -> list[str]:
    """All that is put in place of a scenario's values, as "table.key=value"."""
    shortcuts = {"mission.goal": goal, "seed": seed, "planner.kind": planner}
    shortcuts |= {f"planner.{name}": value for name, value in more.items()}
    given = [f"{key}={json.dumps(value)}" for key, value in shortcuts.items() if value is not None]
    return [*overrides, *given]


def only_one(_: click.Context, option: click.Parameter, values: tuple[Any, ...]) -> Any:
    """The value of an option, None without; click would take the last of several without a word."""
    if len(values) > 1:
        raise click.BadParameter(f"it is given {len(values)} times; give one", param=option)
    return values[0] if values else None


def print_plan(made: Plan, abstain_below: float, *, goal_alone: bool = False) -> None:
    """The plan, a line for each goal; and on stderr why it is not to be flown, if it is not."""
    from sim.plan_text import plan_lines, why_not_flown

    for line in plan_lines(made, goal_alone=goal_alone):
        click.echo(line)
    reason = why_not_flown(made, abstain_below)
    if reason:
        click.secho(reason, fg="red", err=True)


def print_other_hazards(loaded: LoadedScenario) -> None:
    """What a scenario calls hazardous, if that is more than the wind."""
    if loaded.scenario.hazard.also:
        from sim.hazard_text import hazard_lines

        for line in hazard_lines(loaded.scenario.hazard):
            click.echo(line)


def tell(text: str) -> None:
    """Say on stderr what a user has to know besides the result."""
    click.secho(text, fg="yellow", err=True)
