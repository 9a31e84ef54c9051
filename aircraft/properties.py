"""Every JSBSim property that galeway reads or writes, with its unit: the one place where they are named.

JSBSim creates a misspelt property silently when it is set; so all of them are looked up once, when a model is
loaded.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from enum import Enum

from aircraft.errors import ModelError

_FOOT = 0.3048  # metres, exactly
_POUND = 0.45359237  # kilograms, exactly


class Property(Enum):
    """A JSBSim property: SI value = JSBSim value x `to_si`."""

    # initial conditions and the simulation
    START_LATITUDE = "ic/lat-geod-rad", "rad", 1.0, "geodetic latitude to start at"
    START_LONGITUDE = "ic/long-gc-rad", "rad", 1.0, "longitude to start at"
    START_HEIGHT = "ic/h-sl-ft", "ft", _FOOT, "height to start at"
    START_AIRSPEED = "ic/vt-fps", "ft/s", _FOOT, "true airspeed to start with"
    START_HEADING = "ic/psi-true-rad", "rad", 1.0, "true heading to start with"
    START_CLIMB_ANGLE = "ic/gamma-rad", "rad", 1.0, "flight-path angle to start with"
    START_BANK = "ic/phi-rad", "rad", 1.0, "bank to start with"
    START_TERRAIN = "ic/terrain-elevation-ft", "ft", _FOOT, "height of the ground to start above"
    TERRAIN_ELEVATION = "position/terrain-elevation-asl-ft", "ft", _FOOT, "height of the ground"
    RANDOM_SEED = "simulation/randomseed", "1", 1.0, "seed of the turbulence; set once"
    RATE_INTEGRATOR = "simulation/integrator/rate/rotational", "1", 1.0, "3 is Adams-Bashforth 2"

    # wind, toward
    WIND_NORTH = "atmosphere/wind-north-fps", "ft/s", _FOOT, "steady wind"
    WIND_EAST = "atmosphere/wind-east-fps", "ft/s", _FOOT, "steady wind"
    WIND_DOWN = "atmosphere/wind-down-fps", "ft/s", _FOOT, "steady wind"
    GUST_NORTH = "atmosphere/turb-north-fps", "ft/s", _FOOT, "what turbulence adds to the wind"
    GUST_EAST = "atmosphere/turb-east-fps", "ft/s", _FOOT, "what turbulence adds to the wind"
    GUST_DOWN = "atmosphere/turb-down-fps", "ft/s", _FOOT, "what turbulence adds to the wind"
    TURBULENCE_TYPE = "atmosphere/turb-type", "1", 1.0, "0 none, 3 Milspec"
    TURBULENCE_SEVERITY = (
        "atmosphere/turbulence/milspec/severity",
        "1",
        1.0,
        "probability-of-exceedance index, from 2,000 ft up",
    )
    TURBULENCE_WIND_20FT = (
        "atmosphere/turbulence/milspec/windspeed_at_20ft_AGL-fps",
        "ft/s",
        _FOOT,
        "wind near the ground, which sets the turbulence below 1,000 ft",
    )

    # state
    LATITUDE = "position/lat-geod-rad", "rad", 1.0, "geodetic latitude"
    LONGITUDE = "position/long-gc-rad", "rad", 1.0, "longitude"
    ALTITUDE = "position/geod-alt-ft", "ft", _FOOT, "height above the ellipsoid"
    HEIGHT_ABOVE_GROUND = "position/h-agl-ft", "ft", _FOOT, "height above the ground"
    NORTH = "velocities/v-north-fps", "ft/s", _FOOT, "velocity over ground"
    EAST = "velocities/v-east-fps", "ft/s", _FOOT, "velocity over ground"
    DOWN = "velocities/v-down-fps", "ft/s", _FOOT, "velocity over ground"
    ROLL = "attitude/phi-rad", "rad", 1.0, "bank, right wing down"
    PITCH = "attitude/theta-rad", "rad", 1.0, "pitch, nose up"
    HEADING = "attitude/psi-rad", "rad", 1.0, "true heading"
    ROLL_RATE = "velocities/p-rad_sec", "rad/s", 1.0, "body roll rate"
    PITCH_RATE = "velocities/q-rad_sec", "rad/s", 1.0, "body pitch rate"
    YAW_RATE = "velocities/r-rad_sec", "rad/s", 1.0, "body yaw rate"
    AIRSPEED = "velocities/vt-fps", "ft/s", _FOOT, "true airspeed"
    ANGLE_OF_ATTACK = "aero/alpha-rad", "rad", 1.0, "angle of attack"
    SIDESLIP = "aero/beta-rad", "rad", 1.0, "sideslip, wind from the right"
    FUEL = "propulsion/total-fuel-lbs", "lb", _POUND, "fuel left"
    STALL = "aero/alpha-max-rad", "rad", 1.0, "angle of attack at which the wing stalls"
    TANK = "propulsion/tank/contents-lbs", "lb", _POUND, "fuel in the first tank"
    FUEL_FLOW = "propulsion/engine/fuel-flow-rate-pps", "lb/s", _POUND, "what the first engine burns"
    ENGINE_RUNNING = "propulsion/engine/set-running", "1", 1.0, "0 or 1"
    AIR_COMPUTED = "simulation/models/FGAtmosphere/enabled", "1", 1.0, "in every step, or not: 0 or 1"
    MASS_COMPUTED = "simulation/models/FGMassBalance/enabled", "1", 1.0, "in every step, or not: 0 or 1"
    GRAVITY_COMPUTED = "simulation/models/FGInertial/enabled", "1", 1.0, "in every step, or not: 0 or 1"

    # controls, and what trim leaves in them
    AILERON = "fcs/aileron-servo", "1", 1.0, "aileron, right roll, of full deflection"
    ELEVATOR = "fcs/elevator-servo", "1", 1.0, "elevator, nose down, of full deflection"
    RUDDER = "fcs/rudder-servo", "1", 1.0, "rudder, nose left, of full deflection"
    THROTTLE = "fcs/throttle-pos-norm", "1", 1.0, "throttle, 0 to 1"
    AILERON_STICK = "fcs/aileron-cmd-norm", "1", 1.0, "pilot's aileron"
    ELEVATOR_STICK = "fcs/elevator-cmd-norm", "1", 1.0, "pilot's elevator"
    RUDDER_STICK = "fcs/rudder-cmd-norm", "1", 1.0, "pilot's rudder"
    THROTTLE_STICK = "fcs/throttle-cmd-norm", "1", 1.0, "pilot's throttle"
    PITCH_TRIM = "fcs/pitch-trim-cmd-norm", "1", 1.0, "pilot's pitch trim"

    # the model's own autopilot
    AUTOPILOT_ENGAGED = "ap/engaged", "1", 1.0, "0 or 1"
    ROLL_COMMAND = "ap/roll-command-rad", "rad", 1.0, "bank"
    AIRSPEED_COMMAND = "ap/airspeed-command-fps", "ft/s", _FOOT, "true airspeed"
    ALTITUDE_COMMAND = "ap/altitude-command-ft", "ft", _FOOT, "height above the ellipsoid"
    CLIMB_COMMAND = "ap/climb-command-fps", "ft/s", _FOOT, "feed-forward of vertical speed, up"

    def __init__(self, path: str, unit: str, to_si: float, meaning: str) -> None:
        self.path = path
        self.unit = unit
        self.to_si = to_si
        self.meaning = meaning

    def path_at(self, index: int) -> str:
        """The path of the same property of another tank or engine."""
        return re.sub(r"/(tank|engine)/", rf"/\1[{index}]/", self.path)


def check_properties(
    model: str, exists: Callable[[str], bool], path_of: Callable[[Property], str] = lambda member: member.path
) -> None:
    """Look every property up in a loaded model; `path_of` gives what the model calls it.

    Raises:
        ModelError: if the model lacks any; the message names them.
    """
    paths = [path_of(member) for member in Property]
    missing = [path for path in paths if not exists(path)]
    if missing:
        raise ModelError(
            f"the model {model!r} lacks {len(missing)} of the {len(Property)} properties in use: "
            f"{', '.join(missing)}; give it an autopilot and controls like those of 'aerosonde', "
            "or name its own under [properties] (docs/aircraft.md)"
        )
