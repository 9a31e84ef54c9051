"""The scenario: one typed, frozen object from a TOML file, with values overridden from the command line."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any, Literal

from msgspec import Meta, Struct

from aircraft.mistakes import nearest
from aircraft.tables import TableError, convert, read_toml
from sim.errors import ScenarioError
from sim.hazard_tables import Hazard, check_hazard
from sim.level_checks import check_levels, check_sounding
from sim.overrides import put
from sim.weather_tables import Weather

BUILT_IN_FOLDER = Path(__file__).parent / "scenarios"

Positive = Annotated[float, Meta(gt=0.0)]
NotNegative = Annotated[float, Meta(ge=0.0)]
Chance = Annotated[float, Meta(ge=0.0, le=1.0)]
Count = Annotated[int, Meta(ge=1)]
FileName = Annotated[
    str,
    Meta(
        pattern="^[A-Za-z0-9][A-Za-z0-9_.-]*$",
        description='letters, digits, "_", "." and "-" alone, a letter or a digit first',
    ),
]
Altitude = Annotated[float, Meta(ge=50.0, le=6000.0)]
Latitude = Annotated[float, Meta(ge=-80.0, le=80.0)]
Longitude = Annotated[float, Meta(ge=-180.0, le=360.0)]


class PlaceTable(Struct, frozen=True):
    """A named position [deg]."""

    name: str
    lat_deg: Latitude
    lon_deg: Longitude


class Mission(Struct, frozen=True):
    """Where from, where to, when and how high.

    `goals` are all planned in the same sweep; `goal` names the one that is flown. Flights begin and end at
    `altitude_m`; between, the wind-aware planner may change to one of `levels_m`.
    """

    departure: datetime
    start: PlaceTable
    goals: Annotated[tuple[PlaceTable, ...], Meta(min_length=1)]
    goal: str
    altitude_m: Altitude = 1000.0
    levels_m: Annotated[tuple[Altitude, ...], Meta(max_length=8)] = ()

    @property
    def all_levels_m(self) -> tuple[float, ...]:
        """The flight's altitude and the levels that the planner may change to, rising."""
        return tuple(sorted({self.altitude_m, *self.levels_m}))

    @property
    def departure_s(self) -> float:
        """Departure, seconds since 1970-01-01 UTC; a time without an offset is UTC."""
        departure = self.departure
        return (departure if departure.tzinfo else departure.replace(tzinfo=UTC)).timestamp()


class GridTable(Struct, frozen=True):
    """Cell size of the planner's grid and its area; without an area, that of the weather file."""

    cell_m: Annotated[float, Meta(ge=100.0, le=50_000.0)] = 3600.0
    south_deg: Latitude | None = None
    north_deg: Latitude | None = None
    west_deg: Longitude | None = None
    east_deg: Longitude | None = None


class Stages(Struct, frozen=True):
    """The planner's clock: a stage of weather holds `steps` steps of `step_s`; one step moves one cell."""

    count: Annotated[int, Meta(ge=1, le=240)] = 18
    steps: Annotated[int, Meta(ge=1, le=1000)] = 30
    step_s: Positive = 120.0


class PlannerTable(Struct, frozen=True):
    """Which planner, which of a goal's arrivals, and the weights of the score (equation 2 of the paper).

    `staged` is the paper's; `windaware` flies legs of any course at cruise airspeed, and
    for fuel at others. `airspeed_margin_mps` is what the planner leaves of the aircraft's envelope at
    either end, so that the flight can make up for gusts and corners. A plan whose chance to survive lies
    below `abstain_below` is shown but not flown. With `replan` the planner runs again in flight,
    at the forecast of each stage; `if_unreachable` is what it tries first where no route to the goal is left.
    """

    kind: Literal["staged", "windaware"] = "staged"
    objective: Literal["earliest", "score", "survival", "fuel"] = "score"
    alpha: NotNegative = 1.0
    beta: NotNegative = 1.0
    gamma: NotNegative = 0.1
    delta: NotNegative = 0.1
    clearance_cap_cells: NotNegative = 30.0
    airspeed_margin_mps: NotNegative = 2.0
    abstain_below: Chance = 0.0
    replan: Literal["never", "each_stage"] = "never"
    if_unreachable: Literal["alternate", "wait", "return"] = "wait"


class AircraftTable(Struct, frozen=True):
    """Which aircraft (a built-in name, or the path of a folder), and the radii of its turns and loiters.

    Radii are over ground; without them, the model's own.
    """

    model: str = "aerosonde"
    turn_radius_m: Positive | None = None
    loiter_radius_m: Positive | None = None


