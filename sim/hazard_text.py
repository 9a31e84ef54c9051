"""What a scenario calls hazardous, in words."""

from __future__ import annotations

from sim.hazard_tables import (
    AlsoHazard,
    EnsembleHazard,
    GustHazard,
    Hazard,
    MatricesHazard,
    NoFlyHazard,
)


def hazard_lines(hazard: Hazard) -> list[str]:
    """A line for the wind, and one for each other reason."""
    first = f"hazard: wind over {hazard.threshold_mps:g} m/s"
    return [first, *(f"        {reason}" for reason in other_reasons(hazard))]


def other_reasons(hazard: Hazard) -> tuple[str, ...]:
    """What is hazardous besides the mean wind."""
    return tuple(_words(table, hazard) for table in hazard.also)


def _words(table: AlsoHazard, hazard: Hazard) -> str:
    if isinstance(table, GustHazard):
        if table.factor is not None:
            mean_mps = table.threshold_mps / table.factor
            return (
                f"gusts over {table.threshold_mps:g} m/s, {table.factor:g} times the wind: wind over "
                f"{mean_mps:.3g} m/s"
            )
        return f"{table.variable or 'gusts'} over {table.threshold_mps:g} m/s{_of(table.file)}"
    if isinstance(table, EnsembleHazard):
        threshold_mps = hazard.threshold_mps if table.threshold_mps is None else table.threshold_mps
        return (
            f"{table.variable or 'wind'} over {threshold_mps:g} m/s in more than "
            f"{100.0 * table.more_than:g} % of an ensemble{_of(table.file)}"
        )
    if isinstance(table, MatricesHazard):
        return f"matrices{_of(table.file)}"
    if isinstance(table, NoFlyHazard):
        return f"no-fly zones{_of(table.file)}"
    limits = [
        f"{word} {limit:g} {table.unit}"
        for word, limit in (("over", table.above), ("under", table.below))
        if limit is not None
    ]
    return f"{table.variable} {' or '.join(limits)}{_of(table.file)}"


def _of(file: str | None) -> str:
    return "" if file is None else f" ({file})"
