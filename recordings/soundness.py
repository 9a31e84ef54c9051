"""Whether a recording can be measured at all: a figure over bad samples would be a false one."""

from __future__ import annotations

from dataclasses import fields
from itertools import pairwise

import numpy as np

from aircraft.reference import Reference
from recordings.errors import BadRecordingError
from recordings.figures import clock
from recordings.gaps import LONGEST_GAP
from recordings.recorder import Layer
from recordings.recording import Recording


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
    if steps_s[worst] > LONGEST_GAP * usual_s:
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
    firsts = recording.first_waypoints
    for (before, after), (gone, first) in zip(pairwise(recording.references), pairwise(firsts), strict=True):
        left, passed = len(before.reference.waypoint_path_m), len(after.reference.waypoint_path_m)
        if not (after.time_s > before.time_s and passed >= 1 and first >= gone):
            raise BadRecordingError(
                f"a reference of {after.time_s:.1f} s that passes {passed} waypoints follows one of "
                f"{before.time_s:.1f} s that passes {left}, where times rise and, of one plan, waypoints "
                "become no more"
            )
    times_s = [issue.time_s for issue in recording.references]
    for old, new in pairwise(recording.plans):
        flown = firsts[sum(time_s <= new.time_s for time_s in times_s) - 1]
        if old.plan.waypoints[:flown] != new.plan.waypoints[:flown]:
            raise BadRecordingError(
                f"the plan of {new.time_s:.1f} s begins otherwise than that of {old.time_s:.1f} s, of "
                f"which {flown} waypoints had been passed"
            )
    for issue in recording.references:
        _require_segments(issue.reference)


def _require_segments(reference: Reference) -> None:
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
        if not before.stage <= after.stage <= before.stage + 1 or after.time_s <= before.time_s:
            raise BadRecordingError(
                f"true hazards of stage {after.stage} at {after.time_s:.0f} s follow those of stage "
                f"{before.stage} at {before.time_s:.0f} s, where stages come one by one"
            )
