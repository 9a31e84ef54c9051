"""The aircraft as JSBSim flies it: the only place where feet, pounds and JSBSim's own objects are known."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import jsbsim

from aircraft.envelope import ENVELOPES, Envelope
from aircraft.errors import ModelError
from aircraft.properties import Property, check_properties
from aircraft.state import Command, FlightState
from aircraft.turbulence import Turbulence

__all__ = ["Envelope", "JsbsimAircraft", "Turbulence"]

_MODELS = Path(__file__).parent / "models"
_ADAMS_BASHFORTH_2 = 3.0  # the default, explicit Euler, takes the damping out of the short period at 60 Hz
_MILSPEC = 3.0
_FULL_TRIM = 1
_WRECK_HEIGHT_FT = 3.0  # of the centre of gravity; whatever hits the ground first, it is no higher then
_M_PER_FOOT = 0.3048
_FEET_PER_M = 1.0 / _M_PER_FOOT

# the fields of FlightState after the time, in their order
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
    Property.HEIGHT_ABOVE_GROUND,
)


class _Silence(jsbsim.FGLogger):
    """Keeps JSBSim off the screen, and its complaints for an error message."""

    def __init__(self) -> None:
        super().__init__()
        self.complaints: list[str] = []
        self._complaining = False

    def set_level(self, level: jsbsim.LogLevel) -> None:
        self._complaining = level >= jsbsim.LogLevel.WARN

    def file_location(self, filename: str, line: int) -> None:
        if self._complaining:
            self.complaints.append(f"{Path(filename).name}:{line}: ")

    def message(self, message: str) -> None:
        if self._complaining:
            self.complaints.append(message)

    def format(self, format: jsbsim.LogFormat) -> None:  # noqa: A002  JSBSim's name
        pass

    def flush(self) -> None:
        pass


_silence = _Silence()  # JSBSim holds one logger for the process


class JsbsimAircraft:
    """A model with its autopilot, stepped at a fixed rate.

    Positions are geodetic (WGS84), altitude is height above the ellipsoid, the ground is at zero height.
    The same seed gives bit-identical flights.
    """

    def __init__(self, model: str, *, turbulence: Turbulence, seed: int, rate_hz: float = 60.0) -> None:
        """Load the model.

        Raises:
            ModelError: if there is no such model, JSBSim cannot load it, or it lacks a property in use.
        """
        if model not in ENVELOPES:
            known = ", ".join(sorted(ENVELOPES))
            raise ModelError(f"there is no aircraft model {model!r}; the models are: {known}")
        self.model = model
        self.envelope: Envelope = ENVELOPES[model]
        self.rate_hz = rate_hz
        self._turbulence = turbulence
        self._seed = 1 + seed % (2**31 - 2)  # what JSBSim's generator tells apart
        self._start_time_s = 0.0
        self._steps = 0
        self._load()

    def _load(self) -> None:
        jsbsim.set_logger(_silence)
        _silence.complaints.clear()
        self._fdm = jsbsim.FGFDMExec(None)
        self._fdm.set_debug_level(0)
        self._fdm.set_dt(1.0 / self.rate_hz)  # before the load: filters and integrators take it from there
        loaded = self._fdm.load_model_with_paths(
            self.model, str(_MODELS), str(_MODELS / "engine"), str(_MODELS)
        )
        if not loaded or _silence.complaints:
            reason = " ".join("".join(_silence.complaints).split()) or "no reason given"
            raise ModelError(f"JSBSim cannot load the model {self.model!r}: {reason}")
        root = self._fdm.get_property_manager()
        check_properties(self.model, lambda path: root.get_node(path) is not None)
        self._bind()

    def _bind(self) -> None:
        """Look up, once, what is called in flight."""
        self._run = self._fdm.run
        self._lat_rad = self._node(Property.LATITUDE).get_double_value
        self._lon_rad = self._node(Property.LONGITUDE).get_double_value
        self._altitude_ft = self._node(Property.ALTITUDE).get_double_value
        self._airspeed_fps = self._node(Property.AIRSPEED).get_double_value
        self._height_above_ground_ft = self._node(Property.HEIGHT_ABOVE_GROUND).get_double_value
        self._set_north_fps = self._node(Property.WIND_NORTH).set_double_value
        self._set_east_fps = self._node(Property.WIND_EAST).set_double_value
        self._set_down_fps = self._node(Property.WIND_DOWN).set_double_value
        self._set_roll_rad = self._node(Property.ROLL_COMMAND).set_double_value
        self._set_airspeed_fps = self._node(Property.AIRSPEED_COMMAND).set_double_value
        self._set_altitude_ft = self._node(Property.ALTITUDE_COMMAND).set_double_value
        self._set_climb_fps = self._node(Property.CLIMB_COMMAND).set_double_value
        self._read_state = _state_reader([self._node(member) for member in _STATE])

    def _node(self, member: Property) -> jsbsim.FGPropertyNode:
        node = self._fdm.get_property_manager().get_node(member.path)
        assert node is not None  # checked at load
        return node

    def get(self, member: Property) -> float:
        """A property's value now, SI."""
        return self._node(member).get_double_value() * member.to_si

    def set(self, member: Property, value: float) -> None:
        """Set a property, SI."""
        self._node(member).set_double_value(value / member.to_si)

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
        if self._turbulence.kind == "milspec":
            self.set(Property.TURBULENCE_TYPE, _MILSPEC)
            self.set(Property.TURBULENCE_SEVERITY, self._turbulence.severity)
            self.set(Property.TURBULENCE_WIND_20FT, self._turbulence.wind_at_20ft_mps)
        self._start_time_s = time_s
        self._steps = 0

    def _trim(self, airspeed_mps: float, altitude_m: float) -> None:
        self.set(Property.AUTOPILOT_ENGAGED, 0.0)
        self._fdm.run_ic()
        self._fdm.get_propulsion().init_running(-1)
        try:
            self._fdm.do_trim(_FULL_TRIM)
        except jsbsim.TrimFailureError as error:
            limits = self.envelope
            raise ModelError(
                f"{self.model!r} cannot fly level at {airspeed_mps:.1f} m/s and {altitude_m:.0f} m; "
                f"start between {limits.airspeed_min_mps:.0f} and {limits.airspeed_max_mps:.0f} m/s, "
                f"no higher than {limits.ceiling_m:.0f} m"
            ) from error

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
        self._set_roll_rad(command.roll_rad)
        self._set_airspeed_fps(command.airspeed_mps * _FEET_PER_M)
        self._set_altitude_ft(command.altitude_m * _FEET_PER_M)
        self._set_climb_fps(command.climb_mps * _FEET_PER_M)

    def set_wind(self, north_mps: float, east_mps: float, down_mps: float) -> None:
        """The steady wind from the next step on, toward."""
        self._set_north_fps(north_mps * _FEET_PER_M)
        self._set_east_fps(east_mps * _FEET_PER_M)
        self._set_down_fps(down_mps * _FEET_PER_M)

    def step(self, count: int = 1) -> None:
        """Fly on by `count` / `rate_hz`."""
        run = self._run
        for _ in range(count):
            run()
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

    def level_fuel_flow_kgps(self, airspeed_mps: float, altitude_m: float) -> float:
        """What the engine burns in trimmed level flight [kg/s], at the equator in still air.

        Raises:
            ModelError: if the model cannot fly level at this airspeed and altitude.
        """
        self.start(
            lat_rad=0.0,
            lon_rad=0.0,
            altitude_m=altitude_m,
            heading_rad=0.0,
            airspeed_mps=airspeed_mps,
            time_s=0.0,
        )
        return self.get(Property.FUEL_FLOW)

    def is_finite(self) -> bool:
        """False once a quantity has become infinite or not a number, which JSBSim does not tell."""
        return math.isfinite(self._lat_rad() + self._lon_rad() + self._altitude_ft() + self._airspeed_fps())

    def has_crashed(self) -> bool:
        """Whether it is on the ground, which JSBSim does not tell either.

        A wreck bounces: ask several times a second.
        """
        return not self._height_above_ground_ft() >= _WRECK_HEIGHT_FT  # true of nan, too


def _state_reader(nodes: list[jsbsim.FGPropertyNode]) -> Callable[[float], FlightState]:
    """From the time, and the nodes of `_STATE`, to the state: one expression that calls every getter.

    It is made of `_STATE`, as a named tuple's constructor is of its fields; a loop over getters and factors
    takes twice as long, which at ten states a second is 3 % of a flight.
    """
    names: dict[str, object] = {f"get_{i}": node.get_double_value for i, node in enumerate(nodes)}
    values = [
        f"get_{i}()" if member.to_si == 1.0 else f"get_{i}() * {member.to_si!r}"
        for i, member in enumerate(_STATE)
    ]
    source = f"lambda time_s: new(State, (time_s, {', '.join(values)}))"
    read: Callable[[float], FlightState] = eval(source, names | {"new": tuple.__new__, "State": FlightState})
    return read
