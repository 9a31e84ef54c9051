"""Flyable curves through a plan's waypoints, as the scenario and its aircraft ask for them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from aircraft.jsbsim_aircraft import JsbsimAircraft
from aircraft.loiters import STRONGEST_WIND
from aircraft.reference import PathPoint, Reference
from planner.grid import LocalFrame
from planner.plans import Waypoint
from planner.windfield import WindField
from sim.scenario import Scenario


@dataclass(frozen=True, slots=True)
class PathLayer:
    """Lays references in the plane of the planner's grid. Radii are true metres, airspeed is true."""

    frame: LocalFrame
    departure_s: float
    altitude_m: float
    turn_radius_m: float
    loiter_radius_m: float
    loiter_airspeed_mps: float
    bank_max_rad: float

    @classmethod
    def of(cls, scenario: Scenario, frame: LocalFrame, aircraft: JsbsimAircraft) -> PathLayer:
        """What scenario and aircraft say."""
        table, turns, envelope = scenario.aircraft, aircraft.folder.description.turns, aircraft.envelope
        return cls(
            frame,
            scenario.mission.departure_s,
            scenario.mission.altitude_m,
            table.turn_radius_m or turns.turn_radius_m,
            table.loiter_radius_m or turns.loiter_radius_m,
            envelope.cruise_mps,
            envelope.bank_max_rad,
        )

    def points(self, waypoints: Sequence[Waypoint]) -> list[PathPoint]:
        """The waypoints in the plane."""
        points = []
        for waypoint in waypoints:
            lat_rad, lon_rad = math.radians(waypoint.lat_deg), math.radians(waypoint.lon_deg)
            north_m, east_m = self.frame.to_plane(lat_rad, lon_rad)
            scale = self.frame.scale(lat_rad)
            points.append(PathPoint(north_m, east_m, waypoint.altitude_m, waypoint.time_s, scale))
        return points

    def lap_s(self, waypoint: Waypoint, forecast: WindField) -> float:
        """What a lap of a loiter takes at a waypoint at most [s].

        In a wind of k times the airspeed V the lap takes 4 R E(k) / (V (1 - k^2)), E being the complete
        elliptic integral of the second kind, at most pi / 2.
        """
        lat_rad, lon_rad = math.radians(waypoint.lat_deg), math.radians(waypoint.lon_deg)
        wind = replace(forecast, hold=True).probe()
        north, east, _ = wind(self.departure_s + waypoint.time_s, lat_rad, lon_rad, waypoint.altitude_m)
        share = min(math.hypot(north, east) / self.loiter_airspeed_mps, STRONGEST_WIND)
        return 2.0 * math.pi * self.loiter_radius_m / (self.loiter_airspeed_mps * (1.0 - share**2))

    def through(
        self,
        points: Sequence[PathPoint],
        forecast: WindField,
        *,
        lead_in_s: float = 0.0,
        circling_rad: float | None = None,
    ) -> Reference:
        """The curve through points, timed in a forecast; times count from departure.

        Where the forecast has heights, the wind at a time is that at the altitude of the points then.

        Raises:
            PathError: see `Reference.through`.
        """
        wind = replace(forecast, hold=True).probe()
        times_s, altitudes_m = [point.time_s for point in points], [point.altitude_m for point in points]
        at_levels = forecast.height_m is not None

        def wind_at(north_m: float, east_m: float, time_s: float) -> tuple[float, float]:
            lat_rad, lon_rad = self.frame.to_geodetic(north_m, east_m)
            altitude_m = float(np.interp(time_s, times_s, altitudes_m)) if at_levels else self.altitude_m
            north, east, _ = wind(self.departure_s + time_s, lat_rad, lon_rad, altitude_m)
            return north, east

        return Reference.through(
            points,
            turn_radius_m=self.turn_radius_m,
            loiter_radius_m=self.loiter_radius_m,
            lead_in_s=lead_in_s,
            wind_at=wind_at,
            loiter_airspeed_mps=self.loiter_airspeed_mps,
            bank_max_rad=self.bank_max_rad,
            circling_rad=circling_rad,
        )
