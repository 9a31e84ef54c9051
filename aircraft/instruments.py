"""Between the aircraft and its guidance: what guidance sees of the flight, and what its commands become.

Perfect instruments show the truth. Those of a real aircraft show what sensors and estimators make of it; and
its inner loops, which here are JSBSim's and hold true bank, airspeed, altitude and climb, would hold the
measured ones. So each command is shifted by truth minus what is seen:

    truth  =  command + (truth - seen)    is reached where    seen  =  command

That is done here alone, at guidance's rate; between two rounds the inner loops see the truth's changes.
"""

from __future__ import annotations

from typing import Protocol

from aircraft.estimator import Estimator
from aircraft.sensors import Sensors
from aircraft.state import Command, FlightState
from aircraft.wind_estimator import WindEstimator


class Instruments(Protocol):
    """What guidance sees through, and acts through."""

    def see(self, truth: FlightState) -> FlightState:
        """The flight as guidance sees it; its wind is the steady wind, toward."""

    def shift(self, command: Command, truth: FlightState, seen: FlightState) -> Command:
        """What the inner loops, which hold true values, have to be told."""


class PerfectInstruments:
    """The truth, at no cost."""

    def see(self, truth: FlightState) -> FlightState:
        """The truth."""
        return truth

    def shift(self, command: Command, truth: FlightState, seen: FlightState) -> Command:  # noqa: ARG002
        """The command."""
        return command


class GpsInstruments:
    """Sensors of one class, with estimators that know its figures.

    Until the first fix, some tenths of a second, the truth is seen: no flight begins with switching on.
    Seen are position, velocity, attitude, airspeed (calibrated by the estimator) and wind; angular rates,
    control surfaces and fuel are as they are.
    """

    def __init__(self, sensors: Sensors) -> None:
        self._sensors = sensors
        self._estimator = Estimator(sensors.figures)
        self._wind = WindEstimator(sensors.figures)

    def see(self, truth: FlightState) -> FlightState:
        """What sensors and estimators make of the truth."""
        readings = self._sensors.read(truth)
        motion = self._estimator.update(readings)
        if motion is None:
            return truth
        wind = self._wind.update(readings, motion)
        return truth._replace(
            lat_rad=motion.lat_rad,
            lon_rad=motion.lon_rad,
            altitude_m=motion.altitude_m,
            north_mps=motion.north_mps,
            east_mps=motion.east_mps,
            down_mps=motion.down_mps,
            roll_rad=readings.roll_rad,
            pitch_rad=readings.pitch_rad,
            heading_rad=readings.heading_rad,
            airspeed_mps=readings.airspeed_mps * wind.airspeed_factor,
            wind_north_mps=wind.north_mps,
            wind_east_mps=wind.east_mps,
            wind_down_mps=0.0,
            gust_north_mps=0.0,
            gust_east_mps=0.0,
            gust_down_mps=0.0,
        )

    def shift(self, command: Command, truth: FlightState, seen: FlightState) -> Command:
        """The command that makes the inner loops hold what is measured."""
        return command._replace(
            roll_rad=command.roll_rad + truth.roll_rad - seen.roll_rad,
            airspeed_mps=command.airspeed_mps + truth.airspeed_mps - seen.airspeed_mps,
            altitude_m=command.altitude_m + truth.altitude_m - seen.altitude_m,
            climb_mps=command.climb_mps - truth.down_mps + seen.down_mps,
        )
