"""The aircraft as JSBSim flies it, in SI units: feet and pounds end here."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from aircraft.description import AircraftFolder, load_aircraft
from aircraft.envelope import Envelope
from aircraft.errors import ModelError
from aircraft.jsbsim_model import JsbsimModel
from aircraft.own_models import envelope_of
from aircraft.properties import Property
from aircraft.state import Command, FlightState
from aircraft.turbulence import Turbulence

__all__ = ["Envelope", "JsbsimAircraft", "Turbulence"]

_ADAMS_BASHFORTH_2 = 3.0  # the default, explicit Euler, takes the damping out of the short period at 60 Hz
_MILSPEC = 3.0
_WRECK_HEIGHT_FT = 3.0  # of the centre of gravity; whatever hits the ground first, it is no higher then
IDLE_IN_FLIGHT = ("FGGroundReactions", "FGInput", "FGOutput")
"""Parts of JSBSim that do nothing in the air; left in, they take a twentieth of every step."""

SLOW_PARTS = (Property.AIR_COMPUTED, Property.MASS_COMPUTED, Property.GRAVITY_COMPUTED)
SLOW_EVERY = 6
"""Steps from one computation of the slow parts to the next: the air's density changes by 0.006 % at most in
half a metre of height, the mass by a millionth, the direction of gravity by less than that."""

_ENGINE_OFF = (("propulsion/magneto_cmd", 0.0), ("propulsion/cutoff_cmd", 1.0))
_M_PER_FOOT = 0.3048
_FEET_PER_M = 1.0 / _M_PER_FOOT

# the fields of FlightState between its time and its height above ground, in their order
_STATE = (
    Property.LATITUDE,
    Property.LONGITUDE,
    Property.ALTITUDE,
    Property.NORTH,
    Property.EAST,
    Property.DOWN,
    Property.ROLL,
    Property.PITCH,
    Property.HEADING,
    Property.ROLL_RATE,
    Property.PITCH_RATE,
    Property.YAW_RATE,
    Property.AIRSPEED,
    Property.ANGLE_OF_ATTACK,
    Property.SIDESLIP,
    Property.WIND_NORTH,
    Property.WIND_EAST,
    Property.WIND_DOWN,
    Property.GUST_NORTH,
    Property.GUST_EAST,
    Property.GUST_DOWN,
    Property.AILERON,
    Property.ELEVATOR,
    Property.RUDDER,
    Property.THROTTLE,
    Property.FUEL,
)


class JsbsimAircraft:
    """A model with its autopilot, stepped at a fixed rate.

    Positions are geodetic (WGS84), altitude is height above the ellipsoid, the ground is at zero height.
    The same seed gives bit-identical flights.
    """

    def __init__(
        self,
        model: str | AircraftFolder,
        *,
        turbulence: Turbulence,
        seed: int,
        rate_hz: float = 60.0,
        envelope: Envelope | None = None,
    ) -> None:
        """Load the model.

        Args:
            model: a built-in name, the path of a folder, or what was read from one.
            turbulence: how rough the air is.
            seed: of the turbulence.
            rate_hz: steps a second.
            envelope: the model's, where it is known already; otherwise `envelope_of` is asked.

        Raises:
            ModelError: if there is no such model, JSBSim cannot load it, it lacks a property in use, or
                cannot fly its cruise.
        """
        self.folder = model if isinstance(model, AircraftFolder) else load_aircraft(model)
        self.model = self.folder.name
        self.envelope = envelope or envelope_of(self.folder)
        self.rate_hz = rate_hz
        self._turbulence = turbulence
        self._seed = 1 + seed % (2**31 - 2)  # what JSBSim's generator tells apart
        self._start_time_s = 0.0
        self._steps = 0
        self._to_slow = 0  # steps until the slow parts are computed again
        self._load()

    def _load(self) -> None:
        self._model = JsbsimModel(self.folder, self.rate_hz)
        self._fdm = self._model.fdm
        self._bind()

    def _bind(self) -> None:
        """Look up, once, what is called in flight."""
        self._run = self._fdm.run
        self._lat_rad = self._node(Property.LATITUDE).get_double_value
        self._lon_rad = self._node(Property.LONGITUDE).get_double_value
        self._altitude_ft = self._node(Property.ALTITUDE).get_double_value
        self._airspeed_fps = self._node(Property.AIRSPEED).get_double_value
        self._engine_running = self._node(Property.ENGINE_RUNNING).get_double_value
        self._set_north_fps = self._node(Property.WIND_NORTH).set_double_value
        self._set_east_fps = self._node(Property.WIND_EAST).set_double_value
        self._set_down_fps = self._node(Property.WIND_DOWN).set_double_value
        self._set_roll_rad = self._node(Property.ROLL_COMMAND).set_double_value
        self._set_airspeed_fps = self._node(Property.AIRSPEED_COMMAND).set_double_value
        self._set_altitude_ft = self._node(Property.ALTITUDE_COMMAND).set_double_value
        self._set_climb_fps = self._node(Property.CLIMB_COMMAND).set_double_value
        self._set_slow_computed = [self._node(member).set_double_value for member in SLOW_PARTS]
        self._read_state = _state_reader([self._node(member) for member in _STATE])

    def _node(self, member: Property) -> Any:
        return self._model.node(member)

    def get(self, member: Property) -> float:
        """A property's value now, SI."""
        return self._model.get(member)

    def set(self, member: Property, value: float) -> None:
        """Set a property, SI."""
        self._model.set(member, value)

    def start(
        self,
        *,
        lat_rad: float,
        lon_rad: float,
        altitude_m: float,
        heading_rad: float,
        airspeed_mps: float,
        time_s: float,
    ) -> None:
        """Trim for level flight in still air and engage the autopilot, which then holds this flight.

        Calling it again starts over with full tanks and the same seed. Bring the wind in over some
        seconds: a wind that is there at once is a gust.

        Raises:
            ModelError: if the model cannot fly level at this airspeed and altitude.
        """
        if self._steps:
            self._load()  # a flown JSBSim object keeps filter, tank and random states: take a new one
        for member, value in (
            (Property.START_LATITUDE, lat_rad),
            (Property.START_LONGITUDE, lon_rad),
            (Property.START_HEIGHT, altitude_m),
            (Property.START_AIRSPEED, airspeed_mps),
            (Property.START_CLIMB_ANGLE, 0.0),
            (Property.START_HEADING, heading_rad % (2.0 * math.pi)),
            (Property.TERRAIN_ELEVATION, 0.0),
            (Property.RANDOM_SEED, self._seed),
        ):
            self.set(member, value)
        self.command(Command(0.0, airspeed_mps, altitude_m))
        self._trim(airspeed_mps, altitude_m)
        self.set(Property.RATE_INTEGRATOR, _ADAMS_BASHFORTH_2)
        self._engage_autopilot()
        for part in IDLE_IN_FLIGHT:
            self.enable(part, False)
        if self._turbulence.kind == "milspec":
            self.set(Property.TURBULENCE_TYPE, _MILSPEC)
            self.set(Property.TURBULENCE_SEVERITY, self._turbulence.severity)
            self.set(Property.TURBULENCE_WIND_20FT, self._turbulence.wind_at_20ft_mps)
        self._start_time_s = time_s
        self._steps = self._to_slow = 0

    def _trim(self, airspeed_mps: float, altitude_m: float) -> None:
        if not self._model.trim():
            limits = self.envelope
            raise ModelError(
                f"{self.model!r} cannot fly level at {airspeed_mps:.1f} m/s and {altitude_m:.0f} m; "
                f"start between {limits.airspeed_min_mps:.0f} and {limits.airspeed_max_mps:.0f} m/s, "
                f"no higher than {limits.ceiling_m:.0f} m"
            )

    def enable(self, part: str, enabled: bool) -> None:
        """Have JSBSim run one of its parts, such as "FGGroundReactions", in every step, or not."""
        self._fdm.set_property_value(f"simulation/models/{part}/enabled", float(enabled))

    def _engage_autopilot(self) -> None:
        """Hand over from the trimmed controls; the autopilot's feed-forward knows them well enough."""
        for member in (
            Property.AILERON_STICK,
            Property.ELEVATOR_STICK,
            Property.RUDDER_STICK,
            Property.THROTTLE_STICK,
            Property.PITCH_TRIM,
        ):
            self.set(member, 0.0)
        self.set(Property.AUTOPILOT_ENGAGED, 1.0)

    def command(self, command: Command) -> None:
        """Tell the autopilot what to fly from the next step on."""
        roll_rad, airspeed_mps, altitude_m, climb_mps = command
        self._set_roll_rad(roll_rad)
        self._set_airspeed_fps(airspeed_mps * _FEET_PER_M)
        self._set_altitude_ft(altitude_m * _FEET_PER_M)
        self._set_climb_fps(climb_mps * _FEET_PER_M)

    def set_wind(self, north_mps: float, east_mps: float, down_mps: float) -> None:
        """The steady wind from the next step on, toward."""
        self._set_north_fps(north_mps * _FEET_PER_M)
        self._set_east_fps(east_mps * _FEET_PER_M)
        self._set_down_fps(down_mps * _FEET_PER_M)

    def step(self, count: int = 1) -> None:
        """Fly on by `count` / `rate_hz`."""
        run, left = self._run, count
        while left > 0:
            if self._to_slow == 0:
                for compute in self._set_slow_computed:
                    compute(1.0)
                run()
                for compute in self._set_slow_computed:
                    compute(0.0)
                self._to_slow = SLOW_EVERY - 1
                left -= 1
            among = left if left < self._to_slow else self._to_slow
            for _ in range(among):
                run()
            self._to_slow -= among
            left -= among
        self._steps += count

    def position(self) -> tuple[float, float, float]:
        """Latitude [rad], longitude [rad] and altitude [m], for sampling the wind at every step."""
        return self._lat_rad(), self._lon_rad(), self._altitude_ft() * _M_PER_FOOT

    def state(self) -> FlightState:
        """Everything that is recorded about this moment."""
        return self._read_state(self._start_time_s + self._steps / self.rate_hz)

    @property
    def fuel_kg(self) -> float:
        """Fuel left [kg]."""
        return self.get(Property.FUEL)

    def engine_runs(self) -> bool:
        """Whether the engine runs: not when it has failed or its tanks are empty."""
        return bool(self._engine_running() > 0.0)

    def stop_engine(self) -> None:
        """Make the engine fail, for good: ignition off and fuel cut, for whatever kind it is."""
        for path, value in _ENGINE_OFF:
            if self._fdm.get_property_manager().get_node(path) is not None:
                self._fdm.set_property_value(path, value)

    def drain_fuel(self, left_kg: float) -> None:
        """Leave so much fuel in all tanks together; more than there is changes nothing.

        Not a number makes the aircraft's mass, and soon all of its state, not a number.
        """
        if not left_kg >= self.fuel_kg:
            self._model.set_fuel_share(left_kg / self._model.fuel_kg)

    def is_finite(self) -> bool:
        """False once a quantity has become infinite or not a number, which JSBSim does not tell."""
        return math.isfinite(self._lat_rad() + self._lon_rad() + self._altitude_ft() + self._airspeed_fps())

    def has_crashed(self) -> bool:
        """Whether it is on the ground, which JSBSim does not tell either.

        The ground, at zero height, does not hold it: it sinks in, and stays crashed.
        """
        return not self._altitude_ft() >= _WRECK_HEIGHT_FT  # true of nan, too


def _state_reader(nodes: list[Any]) -> Callable[[float], FlightState]:
    """From the time, and the nodes of `_STATE`, to the state: one expression that calls every getter.

    It is made of `_STATE`, as a named tuple's constructor is of its fields; a loop over getters and factors
    takes twice as long, which at ten states a second is 3 % of a flight. The height above ground is the
    altitude, since the ground is at zero height; to say the same, JSBSim takes as long as for six others.
    """
    names: dict[str, object] = {f"get_{i}": node.get_double_value for i, node in enumerate(nodes)}
    values = [
        f"get_{i}()" if member.to_si == 1.0 else f"get_{i}() * {member.to_si!r}"
        for i, member in enumerate(_STATE)
    ]
    altitude = _STATE.index(Property.ALTITUDE)
    values[altitude] = f"(altitude := {values[altitude]})"
    source = f"lambda time_s: new(State, (time_s, {', '.join(values)}, altitude))"
    read: Callable[[float], FlightState] = eval(source, names | {"new": tuple.__new__, "State": FlightState})
    return read