class TurbulenceTable(Struct, frozen=True):
    """Turbulence: none, or MIL-F-8785C with JSBSim's severity index (3 light, 4 moderate, 5 to 7 severe)."""

    kind: Literal["none", "milspec"] = "milspec"
    severity: Annotated[int, Meta(ge=0, le=7)] = 3


class Flight(Struct, frozen=True):
    """How the flight is simulated and when it is given up.

    The aircraft flies a straight lead-in of `lead_in_s` before the first waypoint, on which wind and
    turbulence are brought in. It cannot follow when it is further than `off_path_limit_m` from the reference,
    unless a wind above its airspeed blew it there: then it goes on, and returns when the wind allows. It is
    given up for good when it is `late_limit_s` behind the end of its reference. Guidance sees the truth, or
    what `sensors` and estimators make of it.
    """

    simulation_hz: Annotated[int, Meta(ge=30, le=480)] = 60
    guidance_hz: Annotated[int, Meta(ge=1, le=60)] = 5
    sample_hz: Annotated[int, Meta(ge=1, le=60)] = 10
    lead_in_s: Annotated[float, Meta(ge=20.0, le=600.0)] = 60.0
    off_path_limit_m: Positive = 500.0
    late_limit_s: Positive = 3600.0
    sensors: Literal["perfect", "gps"] = "perfect"


class FaultKind(StrEnum):
    """What can be made to go wrong in flight."""

    ENGINE_FAILURE = "engine_failure"
    FUEL_LOSS = "fuel_loss"
    WIND_STEP = "wind_step"
    WIND_NAN = "wind_nan"
    STATE_NAN = "state_nan"


class Fault(Struct, frozen=True):
    """Something that goes wrong at a time after departure, for good.

    `fuel_kg` is what a loss of fuel leaves; the rest is of a wind step: by how much the wind changes (toward)
    within `duration_s`. The two kinds of "nan" put what is not a number into the wind or into the aircraft's
    mass, to see the flight end in good order.
    """

    kind: FaultKind
    time_s: NotNegative
    fuel_kg: NotNegative = 0.0
    north_mps: float = 0.0
    east_mps: float = 0.0
    duration_s: Positive = 1.0


class Scenario(Struct, frozen=True):
    """One flight, whole: everything that decides it stands here."""

    name: FileName
    mission: Mission
    weather: Weather
    description: str = ""
    seed: Annotated[int, Meta(ge=0, le=2**31 - 1)] = 1
    limits: tuple[str, ...] = ()
    grid: GridTable = GridTable()
    stages: Stages = Stages()
    hazard: Hazard = Hazard()
    planner: PlannerTable = PlannerTable()
    aircraft: AircraftTable = AircraftTable()
    turbulence: TurbulenceTable = TurbulenceTable()
    flight: Flight = Flight()
    faults: tuple[Fault, ...] = ()


@dataclass(frozen=True, slots=True)
class LoadedScenario:
    """A scenario with the text that it was read from (overrides on top, as comments) and its folder."""

    scenario: Scenario
    toml: str
    folder: Path


def built_in_names() -> list[str]:
    """Names of the scenarios that ship with galeway."""
    return sorted(path.stem for path in BUILT_IN_FOLDER.glob("*.toml"))


def load_scenario(name_or_path: str, overrides: Sequence[str] = ()) -> LoadedScenario:
    """Read a scenario by its built-in name or its path.

    Args:
        name_or_path: for example "ian" or "missions/my.toml".
        overrides: "table.key=value", the value in TOML or a bare word; checked like the file.

    Raises:
        ScenarioError: if there is no such scenario, or anything in it or in an override is wrong.
    """
    text, path = scenario_text(name_or_path)
    return scenario_of(text, str(path), path.parent, overrides)


def scenario_text(name_or_path: str) -> tuple[str, Path]:
    """A scenario's text, of which no more is known than that it is TOML, and its file.

    Raises:
        ScenarioError: if there is no such scenario, or it cannot be read.
    """
    path = _find(name_or_path)
    try:
        return read_toml(path)[1], path
    except TableError as error:
        raise ScenarioError(str(error)) from error


def scenario_of(toml: str, source: str, folder: Path, overrides: Sequence[str] = ()) -> LoadedScenario:
    """The scenario of a text that was read from a file before.

    Args:
        toml: the text, known to be TOML.
        source: the file, for messages.
        folder: what its relative paths start from.
        overrides: see `load_scenario`.

    Raises:
        ScenarioError: if anything in it or in an override is wrong.
    """
    tables = tomllib.loads(toml)
    for override in overrides:
        put(tables, override)
    notes = "".join(f"# --set {override}\n" for override in overrides)
    return LoadedScenario(parse_scenario(tables, source), notes + toml, folder)


