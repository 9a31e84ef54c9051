"""Cuts a recording of which a part was lost, so that nothing is measured over what is not there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from recordings.figures import clock
from recordings.recorder import Outcome
from recordings.recording import Recording

LONGEST_GAP = 3.0
"""Between samples, in units of the usual time between them."""


def before_gap(recording: Recording, samples: int | None) -> Recording:
    """An incomplete recording up to where samples are missing first; what was lost stands in `missing`.

    A whole recording is returned as it is: a gap in it is none that anybody knows of, see `soundness`.

    Args:
        recording: one or more samples.
        samples: how many came before a part that is known to be lost, one or more; None if none is.
    """
    if recording.complete:
        return recording
    time_s = recording.state["time_s"]
    count = min(samples or len(time_s), _samples_before_gap(time_s))
    if count == len(time_s) and samples is None:
        return recording
    end_s = float(time_s[count - 1])
    until = f"to {clock(float(time_s[count]))}" if count < len(time_s) else "on"
    lost = f"what was flown from {clock(end_s)} {until} is lost, so the flight is measured up to there only"
    return replace(
        recording,
        state=recording.state[:count],
        guidance=_until(recording.guidance, end_s),
        estimate=_until(recording.estimate, end_s),
        references=(
            recording.references[0],
            *(issue for issue in recording.references[1:] if issue.time_s <= end_s),
        ),
        plans=(recording.plans[0], *(issue for issue in recording.plans[1:] if issue.time_s <= end_s)),
        hazards=tuple(sheet for sheet in recording.hazards if sheet.time_s <= end_s),
        events=tuple(event for event in recording.events if event.time_s <= end_s),
        outcome=Outcome.INCOMPLETE,
        outcome_detail="a part of the recording is lost",
        end_time_s=end_s,
        missing=f"{recording.missing}; {lost}",
    )


def _samples_before_gap(time_s: NDArray[np.float64]) -> int:
    """How many samples there are before the first gap; all of them if there is none."""
    steps_s = np.diff(time_s)
    if not len(steps_s):
        return len(time_s)
    gaps = np.flatnonzero(steps_s > LONGEST_GAP * float(np.median(steps_s)))
    return int(gaps[0]) + 1 if len(gaps) else len(time_s)


def _until(rows: NDArray[np.void], end_s: float) -> NDArray[np.void]:
    return rows[rows["time_s"] <= end_s]
