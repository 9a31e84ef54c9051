"""A flight to be watched: slowed down, and shown while it is flown."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

from recordings.live import check_system, show

OnTime = Callable[[float], object]


@contextmanager
def watched(
    recording: Path, *, live: bool, pace: float | None, window: Sequence[str] = ()
) -> Iterator[OnTime]:
    """What to call at every round of a flight, with the time since departure.

    Args:
        recording: the Rerun file that is going to be written, under its unfinished name.
        live: show the flight while it is flown.
        pace: fly at most so many times as fast as in reality; as fast as it goes if None.
        window: options of the viewer, for one without a window.
    """
    if live:
        check_system()
    wait = Pace(pace) if pace is not None else None
    with ExitStack() as stack:
        begun = not live

        def on_time(time_s: float) -> None:
            nonlocal begun
            if not begun:  # the file is there now
                begun = True
                shown = show(recording, window)
                if shown and shown.stdin:
                    stack.callback(shown.stdin.close)
            if wait:
                wait(time_s)

        yield on_time


class Pace:
    """Sleeps until a time of flight has come. `factor`: times real time."""

    def __init__(self, factor: float) -> None:
        self._factor = factor
        self._begin_s: float | None = None

    def __call__(self, time_s: float) -> None:
        """Return when it is `time_s` since departure, counted from the first call on."""
        if self._begin_s is None:
            self._begin_s = time.monotonic() - time_s / self._factor
        ahead_s = self._begin_s + time_s / self._factor - time.monotonic()
        if ahead_s > 0.0:
            time.sleep(ahead_s)