def parse_scenario(tables: dict[str, Any], source: str) -> Scenario:
    """Check tables as TOML gives them and make a scenario of them.

    Raises:
        ScenarioError: naming the key, the value or limit, and the nearest valid key if it is unknown.
    """
    try:
        scenario = convert(tables, Scenario, source)
    except TableError as error:
        raise ScenarioError(str(error)) from error
    _check_together(scenario, source)
    return scenario


def _find(name_or_path: str) -> Path:
    built_in = BUILT_IN_FOLDER / f"{name_or_path}.toml"
    if name_or_path in built_in_names():
        return built_in
    path = Path(name_or_path)
    if path.is_file():
        return path
    if path.is_dir():
        raise ScenarioError(f"no scenario {name_or_path!r}: it is a folder; name a TOML file in it")
    raise ScenarioError(
        f"no scenario {name_or_path!r}: neither a file nor one of {', '.join(built_in_names())}"
        f"{nearest(name_or_path, built_in_names())}"
    )


def _check_together(scenario: Scenario, source: str) -> None:
    """What no key can be checked for alone."""
    mission, grid, weather = scenario.mission, scenario.grid, scenario.weather
    names = [goal.name for goal in mission.goals]
    if mission.goal not in names:
        raise ScenarioError(
            f"{source}: mission.goal {mission.goal!r} is not among the goals {', '.join(names)}"
            f"{nearest(mission.goal, names)}"
        )
    if len(set(names)) < len(names):
        raise ScenarioError(f"{source}: two of mission.goals have one name; name each once")
    if (weather.storm is not None or weather.file is not None) + weather.calm + bool(weather.sounding) != 1:
        raise ScenarioError(
            f'{source}: [weather] needs storm = "AL092022" or file = "wind.nc" (or, to plan without wind, '
            "calm = true alone; or a sounding alone)"
        )
    check_sounding(weather, source)
    if weather.error.members and weather.error.kind == "none":
        raise ScenarioError(
            f"{source}: weather.error.members is {weather.error.members}, but forecasts do not err; set "
            'weather.error.kind = "growing", or leave members out'
        )
    if weather.truth.file is not None and (weather.file is None or weather.storm is not None):
        raise ScenarioError(f"{source}: weather.truth.file needs a forecast from weather.file, too")
    if weather.truth.file is not None and weather.error.kind != "none":
        raise ScenarioError(
            f"{source}: weather.truth.file says what the forecast gets wrong, and weather.error.kind "
            f"{weather.error.kind!r} too; leave one of them out"
        )
    missing = sum(bound is None for bound in (grid.south_deg, grid.north_deg, grid.west_deg, grid.east_deg))
    if missing and (weather.storm or weather.calm or weather.sounding or missing < 4):
        raise ScenarioError(f"{source}: [grid] needs all of south_deg, north_deg, west_deg, east_deg")
    if grid.south_deg is not None and grid.north_deg is not None and not grid.south_deg < grid.north_deg:
        raise ScenarioError(
            f"{source}: grid.south_deg {grid.south_deg} is not south of north_deg {grid.north_deg}"
        )
    check_hazard(scenario.hazard, source, weather_file=weather.file is not None and weather.storm is None)
    _check_objective(scenario, source)
    check_levels(mission, weather, scenario.planner, source)
    flight = scenario.flight
    for fast, slow in (("simulation_hz", "sample_hz"), ("sample_hz", "guidance_hz")):
        if getattr(flight, fast) % getattr(flight, slow):
            raise ScenarioError(
                f"{source}: flight.{fast} {getattr(flight, fast)} is no multiple of "
                f"{slow} {getattr(flight, slow)}"
            )


def _check_objective(scenario: Scenario, source: str) -> None:
    table = scenario.planner
    if table.objective == "fuel" and table.kind == "staged":
        raise ScenarioError(
            f"{source}: planner.objective 'fuel' is not one of the staged planner, whose airspeed is what "
            'the step asks for; choose earliest, score or survival, or planner.kind = "windaware"'
        )
    if scenario.hazard.tells_chance:
        return
    remedy = "a chance to survive needs hazard.forecast_error_mps above 0, such as 3.0, or an ensemble"
    if table.objective == "survival":
        raise ScenarioError(f"{source}: planner.objective is 'survival', but {remedy}")
    if table.abstain_below > 0.0:
        raise ScenarioError(f"{source}: planner.abstain_below is {table.abstain_below}, but {remedy}")
