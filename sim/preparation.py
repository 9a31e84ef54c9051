"""Everything that a flight needs, made from a scenario: aircraft, plan, reference, weather to record."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from aircraft.consumption import measure_consumption
from aircraft.description import load_aircraft
from aircraft.guidance import Guidance
from aircraft.instruments import GpsInstruments, Instruments, PerfectInstruments
from aircraft.jsbsim_aircraft import JsbsimAircraft, Turbulence
from aircraft.reference import PathPoint, Reference
from aircraft.sensors import SensorClass, Sensors
from planner.consumption import FuelFlow
from planner.hazards import StageClock, hazard_stages
from planner.planning import Place, PlanningRequest, plan_staged
from planner.plans import Plan
from planner.score import Weights
from planner.windaware import plan_windaware
from recordings.recorder import FlightHeader, Layer, WeatherSheet
from sim.closed_loop import FlightSetup
from sim.errors import ScenarioError
from sim.provenance import versions
from sim.scenario import LoadedScenario, PlaceTable, Scenario
from sim.weather.source import MissionWeather


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
    ceiling_m, altitude_m = aircraft.envelope.ceiling_m, scenario.mission.altitude_m
    if altitude_m > ceiling_m:
        raise ScenarioError(
            f"mission.altitude_m {altitude_m:.0f} is above the ceiling of {aircraft.model}, "
            f"{ceiling_m:.0f} m; fly lower or with another aircraft"
        )
    return aircraft


def make_instruments(scenario: Scenario) -> Instruments:
    """What guidance sees the flight through."""
    if scenario.flight.sensors == "gps":
        return GpsInstruments(Sensors(SensorClass().read_at(scenario.flight.guidance_hz), scenario.seed))
    return PerfectInstruments()


def make_clock(scenario: Scenario) -> StageClock:
    """The planner's clock."""
    stages = scenario.stages
    return StageClock(scenario.mission.departure_s, stages.count, stages.steps, stages.step_s)


def make_plan(scenario: Scenario, weather: MissionWeather, aircraft: JsbsimAircraft) -> Plan:
    """Plan on the forecast, within the aircraft's envelope."""
    plan = plan_windaware if scenario.planner.kind == "windaware" else plan_staged
    return plan(weather.forecast, planning_request(scenario, aircraft))


def planning_request(scenario: Scenario, aircraft: JsbsimAircraft) -> PlanningRequest:
    """What the planner is asked."""
    table, envelope = scenario.planner, aircraft.envelope
    return PlanningRequest(
        start=_place(scenario.mission.start),
        goals=tuple(_place(goal) for goal in scenario.mission.goals),
        goal=scenario.mission.goal,
        altitude_m=scenario.mission.altitude_m,
        clock=make_clock(scenario),
        threshold_mps=scenario.hazard.threshold_mps,
        corridor_m=scenario.hazard.corridor_m,
        airspeed_min_mps=envelope.airspeed_min_mps + table.airspeed_margin_mps,
        airspeed_max_mps=envelope.airspeed_max_mps - table.airspeed_margin_mps,
        objective=table.objective,
        forecast_error_mps=scenario.hazard.forecast_error_mps,
        abstain_below=table.abstain_below,
        cruise_mps=envelope.cruise_mps,
        fuel_flow=_fuel_flow(scenario, aircraft) if table.objective == "fuel" else None,
        weights=Weights(table.alpha, table.beta, table.gamma, table.delta, table.clearance_cap_cells),
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
        ScenarioError: if the plan leads nowhere, or its chance to survive is too small to be flown.
        PathError: if no flyable curve leads through the plan.
        ModelError: if the aircraft cannot be trimmed.
    """
    scenario, grid = loaded.scenario, weather.forecast.grid
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
    reference = lay_reference(scenario, weather, plan, aircraft)
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
        threshold_mps=scenario.hazard.threshold_mps,
        stage_s=make_clock(scenario).stage_s,
        airspeed_min_mps=envelope.airspeed_min_mps,
        airspeed_max_mps=envelope.airspeed_max_mps,
        limits=scenario.limits,
        versions=versions() | {"aircraft": f"{aircraft.model} {aircraft.folder.fingerprint()[:12]}"},
    )
    return FlightSetup(
        header=header,
        aircraft=aircraft,
        instruments=make_instruments(scenario),
        guidance=Guidance(reference, envelope, aircraft.folder.gains),
        truth=weather.truth,
        sheets=weather_sheets(scenario, weather),
        guidance_hz=scenario.flight.guidance_hz,
        lead_in_s=scenario.flight.lead_in_s,
        off_path_limit_m=scenario.flight.off_path_limit_m,
        faults=scenario.faults,
    )


def lay_reference(
    scenario: Scenario, weather: MissionWeather, plan: Plan, aircraft: JsbsimAircraft
) -> Reference:
    """The flyable curve through a plan's waypoints, in the plane of the planner's grid."""
    frame, wind = weather.forecast.grid.frame, replace(weather.forecast, hold=True).probe()

    def wind_at(north_m: float, east_m: float, time_s: float) -> tuple[float, float]:
        lat_rad, lon_rad = frame.to_geodetic(north_m, east_m)
        north, east, _ = wind(plan.departure_s + time_s, lat_rad, lon_rad, scenario.mission.altitude_m)
        return north, east

    points = []
    for waypoint in plan.waypoints:
        lat_rad, lon_rad = math.radians(waypoint.lat_deg), math.radians(waypoint.lon_deg)
        north_m, east_m = frame.to_plane(lat_rad, lon_rad)
        scale = frame.scale(lat_rad)
        points.append(PathPoint(north_m, east_m, waypoint.altitude_m, waypoint.time_s, scale))
    table, turns = scenario.aircraft, aircraft.folder.description.turns
    return Reference.through(
        points,
        turn_radius_m=table.turn_radius_m or turns.turn_radius_m,
        loiter_radius_m=table.loiter_radius_m or turns.loiter_radius_m,
        lead_in_s=scenario.flight.lead_in_s,
        wind_at=wind_at,
        loiter_airspeed_mps=aircraft.envelope.cruise_mps,
        bank_max_rad=aircraft.envelope.bank_max_rad,
    )


def weather_sheets(scenario: Scenario, weather: MissionWeather) -> tuple[WeatherSheet, ...]:
    """The weather to record: for each stage the forecast as planned on, then the truth.

    The forecast's hazard has the corridor that the planner keeps free; the truth's is the cells themselves.
    """
    clock, threshold_mps = make_clock(scenario), scenario.hazard.threshold_mps
    truth = weather.truth.at_altitude(scenario.mission.altitude_m).resampled(weather.forecast.grid)
    layers = (
        (Layer.FORECAST, weather.forecast, scenario.hazard.corridor_m),
        (Layer.TRUTH, truth, 0.0),
    )
    hazards = {
        layer: hazard_stages(wind, clock, threshold_mps=threshold_mps, corridor_m=corridor_m)
        for layer, wind, corridor_m in layers
    }
    return tuple(
        WeatherSheet(
            layer=layer,
            stage=stage,
            time_s=stage * clock.stage_s if stage else -scenario.flight.lead_in_s,
            hazard=hazards[layer][stage],
            wind_north_mps=north.astype(np.float32),
            wind_east_mps=east.astype(np.float32),
        )
        for stage in range(clock.stage_count)
        for layer, wind, _ in layers
        for north, east in [wind.sheet(clock.span_s(stage)[0])]
    )
