"""All that a scenario calls hazardous besides the mean wind, joined: as planned on, and as it really is."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial, reduce
from pathlib import Path
from typing import NamedTuple, TypeGuard

import numpy as np

from planner.closures import Closures, MemberHazard, widened
from planner.hazards import Bools
from planner.survival import blurred
from planner.windfield import Floats, WindField
from sim.errors import HazardError
from sim.hazard_tables import (
    AlsoHazard,
    EnsembleHazard,
    GustHazard,
    MatricesHazard,
    NoFlyHazard,
    VariableHazard,
)
from sim.hazards.field import Stages
from sim.hazards.members import over_threshold, speeds_of_variable, speeds_of_winds, winds_of_files
from sim.hazards.no_fly import closed_by_zones, read_zones
from sim.hazards.variable import source_of_variable
from sim.matrix_file import read_matrices
from sim.weather.files import Reading
from sim.weather.opening import found_files


@dataclass(frozen=True, slots=True)
class Around:
    """What tables take from the scenario beside their own keys.

    `folder`: that paths start from. `files`: of the weather, empty for a storm. `reading`: how the scenario
    has them read. `threshold_mps`: of the wind. `truth_factor`: how many times as strong as the forecast's
    the gusts are that are met; None where the truth is of other files. `members`: the ensemble of the
    forecast that is issued when a stage begins, if there is one.
    """

    folder: Path
    files: tuple[Path, ...]
    reading: Reading
    threshold_mps: float
    truth_factor: float | None = 1.0
    members: Callable[[int], Sequence[WindField]] | None = None


class Found(NamedTuple):
    """One reason for hazard, all of shape [stage, north, east].

    `planned`: closed to the planner, with the room that the aircraft needs. `true`: hazardous in fact, the
    cells alone; None where only the forecast says so. `chance`: the probability of hazard, if it tells one.
    """

    planned: Bools
    true: Bools | None
    chance: Floats | None = None
    members: MemberHazard | None = None


@dataclass(frozen=True, slots=True, eq=False)
class JoinedHazard:
    """What is hazardous besides the mean wind.

    `planned`: for the planner, as of departure. `true`: what the aircraft really meets, [stage, north, east].
    None: nothing. `issued`: for the planner, as of the forecast that is issued when a stage begins, whose
    ensemble may say other things; None where that of departure stands.
    """

    planned: Closures | None = None
    true: Bools | None = None
    issued: Callable[[int], Closures] | None = None


def join_hazards(tables: Sequence[AlsoHazard], stages: Stages, around: Around) -> JoinedHazard:
    """Read all that the tables name, and join it: a cell is hazardous if any of them says so.

    Args:
        tables: of the scenario.
        stages: the planner's grid and clock, and the altitude.
        around: the rest of the scenario.

    Raises:
        SimError: if a file cannot be read or does not fit the mission.
    """
    kept = [table for table in tables if not _changes(table, around)]
    lasting = [one for table in kept if (one := _found(table, stages, around)) is not None]

    def closures(issue: int) -> Closures:
        changing = [_of_ensemble(table, stages, around, issue) for table in tables if _changes(table, around)]
        return _closures([*lasting, *changing])

    true = [one.true for one in lasting if one.true is not None]
    changes = len(kept) < len(tables)
    return JoinedHazard(
        closures(0) if lasting or changes else None,
        reduce(np.logical_or, true) if true else None,
        closures if changes else None,
    )


def _changes(table: AlsoHazard, around: Around) -> TypeGuard[EnsembleHazard]:
    """Whether a table speaks of the weather's own ensemble, which comes anew with each forecast."""
    own = isinstance(table, EnsembleHazard) and table.file is None and table.variable is None
    return own and around.members is not None


def _closures(found: Sequence[Found]) -> Closures:
    ensembles = [one for one in found if one.chance is not None]
    return Closures(
        reduce(np.logical_or, [one.planned for one in found]),
        ensembles[0].chance if ensembles else None,
        ensembles[0].members if ensembles else None,
    )


def _found(table: AlsoHazard, stages: Stages, around: Around) -> Found | None:
    """The hazard of one table; None for a gust factor, which is but a lower threshold of the mean wind."""
    if isinstance(table, GustHazard):
        return None if table.factor is not None else _of_gusts(table, stages, around)
    if isinstance(table, EnsembleHazard):
        return _of_ensemble(table, stages, around)
    if isinstance(table, MatricesHazard):
        return _of_matrices(table, stages, around)
    if isinstance(table, NoFlyHazard):
        zones = read_zones(around.folder / table.file)
        flown_m = stages.passed_m or (stages.altitude_m, stages.altitude_m)
        closed = partial(closed_by_zones, zones, stages.grid, stages.clock, altitudes_m=flown_m)
    else:
        source = source_of_variable(table, _files(table, around), stages)
        closed = partial(source.on, stages.grid, stages.clock)
    return Found(closed(corridor_m=stages.corridor_m), closed(corridor_m=0.0))


def _files(table: GustHazard | EnsembleHazard | VariableHazard, around: Around) -> tuple[Path, ...]:
    return around.files if table.file is None else found_files(table.file, around.folder)


def _of_gusts(table: GustHazard, stages: Stages, around: Around) -> Found:
    paths = _files(table, around)
    speeds = list(speeds_of_variable(paths, table.variable, stages))
    if len(speeds) > 1:
        raise HazardError(
            f"the gusts of {paths[0]} are those of {len(speeds)} members; for an ensemble write "
            'kind = "ensemble" with a variable and more_than'
        )
    if around.truth_factor is None:
        return Found(speeds[0] > table.threshold_mps, None)
    (true_mps,) = speeds_of_variable(paths, table.variable, replace(stages, corridor_m=0.0))
    return Found(speeds[0] > table.threshold_mps, around.truth_factor * true_mps > table.threshold_mps)


def _of_ensemble(table: EnsembleHazard, stages: Stages, around: Around, issue: int = 0) -> Found:
    paths = _files(table, around)
    if table.variable is not None:
        speeds = speeds_of_variable(paths, table.variable, stages)
    elif table.file is not None or (paths and around.members is None):
        speeds = speeds_of_winds(winds_of_files(paths, around.reading, stages), stages)
    elif around.members is not None:
        speeds = speeds_of_winds(around.members(issue), stages)
    else:
        raise HazardError(
            "hazard.also asks for an ensemble, and the weather has none; name the files of one, such as "
            'file = "members.grib"'
        )
    threshold_mps = around.threshold_mps if table.threshold_mps is None else table.threshold_mps
    share, members = over_threshold(speeds, threshold_mps, stages)
    return Found(share > table.more_than, None, blurred(share, table.blur_cells), members)


def _of_matrices(table: MatricesHazard, stages: Stages, around: Around) -> Found:
    path = around.folder / table.file
    cells = read_matrices(path, table.key, ask="key")
    if cells.shape != stages.shape:
        raise HazardError(
            f"the hazard matrices {path} have shape {cells.shape}, but the mission has {stages.shape[0]} "
            f"stages of {stages.shape[1]} rows and {stages.shape[2]} columns; give [stage, north, east], the "
            f"southernmost row first, over {stages.grid.describe()}"
        )
    if cells.dtype.kind not in "biuf" or (cells.dtype.kind == "f" and not np.isfinite(cells).all()):
        raise HazardError(
            f"the hazard matrices {path} have values that are no finite numbers; give booleans, or numbers "
            "of which all but 0 are hazard"
        )
    true = cells != 0
    return Found(widened(true, stages.grid, stages.corridor_m), true)
