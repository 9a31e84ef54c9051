"""Everything that a flight needs, made from a scenario: aircraft, plan, reference, weather to record."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from aircraft.consumption import measure_consumption
from aircraft.description import load_aircraft
from aircraft.guidance import Guidance
from aircraft.holding import HoldLimits
from aircraft.instruments import GpsInstruments, Instruments, PerfectInstruments
from aircraft.jsbsim_aircraft import JsbsimAircraft, Turbulence
from aircraft.sensors import SensorClass, Sensors
from planner.consumption import FuelFlow
from planner.grid import Grid
from planner.hazards import Bools, strongest_mps
from planner.levels import Climbing
from planner.planning import Place, PlanningRequest, StagedMission, plan_staged
from planner.plans import Plan
from planner.replanning import StagedProspect
from planner.revision import Prospect, Purpose
from planner.score import Weights
from planner.windaware import plan_windaware
from planner.windaware_replanning import WindawareProspect
from planner.windfield import WindField
from recordings.recorder import FlightHeader, Layer, WeatherSheet
from sim.clock import make_clock
from sim.closed_loop import FlightSetup
from sim.errors import ScenarioError
from sim.hazard_text import other_reasons
from sim.holding import Holding, SafePlaces
from sim.level_sheets import level_watch
from sim.path_layer import PathLayer
from sim.provenance import versions
from sim.replanning import Replanner
from sim.scenario import LoadedScenario, PlaceTable, Scenario
from sim.weather.source import MissionWeather

CLIMB_SHARE = 0.7
"""Of the climb and the descent that the aircraft keeps up: what a plan asks for at most."""


def make_aircraft(scenario: Scenario, folder: Path = Path()) -> JsbsimAircraft:
    """The scenario's aircraft, loaded but not yet started; a path to one starts from `folder`.

    Raises:
        ModelError: if there is no such model, or it cannot be flown.
        ScenarioError: if the mission is flown above the model's ceiling.
    """
    aircraft = JsbsimAircraft(
        load_aircraft(scenario.aircraft.model, beside=folder),
        turbulence=Turbulence(scenario.turbulence.kind, scenario.turbulence.severity),
        seed=scenario.seed,
        rate_hz=scenario.flight.simulation_hz,
    )
    ceiling_m, highest_m = aircraft.envelope.ceiling_m, scenario.mission.all_levels_m[-1]
    if highest_m > ceiling_m:
        key = "altitude_m" if highest_m == scenario.mission.altitude_m else "levels_m"
        raise ScenarioError(
            f"mission.{key} {highest_m:.0f} is above the ceiling of {aircraft.model}, "
            f"{ceiling_m:.0f} m; fly lower or with another aircraft"
        )
    return aircraft


def make_instruments(scenario: Scenario) -> Instruments:
    """What guidance sees the flight through."""
    if scenario.flight.sensors == "gps":
        return GpsInstruments(Sensors(SensorClass().read_at(scenario.flight.guidance_hz), scenario.seed))
    return PerfectInstruments()


def make_plan(scenario: Scenario, weather: MissionWeather, aircraft: JsbsimAircraft) -> Plan:
    """Plan on the forecast, within the aircraft's envelope."""
    plan = plan_windaware if scenario.planner.kind == "windaware" else plan_staged
    return plan(planned_on(weather), planning_request(scenario, weather, aircraft))


def planned_on(weather: MissionWeather) -> WindField:
    """The forecast, at all levels if there are several."""
    return weather.forecast if weather.levels is None else weather.levels.forecast


def planning_request(
    scenario: Scenario, weather: MissionWeather, aircraft: JsbsimAircraft
) -> PlanningRequest:
    """What the planner is asked."""
    table, envelope, levels = scenario.planner, aircraft.envelope, weather.levels
    climbing = Climbing(CLIMB_SHARE * envelope.climb_max_mps, CLIMB_SHARE * envelope.descent_max_mps)
    return PlanningRequest(
        start=_place(scenario.mission.start),
        goals=tuple(_place(goal) for goal in scenario.mission.goals),
        goal=scenario.mission.goal,
        altitude_m=scenario.mission.altitude_m,
        clock=make_clock(scenario),
        threshold_mps=scenario.hazard.mean_threshold_mps,
        corridor_m=scenario.hazard.corridor_m,
        airspeed_min_mps=envelope.airspeed_min_mps + table.airspeed_margin_mps,
        airspeed_max_mps=envelope.airspeed_max_mps - table.airspeed_margin_mps,
        objective=table.objective,
        forecast_error_mps=scenario.hazard.forecast_error_mps,
        abstain_below=table.abstain_below,
        cruise_mps=envelope.cruise_mps,
        closures=weather.also.planned if levels is None else levels.closures,
        fuel_flow=_fuel_flow(scenario, aircraft) if table.objective == "fuel" else None,
        weights=Weights(table.alpha, table.beta, table.gamma, table.delta, table.clearance_cap_cells),
        levels_m=scenario.mission.levels_m,
        climbing=climbing if scenario.mission.levels_m else None,
    )


