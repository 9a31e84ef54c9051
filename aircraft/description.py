"""An aircraft as a folder describes it: `aircraft.toml` beside its JSBSim XML."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated, Any

import msgspec
from msgspec import Meta, Struct

from aircraft.envelope import Margins
from aircraft.errors import ModelError
from aircraft.guidance import Gains
from aircraft.mistakes import nearest
from aircraft.properties import Property
from aircraft.tables import TableError, convert, read_toml

BUILT_IN = Path(__file__).parent / "models"
FILE = "aircraft.toml"

Positive = Annotated[float, Meta(gt=0.0)]
Name = Annotated[str, Meta(min_length=1)]

_IN_DEGREES = {field.name.replace("_rad", "_deg"): field.name for field in fields(Gains)}

GainsTable = msgspec.defstruct(
    "GainsTable", [(key, float | None, None) for key in _IN_DEGREES], module=__name__, frozen=True
)
"""`Gains` as the file has them: all optional, angles in degrees."""


class LimitsTable(Struct, frozen=True):
    """What is chosen of the envelope; the rest of it is measured."""

    cruise_mps: Positive
    ceiling_m: Annotated[float, Meta(ge=100.0, le=6000.0)]
    bank_max_deg: Annotated[float, Meta(ge=5.0, le=60.0)]
    throttle_in_hand: Annotated[float, Meta(ge=0.0, le=0.5)]
    angle_of_attack_in_hand_deg: Annotated[float, Meta(ge=0.0, le=15.0)]


class TurnsTable(Struct, frozen=True):
    """Radii over ground, unless the scenario gives others."""

    turn_radius_m: Positive
    loiter_radius_m: Positive


class Description(Struct, frozen=True):
    """The file, typed. `docs/aircraft.md` explains the keys."""

    limits: LimitsTable
    turns: TurnsTable
    description: str = ""
    model: Name | None = None
    base: Name | None = None
    autopilot: Name | None = None
    engines: Name = "engine"
    systems: Name = "systems"
    fuel_kg: Positive | None = None
    gains: GainsTable = GainsTable()  # type: ignore[valid-type]
    properties: dict[str, Name] = {}  # msgspec copies it


@dataclass(frozen=True, slots=True)
class AircraftFolder:
    """A folder and what its `aircraft.toml` says."""

    path: Path
    description: Description

    @property
    def name(self) -> str:
        """Of the model: the folder's."""
        return self.path.name

    @property
    def built_in(self) -> bool:
        """Whether it came with galeway, and so needs no caution."""
        return self.path.parent == BUILT_IN

    @property
    def gains(self) -> Gains:
        """Guidance's, with this aircraft's own."""
        own = {
            _IN_DEGREES[key]: math.radians(value) if key.endswith("_deg") else value
            for key, value in msgspec.structs.asdict(self.description.gains).items()
            if value is not None
        }
        return Gains(**own)

    def margins(self, stall_rad: float) -> Margins:
        """What the envelope keeps in hand, given the angle of attack at which the model stalls."""
        limits = self.description.limits
        return Margins(
            limits.cruise_mps,
            limits.ceiling_m,
            math.radians(limits.bank_max_deg),
            1.0 - limits.throttle_in_hand,
            stall_rad - math.radians(limits.angle_of_attack_in_hand_deg),
        )

    def path_of(self, member: Property) -> str:
        """The JSBSim property that this model has for one of galeway's."""
        return self.description.properties.get(member.name.lower(), member.path)

    def fingerprint(self) -> str:
        """A hash of all that describes the aircraft: the TOML and XML in its folders."""
        digest = hashlib.sha256()
        for path in self._files():
            digest.update(f"{path.name}\0".encode())
            digest.update(path.read_bytes())
        return digest.hexdigest()

    def _files(self) -> Iterator[Path]:
        inner = (self.description.engines, self.description.systems)
        folders = {self.path} | {(self.path / name).resolve() for name in inner}
        found = {path for folder in folders for path in folder.glob("*") if path.suffix in (".xml", ".toml")}
        yield from sorted(found, key=lambda path: (path.name, str(path)))


def built_in_names() -> list[str]:
    """Names of the aircraft that come with galeway."""
    return sorted(path.parent.name for path in BUILT_IN.glob(f"*/{FILE}"))


def load_aircraft(model: str | Path, beside: Path = Path()) -> AircraftFolder:
    """Read an aircraft's description; JSBSim is not asked yet.

    Args:
        model: a built-in name, or the path of a folder.
        beside: what a relative path starts from.

    Raises:
        ModelError: if there is no such aircraft, or anything in its `aircraft.toml` is wrong.
    """
    folder = BUILT_IN / model if str(model) in built_in_names() else (beside / model).resolve()
    if not folder.is_dir():
        names = built_in_names()
        raise ModelError(
            f"there is no aircraft model {str(model)!r}; the models are: {', '.join(names)}, "
            f"or give the folder of your own{nearest(str(model), names)}"
        )
    if not (folder / FILE).is_file():
        raise ModelError(f"the folder {folder} has no {FILE}, which describes an aircraft; write one")
    try:
        tables, _ = read_toml(folder / FILE)
        description = convert(tables, Description, str(folder / FILE))
    except TableError as error:
        raise ModelError(str(error)) from error
    _check_together(folder, description)
    return AircraftFolder(folder, description)


def _check_together(folder: Path, description: Description) -> None:
    """What no key can be checked for alone."""
    source = folder / FILE
    if (description.model is None) == (description.base is None):
        raise ModelError(f'{source}: give either model = "x", for x.xml in its folder, or base = "c172p"')
    if (description.autopilot is None) != (description.base is None):
        raise ModelError(
            f'{source}: base = "..." needs autopilot = "autopilot.xml"; model = "..." names its own'
        )
    for name, suffix in ((description.model, ".xml"), (description.autopilot, "")):
        if name is not None and not (folder / (name + suffix)).is_file():
            raise ModelError(f"{source}: there is no file {folder / (name + suffix)}")
    known = [member.name.lower() for member in Property]
    for name in description.properties:
        if name not in known:
            remedy = nearest(name, known) or f"; they are {', '.join(known)}"
            raise ModelError(f"{source}: unknown key 'properties.{name}'{remedy}")


def as_written(gains: Gains) -> dict[str, Any]:
    """Gains by the keys and in the units of the file."""
    values = {key: getattr(gains, name) for key, name in _IN_DEGREES.items()}
    return {key: math.degrees(value) if key.endswith("_deg") else value for key, value in values.items()}
