"""Hazard from speeds: of gusts, and of the members of an ensemble."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from planner.closures import MemberHazard
from planner.errors import PlannerError
from planner.grid import Grid
from planner.hazards import Bools, largest_in_room, strongest_mps
from planner.windfield import FieldArray, Floats, WindField
from sim.errors import HazardError
from sim.hazards.field import Field, Stages, read_field
from sim.weather.files import MemberWinds, Reading, read_members
from sim.weather.spacing import evenly_spaced
from sim.weather.spans import Spans
from sim.weather.units import METRES_PER_SECOND


def speeds_of_variable(paths: Sequence[Path], variable: str | None, stages: Stages) -> Iterator[FieldArray]:
    """The strongest speed in each cell's room in each stage, member by member: [stage, north, east] [m/s].

    A gust is the strongest of a window, and counts in the stages that have a part of it. Where a file does
    not say which, the window ends or begins at the file's times: in a stage count those within it, the last
    one before and the first one after. Across the ground speed is bilinear.

    Args:
        paths: of the files of one forecast.
        variable: the speed's name; None for the gust speed, of which there must be one.
        stages: the mission.

    Raises:
        SimError: if the variable cannot be read, is no speed, or has gaps.
    """
    field = read_field(paths, variable, stages)
    if field.unit not in METRES_PER_SECOND:
        raise HazardError(
            f"{field.name} has the unit {field.unit!r}, which is that of no speed; it must be one of "
            f"{', '.join(METRES_PER_SECOND)}"
        )
    gaps = np.count_nonzero(np.isnan(field.values))
    if gaps:
        raise HazardError(
            f"{field.name} has {gaps} gaps among {field.values.size} values around the mission; fill them, "
            "or choose an area without in [grid]"
        )
    values, grid = _even(field)
    for member in values:
        yield _strongest(member.max(axis=1) * METRES_PER_SECOND[field.unit], grid, field, stages)


def _even(field: Field) -> tuple[FieldArray, Grid]:
    """The values on an evenly spaced grid, and that."""
    values, lat_deg, lon_deg = field.values, field.lat_deg, field.lon_deg
    if field.way is not None:
        values = field.way.of(values)
    else:
        rows, lat_deg = evenly_spaced([values], lat_deg, axis=-2, name="latitude")
        (values,), lon_deg = evenly_spaced(rows, lon_deg, axis=-1, name="longitude")
    ends = np.radians([lat_deg[0], lat_deg[-1], lon_deg[0], lon_deg[-1]]).tolist()
    return values, Grid.covering(*ends, rows=lat_deg.size, columns=lon_deg.size)


def _strongest(speed_mps: FieldArray, grid: Grid, field: Field, stages: Stages) -> FieldArray:
    """Of one member's speeds (T, rows, columns)."""
    held: dict[tuple[int, int], FieldArray] = {}
    sheets: list[FieldArray] = []
    for stage in range(stages.clock.stage_count):
        span = field.spans.during(*stages.clock.span_s(stage))
        key = span.start, span.stop
        if key not in held:
            strongest = speed_mps[span].max(axis=0)[np.newaxis]
            try:
                sheet = WindField(grid, np.zeros(1), strongest, np.zeros_like(strongest)).resampled(
                    stages.grid
                )
            except PlannerError as error:
                raise HazardError(f"{field.name} does not hold the mission's area: {error}") from error
            in_room = largest_in_room(
                sheet.north_mps[0], sheet.east_mps[0], stages.grid, corridor_m=stages.corridor_m
            )
            held[key] = _with_nodes(in_room, strongest[0], grid, stages.grid)
        sheets.append(held[key])
    return np.stack(sheets).astype(np.float32)


def _with_nodes(speed_mps: FieldArray, own_mps: FieldArray, own: Grid, grid: Grid) -> FieldArray:
    """Speeds by cell, none below that of a node of the file that lies in the cell: peaks are not lost."""
    places = np.meshgrid(own.lat_rad, own.lon_rad, indexing="ij")
    rows, columns = (np.rint(index).astype(np.intp) for index in grid.indices(*places))
    on_grid = (rows >= 0) & (rows < grid.rows) & (columns >= 0) & (columns < grid.columns)
    np.maximum.at(speed_mps, (rows[on_grid], columns[on_grid]), own_mps[on_grid])
    return speed_mps


def speeds_of_winds(winds: Sequence[WindField], stages: Stages) -> Iterator[FieldArray]:
    """The same from the winds of an ensemble's members.

    Raises:
        HazardError: if a member does not hold the mission's area, time or altitude.
    """
    for wind in winds:
        try:
            same = wind.height_m is None and wind.grid == stages.grid
            here = wind if same else wind.level(stages.altitude_m, stages.grid)
            yield strongest_mps(here, stages.clock, corridor_m=stages.corridor_m)
        except PlannerError as error:
            raise HazardError(f"the ensemble does not hold the mission: {error}") from error


def winds_of_files(paths: Sequence[Path], reading: Reading, stages: Stages) -> list[WindField]:
    """The winds of all members that files hold.

    Raises:
        WeatherError: if they cannot be read, or have gaps in the mission's time that are not to be bridged.
    """
    found: MemberWinds = read_members(paths, reading=reading)
    source = f"the ensemble of {', '.join(path.name for path in paths[:3])}"
    Spans.at(found.time_s).refuse_gaps(*stages.span_s, stages.bridge_s, source, "wind")
    return [
        WindField(found.grid, found.time_s, north, east, found.height_m)
        for north, east in zip(found.north_mps, found.east_mps, strict=True)
    ]


def over_threshold(
    speeds: Iterator[FieldArray], threshold_mps: float, stages: Stages
) -> tuple[Floats, MemberHazard]:
    """The share of members over a threshold, [stage, north, east], and which members are where.

    Raises:
        HazardError: if there are less than two members.
    """
    over = np.zeros(stages.shape, dtype=np.float64)

    def members() -> Iterator[Bools]:
        for speed_mps in speeds:
            hazard: Bools = speed_mps > threshold_mps
            over[:] += hazard
            yield hazard

    packed = MemberHazard.packed(members())
    count = len(packed.bits)
    if count < 2:
        raise HazardError(
            f"an ensemble of {count} member says nothing about chances; bring more, or write "
            'kind = "gust", or raise hazard.forecast_error_mps'
        )
    return over / count, packed
