"""A report as JSON, for programs, and as some lines, for people."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, fields, is_dataclass
from typing import TYPE_CHECKING, Any

from recordings.figures import Spread, clock

if TYPE_CHECKING:
    from recordings.tracking import Tracking

NOT_REPORTED = ("levels_m", "replanning", "outcome_detail", "worst", "series", "recording")
"""What a tracking holds beside the figures of its report."""

_DIGITS = 6


def report_json(tracking: Tracking, extra: Mapping[str, float]) -> bytes:
    """The figures in their order, then the extra ones."""
    report = plain_report(tracking)
    report |= {"levels_m": list(tracking.levels_m)} if tracking.level_changes else {}
    report |= {"replanning": list(tracking.replanning)} if tracking.replanning else {}
    report |= {name: _plain(value) for name, value in extra.items()}
    return json.dumps(report, indent=1).encode() + b"\n"


def plain_report(tracking: Tracking) -> dict[str, Any]:
    """The figures that are reported, by name, as JSON knows them."""
    names = [field.name for field in fields(tracking) if field.name not in NOT_REPORTED]
    return {name: _plain(getattr(tracking, name)) for name in names}


def _plain(value: Any) -> Any:
    if is_dataclass(value) and not isinstance(value, type):
        return {name: _plain(part) for name, part in asdict(value).items()}
    return round(value, _DIGITS) if isinstance(value, float) else value


def summary(tracking: Tracking) -> str:
    """The report in some lines."""
    arrival = "arrived at" if tracking.arrived else "did not arrive at"
    lines = [f"{tracking.scenario}, seed {tracking.seed}: {arrival} {tracking.goal}"]
    if not tracking.arrived or tracking.outcome != "arrived":
        lines.append(f"outcome              {tracking.outcome}: {tracking.outcome_detail}")
    if not tracking.samples:
        return "\n".join([*lines, "no samples after departure, so there is nothing to measure"])
    lines += [
        f"flight time          {clock(tracking.flight_time_s)}, planned {clock(tracking.planned_time_s)}",
        f"length               {_km(tracking.flown_length_m)}, planned {_km(tracking.planned_length_m)}",
        f"cross-track          {_spread(tracking.cross_track_m, 'm')}",
        f"altitude error       {_spread(tracking.altitude_error_m, 'm')}",
        f"waypoint time error  {_spread(tracking.waypoint_time_error_s, 's')}",
    ]
    if tracking.level_changes:
        levels = ", ".join(f"{level_m:.0f}" for level_m in tracking.levels_m)
        lines.append(f"levels               {levels} m, {tracking.level_changes} changes")
    if tracking.holds:
        lines.append(f"held to lose time    {tracking.holds} ×")
    if tracking.forecasts:
        lines.append(f"plan changed         {tracking.plan_changes} ×, at {tracking.forecasts} forecasts")
        lines += [f"  {told}" for told in tracking.replanning]
    if tracking.waypoints_missed:
        lines.append(f"waypoints missed     {tracking.waypoints_missed}")
    believed = [
        f"position believed    {_spread(tracking.position_estimate_error_m, 'm')} off",
        f"wind believed        {_spread(tracking.wind_estimate_error_mps, 'm/s')} off",
    ]
    return "\n".join(
        [
            *lines,
            f"corners cut by       {tracking.corner_cut_m.max:.1f} m at most",
            f"airspeed             {tracking.airspeed_mps.min:.1f} to {tracking.airspeed_mps.max:.1f} m/s, "
            f"outside the envelope for {tracking.outside_airspeeds_s:.1f} s",
            f"wind                 {tracking.wind_mps.min:.1f} to {tracking.wind_mps.max:.1f} m/s",
            f"in hazard            {tracking.hazard_exposure_s:.1f} s{_clearance(tracking)}",
            *(believed if tracking.position_estimate_error_m.mean is not None else []),
        ]
    )


def _spread(spread: Spread, unit: str) -> str:
    if spread.mean is None:
        return "nothing to measure"
    return f"{spread.mean:.2f} {unit} mean, {spread.p95:.2f} p95, {spread.max:.2f} max"


def _km(length_m: float) -> str:
    return f"{length_m / 1000.0:.1f} km"


def _clearance(tracking: Tracking) -> str:
    if tracking.min_clearance_m is None:
        return ", no hazardous cell anywhere"
    return f", nearest hazardous cell {_km(tracking.min_clearance_m)}"
