"""A JSBSim model loaded, checked and trimmed: the only place that knows JSBSim's own objects."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from itertools import count, takewhile
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import jsbsim

from aircraft.base_model import write_with_autopilot
from aircraft.description import AircraftFolder
from aircraft.errors import ModelError
from aircraft.properties import Property, check_properties

VERSION: str = jsbsim.__version__

_STRAIGHT_TRIM, _TURN_TRIM = 1, 5  # tFull and tTurn of JSBSim's FGTrim


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


class JsbsimModel:
    """One JSBSim object with one model in it; a second load into the same object crashes JSBSim."""

    def __init__(self, aircraft: AircraftFolder, rate_hz: float) -> None:
        """Load the model and fill its tanks.

        Raises:
            ModelError: if JSBSim cannot load it, or it lacks a property in use.
        """
        self.aircraft = aircraft
        jsbsim.set_logger(_silence)
        _silence.complaints.clear()
        self.fdm = jsbsim.FGFDMExec(None)
        self.fdm.set_debug_level(0)
        self.fdm.set_dt(1.0 / rate_hz)  # before the load: filters and integrators take it from there
        self._load()
        root = self.fdm.get_property_manager()
        check_properties(aircraft.name, lambda path: root.get_node(path) is not None, aircraft.path_of)
        self._tanks, self._flows = (
            list(takewhile(lambda path: root.get_node(path) is not None, map(member.path_at, count())))
            for member in (Property.TANK, Property.FUEL_FLOW)
        )
        self._contents_lbs = self._fill()

    def _load(self) -> None:
        reason = ""
        with _files(self.aircraft) as (name, folder, engines, systems):
            try:
                loaded = self.fdm.load_model_with_paths(name, str(folder), str(engines), str(systems), False)
            except Exception as error:  # JSBSim raises several kinds, its base class among them
                loaded, reason = False, str(error)
        if not loaded or _silence.complaints:
            said = [" ".join(text.split()) for text in (*_silence.complaints, reason)]
            complaints = " ".join(dict.fromkeys(filter(None, said)))  # it says some things twice
            raise ModelError(
                f"JSBSim cannot load the model {self.aircraft.name!r}: {complaints or 'no reason given'}"
            )

    def _fill(self) -> list[float]:
        """Put the described fuel into the tanks, each as full as the others; what is in each."""
        given_kg = self.aircraft.description.fuel_kg
        contents_lbs = [self.fdm[path] for path in self._tanks]
        if given_kg is None:
            return contents_lbs
        share = given_kg / (Property.TANK.to_si * sum(contents_lbs))
        for path, held_lbs in zip(self._tanks, contents_lbs, strict=True):
            self.fdm[path] = share * held_lbs
        filled_lbs = [self.fdm[path] for path in self._tanks]
        filled_kg = Property.TANK.to_si * sum(filled_lbs)
        if filled_kg < given_kg - 0.01:
            raise ModelError(
                f"the tanks of {self.aircraft.name!r} take {filled_kg:.1f} kg, less than the fuel_kg of "
                f"{given_kg:g} in its aircraft.toml"
            )
        return filled_lbs

    def set_fuel_share(self, share: float) -> None:
        """Fill the tanks to a share of what they start a flight with."""
        for path, full_lbs in zip(self._tanks, self._contents_lbs, strict=True):
            self.fdm[path] = share * full_lbs

    @property
    def fuel_kg(self) -> float:
        """What the tanks hold at the start of a flight."""
        return Property.TANK.to_si * sum(self._contents_lbs)

    def fuel_flow_kgps(self) -> float:
        """What all engines burn."""
        return Property.FUEL_FLOW.to_si * float(sum(self.fdm[path] for path in self._flows))

    def node(self, member: Property) -> Any:
        """JSBSim's node of a property."""
        node = self.fdm.get_property_manager().get_node(self.aircraft.path_of(member))
        assert node is not None  # checked at load
        return node

    def get(self, member: Property) -> float:
        """A property's value now, SI."""
        return float(self.node(member).get_double_value()) * member.to_si

    def set(self, member: Property, value: float) -> None:
        """Set a property, SI."""
        self.node(member).set_double_value(value / member.to_si)

    def trim(self, *, bank_rad: float = 0.0) -> bool:
        """Trim, in still air and without autopilot, for the flight that the `START_*` properties describe.

        JSBSim balances the forces and moments of straight flight or, with a bank, of a steady coordinated
        turn with its rates about all axes. After a failure the object may hold values that are not numbers:
        take a new one.

        Returns:
            Whether it can be trimmed.

        Raises:
            ModelError: if the model cannot be run at all.
        """
        self.set(Property.START_BANK, bank_rad)
        self.set(Property.AUTOPILOT_ENGAGED, 0.0)
        try:
            self.fdm.run_ic()
            self.fdm.get_propulsion().init_running(-1)
            self.fdm.do_trim(_TURN_TRIM if bank_rad else _STRAIGHT_TRIM)
        except jsbsim.TrimFailureError:
            return False
        except RuntimeError as error:  # such as a property that is read but that nothing makes
            raise ModelError(f"JSBSim cannot run the model {self.aircraft.name!r}: {error}") from error
        return True


@contextmanager
def _files(aircraft: AircraftFolder) -> Iterator[tuple[str, Path, Path, Path]]:
    """Name of the model, and the folders of its XML, its engines and its systems."""
    description, folder = aircraft.description, aircraft.path
    if description.model is not None:
        yield description.model, folder, folder / description.engines, folder / description.systems
        return
    assert description.base is not None  # checked at reading
    assert description.autopilot is not None
    root = Path(jsbsim.get_default_root_dir())
    with TemporaryDirectory() as made:
        write_with_autopilot(root, description.base, folder / description.autopilot, Path(made))
        yield description.base, Path(made), root / "engine", root / "systems"
