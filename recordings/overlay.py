"""Several flights through the same weather: whether they can be laid over each other, and their names."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from recordings.errors import RecordingError
from recordings.recorder import FlightHeader, Layer
from recordings.recording import HazardSheet, Recording

MOST = 8
"""More lines than that nobody tells apart."""


@dataclass(frozen=True, slots=True)
class Overlaid:
    """One of several flights. `label`: what it has that others have not."""

    label: str
    recording: Recording


def overlaid(recordings: Sequence[tuple[Path, Recording]]) -> list[Overlaid]:
    """Flights with their labels, in the order given.

    Raises:
        RecordingError: if there are too many, one is there twice, or they did not meet the same weather.
    """
    paths = [path for path, _ in recordings]
    if len(paths) > MOST:
        raise RecordingError(f"{len(paths)} recordings are too many to tell apart; give at most {MOST}")
    for path in paths:
        if [other.resolve() for other in paths].count(path.resolve()) > 1:
            raise RecordingError(f"{path} is given twice; give different recordings")
    (first, compared), *others = recordings
    for path, recording in others:
        if difference := _difference(compared, recording):
            raise RecordingError(
                f"{path} cannot be laid over {first}: {difference}; only flights through the same weather go "
                "together"
            )
    labels = _labels(paths, [recording.header for _, recording in recordings])
    return [Overlaid(label, recording) for label, (_, recording) in zip(labels, recordings, strict=True)]


def truth_met(flights: Sequence[Overlaid]) -> list[HazardSheet]:
    """The true hazard to show: all that the first flight met, of later stages what the next ones did."""
    sheets: list[HazardSheet] = []
    for flight in flights:
        shown = {sheet.stage for sheet in sheets}
        sheets += [sheet for sheet in _truth(flight.recording) if sheet.stage not in shown]
    return sheets


def _truth(recording: Recording) -> list[HazardSheet]:
    return [sheet for sheet in recording.hazards if sheet.layer is Layer.TRUTH]


def _difference(one: Recording, other: Recording) -> str:
    """What makes their weather another; empty if nothing."""
    mine, theirs = one.header, other.header
    if mine.grid != theirs.grid:
        return "it has another area or cell size"
    if mine.plan.departure_s != theirs.plan.departure_s or mine.stage_s != theirs.stage_s:
        return "it departed at another time"
    if mine.threshold_mps != theirs.threshold_mps:
        return (
            f"to it wind is hazardous above {theirs.threshold_mps:g} m/s, to the other above "
            f"{mine.threshold_mps:g} m/s"
        )
    ours, others = _truth(one), _truth(other)
    at_altitudes = all(sheet.altitude_m is not None for sheet in (*ours, *others))

    def by_weather(sheets: list[HazardSheet]) -> dict[tuple[int, float | None], HazardSheet]:
        return {(sheet.stage, sheet.altitude_m if at_altitudes else None): sheet for sheet in sheets}

    met = by_weather(others)
    for weather, sheet in by_weather(ours).items():
        if weather in met and (cells := int(np.sum(met[weather].hazard != sheet.hazard))):
            stage, altitude_m = weather
            at = "" if altitude_m is None else f" at {altitude_m:.0f} m"
            return f"the true hazard of stage {stage}{at} differs in {cells} cells"
    return ""


def _labels(paths: Sequence[Path], headers: Sequence[FlightHeader]) -> list[str]:
    """What differs between the flights, and the files' names where that does not tell them apart."""
    traits = [
        (
            header.scenario,
            header.plan.planner,
            f"by {header.plan.objective}",
            f"to {header.plan.goal}",
            f"seed {header.seed}",
        )
        for header in headers
    ]
    differing = [len(set(column)) > 1 for column in zip(*traits, strict=True)]
    labels = [
        ", ".join(trait for trait, differs in zip(row, differing, strict=True) if differs) for row in traits
    ]
    if len(set(labels)) == len(labels):
        return labels
    names = _names(paths)
    return [f"{label}, {name}" if label else name for label, name in zip(labels, names, strict=True)]


def _names(paths: Sequence[Path]) -> list[str]:
    """The least of the paths that tells them apart; each flight usually has a folder of its own."""
    for names in ([path.stem for path in paths], [path.resolve().parent.name for path in paths]):
        if len(set(names)) == len(names):
            return names
    return [str(path) for path in paths]