def _fuel_flow(scenario: Scenario, aircraft: JsbsimAircraft) -> FuelFlow:
    """The aircraft's own consumption at the mission's altitude; it takes half a second to measure."""
    measured = measure_consumption(aircraft.folder, scenario.mission.altitude_m)
    return FuelFlow(measured.airspeed_mps, measured.flow_kgps)


def _place(table: PlaceTable) -> Place:
    return Place(table.name, table.lat_deg, table.lon_deg)


def prepare_flight(
    loaded: LoadedScenario, weather: MissionWeather, plan: Plan, aircraft: JsbsimAircraft
) -> FlightSetup:
    """Lay the reference through the plan and put the trimmed aircraft at its beginning.

    Raises:
        ScenarioError: if nothing is known of the wind, the plan leads nowhere, or its chance to survive is
            too small to be flown, or a fault lies behind its end.
        PathError: if no flyable curve leads through the plan.
        ModelError: if the aircraft cannot be trimmed.
    """
    scenario, grid = loaded.scenario, weather.forecast.grid
    if scenario.weather.calm:
        raise ScenarioError(
            "weather.calm says that nothing is known of the wind, so this can be planned and not flown: name "
            "weather with wind components as weather.file"
        )
    if plan.outcome.abstained:
        raise ScenarioError(
            f"the plan to {plan.goal} is not to be flown: its chance to survive, {plan.outcome.survival}, is "
            f"below planner.abstain_below {scenario.planner.abstain_below}"
        )
    if len({(waypoint.lat_deg, waypoint.lon_deg) for waypoint in plan.waypoints}) < 2:
        raise ScenarioError(
            f"mission.start and the goal {plan.goal} lie in one cell of {scenario.grid.cell_m:.0f} m, "
            "so there is nothing to fly; choose another goal or a smaller grid.cell_m"
        )
    _check_faults(scenario, plan)
    layer = PathLayer.of(scenario, grid.frame, aircraft)
    points = layer.points(plan.waypoints)
    reference = layer.through(points, planned_on(weather), lead_in_s=scenario.flight.lead_in_s)
    start = reference.at(0.0)
    lat_rad, lon_rad = grid.frame.to_geodetic(start.north_m, start.east_m)
    envelope = aircraft.envelope
    aircraft.start(
        lat_rad=lat_rad,
        lon_rad=lon_rad,
        altitude_m=start.altitude_m,
        heading_rad=start.course_rad,
        airspeed_mps=min(max(start.speed_mps, envelope.airspeed_min_mps), envelope.airspeed_max_mps),
        time_s=-scenario.flight.lead_in_s,
    )
    header = FlightHeader(
        scenario=scenario.name,
        scenario_toml=loaded.toml,
        seed=scenario.seed,
        grid=grid,
        plan=plan,
        reference=reference,
        threshold_mps=scenario.hazard.mean_threshold_mps,
        stage_s=make_clock(scenario).stage_s,
        airspeed_min_mps=envelope.airspeed_min_mps,
        airspeed_max_mps=envelope.airspeed_max_mps,
        limits=scenario.limits,
        also=other_reasons(scenario.hazard),
        versions=versions() | {"aircraft": f"{aircraft.model} {aircraft.folder.fingerprint()[:12]}"},
    )
    levels = level_watch(scenario, weather)
    if levels is None:
        sheets = weather_sheets(scenario, weather)
        hazard = np.stack([sheet.hazard for sheet in sheets if sheet.layer is Layer.FORECAST])
    else:
        sheets, hazard = (), levels.layers[0].hazard()
    holding = make_holding(scenario, hazard, aircraft, grid)
    replanner = None
    if scenario.planner.replan == "each_stage":
        replanner = _make_replanner(scenario, weather, plan, aircraft, holding.places.hazard)
        sheets = tuple(sheet for sheet in sheets if sheet.layer is Layer.TRUTH or sheet.stage == 0)
    return FlightSetup(
        header=header,
        aircraft=aircraft,
        instruments=make_instruments(scenario),
        guidance=Guidance(reference, envelope, aircraft.folder.gains),
        holding=holding,
        replanner=replanner,
        truth=weather.truth,
        sheets=sheets,
        sample_hz=scenario.flight.sample_hz,
        guidance_hz=scenario.flight.guidance_hz,
        lead_in_s=scenario.flight.lead_in_s,
        off_path_limit_m=scenario.flight.off_path_limit_m,
        late_limit_s=scenario.flight.late_limit_s,
        faults=scenario.faults,
        levels=levels,
    )


