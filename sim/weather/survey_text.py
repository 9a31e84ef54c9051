"""A survey of weather files as text, and as JSON."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from itertools import pairwise
from typing import Any

import numpy as np

from planner.whereabouts import area_text
from sim.weather.survey import Quantity, Survey
from sim.weather.tally import StageShare
from sim.weather.times import utc

_MOST_STAGES = 48
_MOST_LEVELS = 8
_BAR = 30


def survey_json(survey: Survey) -> str:
    """Everything a survey found; times in UTC, NaN as null."""
    return json.dumps(_plain(asdict(survey)), indent=2) + "\n"


def survey_text(survey: Survey) -> str:
    """What a survey found, for people."""
    lines = [f"{path} ({kind})" for path, kind in survey.files]
    lines += ["", *_variables(survey)]
    quantity = survey.quantity
    if quantity is not None:
        lines += ["", *_whereabouts(quantity), "", *_speeds(quantity), "", *_stages(quantity)]
    lines += ["", f"flying    {'yes' if survey.flyable else f'no: {survey.why_not}'}"]
    if quantity is not None:
        lines.append(f"hazard    {_hazard(quantity)}")
    return "\n".join(lines)


def _variables(survey: Survey) -> list[str]:
    rows = [("variable", "taken for", "unit", "levels", "times", "members")]
    for seen in survey.variables:
        taken = seen.taken_for or f"nothing ({seen.says})" if seen.says or seen.taken_for else "nothing"
        rows.append(
            (seen.name, taken, seen.unit, seen.levels, str(seen.times or ""), str(seen.members or ""))
        )
    notes = [f"{seen.name}: {seen.problem}" for seen in survey.variables if seen.problem]
    notes += [f"{seen.name}: left out; {seen.left_out}" for seen in survey.variables if seen.left_out]
    return [*_table(rows), *notes]


def _whereabouts(quantity: Quantity) -> Iterator[str]:
    rows, columns = quantity.points
    down_km, across_km = quantity.spacing_km
    yield (
        f"area      {area_text(*quantity.area_deg)}; {rows} x {columns} points, "
        f"{down_km:.1f} x {across_km:.1f} km "
        f"apart{', on a map projection' if quantity.curved else ''}"
    )
    if quantity.issued_s is not None:
        yield f"issued    {utc(quantity.issued_s)} UTC"
    yield f"times     {_times(quantity)}"
    gaps = [f"{utc(begin_s)} to {utc(end_s)}" for begin_s, end_s in quantity.gaps_s]
    missing = [f"{quantity.missing} of {quantity.values} values"] if quantity.missing else []
    yield f"gaps      {'; '.join([*gaps, *missing]) or 'none'}"
    yield f"levels    {quantity.levels}{_heights(quantity)}"
    members = quantity.members
    many = f"{len(members)}, {members[0]} to {members[-1]}" if len(members) > 1 else "1"
    yield f"members   {many}"


def _times(quantity: Quantity) -> str:
    time_s, gaps = quantity.time_s, quantity.gaps_s
    if quantity.windows_s is not None:
        return _windows(quantity.windows_s, quantity.over_time)
    if len(time_s) == 1:
        return f"{utc(time_s[0])} UTC"
    pairs = [pair for pair in pairwise(time_s) if pair not in gaps]
    steps = dict.fromkeys(round((after_s - before_s) / 3600.0, 3) for before_s, after_s in pairs)
    every = "every " + ", then ".join(f"{hours:g} h" for hours in steps) if len(steps) < 4 else "unevenly"
    of_each = f"; each value is the {quantity.over_time} of the time before it" if quantity.over_time else ""
    ends = f"{utc(time_s[0])} to {utc(time_s[-1])} UTC"
    return f"{ends}, {len(time_s)} times, {every}{' but for gaps' if gaps else ''}{of_each}"


def _windows(windows_s: Sequence[tuple[float, float]], over_time: str | None) -> str:
    lengths = dict.fromkeys(round((end_s - begin_s) / 3600.0, 3) for begin_s, end_s in windows_s)
    many = f"{len(windows_s)} windows" if len(windows_s) > 1 else "a window"
    long = f" of {', then '.join(f'{hours:g}' for hours in lengths)} h" if len(lengths) < 4 else ""
    of_each = f"; each value is the {over_time} of its window" if over_time else ""
    return f"{utc(windows_s[0][0])} to {utc(windows_s[-1][1])} UTC, {many}{long}{of_each}"


def _heights(quantity: Quantity) -> str:
    if len(quantity.speeds) == 1:
        return ", taken to hold at every altitude"
    if quantity.height_m is None:
        return ""
    if "hPa" in quantity.levels:
        return f"; {', '.join(f'{height:.0f}' for height in quantity.height_m)} m in the standard atmosphere"
    return "; taken for heights above the sea" if "ground" in quantity.levels else ""


def _speeds(quantity: Quantity) -> list[str]:
    rows = [(quantity.kind, "mean", "95 %", "highest")]
    rows += [
        (s.level, f"{s.mean_mps:.1f}", f"{s.p95_mps:.1f}", f"{s.highest_mps:.1f} m/s")
        for s in quantity.speeds
    ]
    return _table(rows)


def _stages(quantity: Quantity) -> Iterator[str]:
    yield f"share of points over {quantity.threshold_mps:g} m/s at some time of each hour"
    shown = quantity.speeds[:_MOST_LEVELS]
    rows = [("from (UTC)", *(speed.level.split(" above")[0] for speed in shown), "")]
    if len(quantity.speeds) == 1:
        rows = [("from (UTC)", "share", "")]
    rows += [_stage(stage, len(shown)) for stage in quantity.stages[:_MOST_STAGES]]
    yield from _table(rows)
    left = len(quantity.stages) - _MOST_STAGES
    if left > 0:
        yield f"{left} more hours: --json has them all"


def _stage(stage: StageShare, levels: int) -> tuple[str, ...]:
    shares = stage.over[:levels]
    if np.isnan(shares).all():
        return utc(stage.begin_s)[:16], *("gap" for _ in shares), ""
    return (
        utc(stage.begin_s)[:16],
        *(f"{100.0 * share:.1f} %" for share in shares),
        "#" * round(_BAR * max(shares)),
    )


def _hazard(quantity: Quantity) -> str:
    members = f", by {len(quantity.members)} members" if len(quantity.members) > 1 else ""
    return f"{quantity.kind} over a threshold{members}"


def _table(rows: Sequence[Sequence[str]]) -> list[str]:
    widths = [max(len(cell) for cell in column) for column in zip(*rows, strict=True)]
    return [
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows
    ]


def _plain(value: Any) -> Any:
    """Seconds since 1970 as UTC, and nothing that JSON does not know."""
    if isinstance(value, dict):
        return {key: _moment(part) if key in _MOMENTS else _plain(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(part) for part in value]
    return None if isinstance(value, float) and not np.isfinite(value) else value


_MOMENTS = ("issued_s", "time_s", "windows_s", "gaps_s", "begin_s")


def _moment(value: Any) -> Any:
    if isinstance(value, list | tuple):
        return [_moment(part) for part in value]
    return None if value is None else f"{utc(value)}Z"
