"""Hazard from any variable of a weather file over or under a limit."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from planner.hazards import Bools
from sim.errors import HazardError
from sim.hazard_tables import VariableHazard
from sim.hazards.conversion import limit_in
from sim.hazards.field import Field, Stages, read_field
from sim.hazards.source_cells import SourceCells


def source_of_variable(table: VariableHazard, paths: Sequence[Path], stages: Stages) -> SourceCells:
    """The cells of the file in which the variable is over or under its limit.

    Between two levels around the altitude a cell is hazardous if it is at either; on a map projection's grid
    if any of the four points around is.

    Raises:
        SimError: if the file cannot be read, has another unit, members, or gaps that are not allowed.
    """
    field = read_field(paths, table.variable, stages)
    members = field.values.shape[0]
    if members > 1:
        raise HazardError(
            f"{field.name} has {members} members; give a file with one of them, or for a speed "
            'kind = "ensemble"'
        )
    values = field.values[0]
    over = np.zeros(values.shape, dtype=np.bool_)
    if table.above is not None:
        over |= values > limit_in(field.unit, table.above, table.unit, field.name)
    if table.below is not None:
        over |= values < limit_in(field.unit, table.below, table.unit, field.name)
    gaps = np.isnan(values)
    if gaps.any() and table.gaps == "refuse":
        raise HazardError(
            f"{field.name} has {np.count_nonzero(gaps)} gaps among {gaps.size} values around the mission; "
            'say what they mean with gaps = "hazard" or gaps = "clear"'
        )
    if table.gaps == "hazard":
        over |= gaps
    return SourceCells(
        field.name, field.spans, field.lat_deg, field.lon_deg, _laid(np.asarray(over.any(axis=1)), field)
    )


def _laid(over: Bools, field: Field) -> Bools:
    if field.way is None:
        return over
    return np.asarray(field.way.of(over.astype(np.float32)) > 0.0)