def _check_faults(scenario: Scenario, plan: Plan) -> None:
    """Refuse a fault that would strike after the flight; where it is replanned, after the last stage."""
    end_s, end = plan.duration_s, f"the plan to {plan.goal} ends after"
    if scenario.planner.replan == "each_stage":
        clock = make_clock(scenario)
        end_s, end = clock.stage_count * clock.stage_s, "the last stage ends after"
    for number, fault in enumerate(scenario.faults):
        if fault.time_s > end_s:
            raise ScenarioError(
                f"faults[{number}].time_s is {fault.time_s:g}, but {end} {end_s:.0f} s, so "
                f"{fault.kind} would never strike; choose an earlier time"
            )


def _make_replanner(
    scenario: Scenario, weather: MissionWeather, plan: Plan, aircraft: JsbsimAircraft, hazard: Bools
) -> Replanner:
    """Replans at each stage; where no forecasts are issued, that of departure is issued again."""
    return Replanner(
        plan,
        planning_request(scenario, weather, aircraft),
        weather.forecast,
        hazard,
        PathLayer.of(scenario, weather.forecast.grid.frame, aircraft),
        prospect=_windaware if scenario.planner.kind == "windaware" else _staged,
        issued=weather.issued or (lambda _: weather.forecast),
        closures=weather.also.issued,
        if_unreachable=Purpose(scenario.planner.if_unreachable),
    )


def _staged(forecast: WindField, request: PlanningRequest) -> Prospect:
    return StagedProspect(StagedMission.prepare(forecast, request))


def _windaware(forecast: WindField, request: PlanningRequest) -> Prospect:
    return WindawareProspect.of(forecast, request)


def make_holding(scenario: Scenario, hazard: Bools, aircraft: JsbsimAircraft, grid: Grid) -> Holding:
    """Holds on circles that the corridor has room for, where the forecast that was planned on is safe.

    `hazard`: of that, [stage, north, east]; of a flight that changes level, at any of the levels.
    """
    table, turns, envelope = scenario.aircraft, aircraft.folder.description.turns, aircraft.envelope
    limits = HoldLimits(
        radius_min_m=table.turn_radius_m or turns.turn_radius_m,
        radius_max_m=min(table.loiter_radius_m or turns.loiter_radius_m, scenario.hazard.corridor_m / 2.0),
        airspeed_mps=envelope.cruise_mps,
        bank_max_rad=envelope.bank_max_rad,
    )
    return Holding(limits, SafePlaces(grid, make_clock(scenario), hazard))


def weather_sheets(scenario: Scenario, weather: MissionWeather) -> tuple[WeatherSheet, ...]:
    """The weather to record: for each stage the forecast as planned on, then the truth.

    The forecast's hazard has the corridor that the planner keeps free; the truth's is the cells themselves.
    Both have what is hazardous besides the mean wind.
    """
    clock, threshold_mps = make_clock(scenario), scenario.hazard.mean_threshold_mps
    truth = weather.truth.level(scenario.mission.altitude_m, weather.forecast.grid)
    closures = weather.also.planned
    planned = None if closures is None else closures.closed
    layers = (
        (Layer.FORECAST, weather.forecast, scenario.hazard.corridor_m, planned),
        (Layer.TRUTH, truth, 0.0, weather.also.true),
    )
    peaks_mps = {
        layer: strongest_mps(wind, clock, corridor_m=corridor_m) for layer, wind, corridor_m, _ in layers
    }
    return tuple(
        WeatherSheet(
            layer=layer,
            stage=stage,
            time_s=stage * clock.stage_s if stage else -scenario.flight.lead_in_s,
            hazard=_either(peaks_mps[layer][stage] > threshold_mps, closed, stage),
            wind_north_mps=north.astype(np.float32),
            wind_east_mps=east.astype(np.float32),
            peak_mps=peaks_mps[layer][stage].astype(np.float32),
            closed=None if closed is None else closed[stage],
            altitude_m=scenario.mission.altitude_m,
        )
        for stage in range(clock.stage_count)
        for layer, wind, _, closed in layers
        for north, east in [wind.sheet(clock.span_s(stage)[0])]
    )


def _either(hazard: Bools, closed: Bools | None, stage: int) -> Bools:
    return hazard if closed is None else hazard | closed[stage]
