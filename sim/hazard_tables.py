"""The tables of a scenario that say what else is hazardous: `[[hazard.also]]`, one kind each."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta, Struct

from sim.errors import ScenarioError

Positive = Annotated[float, Meta(gt=0.0)]
NotNegative = Annotated[float, Meta(ge=0.0)]
Share = Annotated[float, Meta(ge=0.0, le=1.0)]


class GustHazard(Struct, frozen=True, tag_field="kind", tag="gust"):
    """Gusts over a threshold: `factor` times the mean wind, or a variable of its file or of `file`."""

    threshold_mps: Positive
    factor: Annotated[float, Meta(ge=1.0, le=5.0)] | None = None
    file: str | None = None
    variable: str | None = None


class EnsembleHazard(Struct, frozen=True, tag_field="kind", tag="ensemble"):
    """More than a share of an ensemble's members over the threshold (without one, that of the wind).

    The members are the weather's own, or those of `file`: of a `variable` that is a speed, or of its wind.
    The share of members, blurred by `blur_cells`, is the chance of hazard that survival is computed from.
    """

    more_than: Share
    threshold_mps: Positive | None = None
    file: str | None = None
    variable: str | None = None
    blur_cells: Annotated[float, Meta(ge=0.0, le=100.0)] = 3.0


class MatricesHazard(Struct, frozen=True, tag_field="kind", tag="matrices"):
    """Hazard matrices of one's own on the planner's grid, `[stage, north, east]`, from a NumPy file."""

    file: str
    key: str | None = None


class VariableHazard(Struct, frozen=True, tag_field="kind", tag="variable"):
    """A CF variable of the weather file, or of `file`, above or below a limit in `unit`."""

    variable: str
    unit: str
    above: float | None = None
    below: float | None = None
    file: str | None = None
    gaps: Literal["refuse", "hazard", "clear"] = "refuse"


class NoFlyHazard(Struct, frozen=True, tag_field="kind", tag="no_fly"):
    """Polygons of a GeoJSON file, always and at all altitudes or as their properties say."""

    file: str


AlsoHazard = GustHazard | EnsembleHazard | MatricesHazard | VariableHazard | NoFlyHazard


class Hazard(Struct, frozen=True):
    """What is dangerous: wind above the threshold, anywhere within a corridor around the path.

    `forecast_error_mps`: standard deviation of the forecast's wind speed, from which the chance to survive is
    computed; 0 takes the forecast as right. `also`: what is dangerous besides.
    """

    threshold_mps: Positive = 15.0
    corridor_m: NotNegative = 1100.0
    forecast_error_mps: NotNegative = 0.0
    also: tuple[AlsoHazard, ...] = ()

    @property
    def mean_threshold_mps(self) -> float:
        """The mean wind above which a cell is hazardous: the threshold, or a lower one that a gust sets.

        Gusts of so many times the mean wind are over their threshold where the mean wind is over that
        threshold divided by the factor.
        """
        by_gust = [
            table.threshold_mps / table.factor
            for table in self.also
            if isinstance(table, GustHazard) and table.factor is not None
        ]
        return min([self.threshold_mps, *by_gust])

    @property
    def tells_chance(self) -> bool:
        """Whether a chance to survive can be computed."""
        return self.forecast_error_mps > 0.0 or any(isinstance(table, EnsembleHazard) for table in self.also)


def check_hazard(hazard: Hazard, source: str, *, weather_file: bool) -> None:
    """What no key of a table can be checked for alone.

    Args:
        hazard: the whole of it.
        source: the scenario, for messages.
        weather_file: whether the weather is a gridded file, whose variables can be named.

    Raises:
        ScenarioError: naming the table and what to write instead.
    """
    for number, table in enumerate(hazard.also):
        where = f"{source}: hazard.also[{number}]"
        if isinstance(table, GustHazard):
            _check_gust(table, where, weather_file=weather_file)
        elif isinstance(table, VariableHazard):
            _check_variable(table, where, weather_file=weather_file)
        elif isinstance(table, EnsembleHazard) and table.variable is not None:
            _check_source(table.file, table.variable, where, weather_file=weather_file)
    if sum(isinstance(table, EnsembleHazard) for table in hazard.also) > 1:
        raise ScenarioError(
            f"{source}: hazard.also has several ensembles, whose chances do not add up; keep one of them"
        )


def _check_gust(table: GustHazard, where: str, *, weather_file: bool) -> None:
    if table.factor is not None and (table.file is not None or table.variable is not None):
        raise ScenarioError(
            f"{where} has a gust factor and names a variable of gusts; leave out one of them, or write two "
            "tables"
        )
    if table.factor is None:
        _check_source(table.file, table.variable or "a gust speed", where, weather_file=weather_file)


def _check_variable(table: VariableHazard, where: str, *, weather_file: bool) -> None:
    if table.above is None and table.below is None:
        raise ScenarioError(
            f"{where} says of {table.variable} neither above nor below which value it is hazardous; give one"
        )
    if table.above is not None and table.below is not None and table.below > table.above:
        raise ScenarioError(
            f"{where} makes every value of {table.variable} hazardous, below {table.below} or above "
            f"{table.above}; lower below or raise above"
        )
    _check_source(table.file, table.variable, where, weather_file=weather_file)


def _check_source(file: str | None, variable: str, where: str, *, weather_file: bool) -> None:
    if file is None and not weather_file:
        raise ScenarioError(
            f"{where} looks for {variable} in the weather's file, but the wind is that of a storm; name the "
            'file, such as file = "more.nc"'
        )
