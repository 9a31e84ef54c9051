"""Whether a recording can be measured at all: a figure over bad samples would be a false one."""

from __future__ import annotations

from dataclasses import fields
from itertools import pairwise

import numpy as np

from recordings.errors import BadRecordingError
from recordings.figures import clock
from recordings.recorder import Layer
from recordings.recording import Recording

_LONGEST_GAP = 3.0
"""Between samples, in units of the usual time between them."""


def require_sound(recording: Recording) -> None:
    """Pass if samples, reference, plan and hazards can be measured against each other.

    Raises:
        BadRecordingError: if a sample is not finite, times do not rise or leave a gap, the reference does
            not fit the plan, or the truth's hazards are not there from departure on, stage by stage.
    """
    _require_finite(recording)
    _require_rising(recording)
    _require_plan(recording)
    _require_hazards(recording)


def _require_finite(recording: Recording) -> None:
    for what, rows in (("sample", recording.state), ("estimate", recording.estimate)):
        for name in rows.dtype.names or ():
            bad = np.flatnonzero(~np.isfinite(rows[name]))
            if len(bad):
                first = int(bad[0])
                raise BadRecordingError(
                    f"{name} of {what} {first} is {rows[name][first]}; {len(bad)} {what}s are not finite, "
                    "so the flight cannot be measured"
                )


def _require_rising(recording: Recording) -> None:
    time_s = recording.state["time_s"]
    steps_s = np.diff(time_s)
    if not len(steps_s):
        return
    worst = int(np.argmin(steps_s))
    if steps_s[worst] <= 0.0:
        what = "repeats" if steps_s[worst] == 0.0 else "runs backwards from"
        raise BadRecordingError(
            f"sample {worst + 1} {what} the time of the one before it, {float(time_s[worst]):.3f} s, "
            "so the flight cannot be measured"
        )
    usual_s = float(np.median(steps_s))
    worst = int(np.argmax(steps_s))
    if steps_s[worst] > _LONGEST_GAP * usual_s:
        raise BadRecordingError(
            f"samples are missing from {clock(float(time_s[worst]))} to {clock(float(time_s[worst + 1]))}: a "
            f"gap of {float(steps_s[worst]):.2f} s where {usual_s:.2f} s is usual, so the flight cannot be "
            "measured"
        )


def _require_plan(recording: Recording) -> None:
    reference, plan = recording.header.reference, recording.header.plan
    if len(plan.waypoints) < 2 or len(plan.waypoints) != len(reference.waypoint_path_m):
        raise BadRecordingError(
            f"the plan has {len(plan.waypoints)} waypoints and the reference passes "
            f"{len(reference.waypoint_path_m)}, where both need the same two or more"
        )
    for field in fields(reference):
        if not np.all(np.isfinite(getattr(reference, field.name))):
            raise BadRecordingError(f"{field.name} of the reference is not finite everywhere")
    if not (np.all(reference.length_m > 0.0) and np.all(reference.scale > 0.0)):
        raise BadRecordingError("a segment of the reference has no length or no scale")


def _require_hazards(recording: Recording) -> None:
    truth = [sheet for sheet in recording.hazards if sheet.layer == Layer.TRUTH]
    if not truth or truth[0].time_s > 0.0:
        raise BadRecordingError("the true hazards at departure are missing, so the flight cannot be judged")
    for before, after in pairwise(truth):
        if after.stage != before.stage + 1 or after.time_s <= before.time_s:
            raise BadRecordingError(
                f"true hazards of stage {after.stage} at {after.time_s:.0f} s follow those of stage "
                f"{before.stage} at {before.time_s:.0f} s, where stages come one by one"
            )
