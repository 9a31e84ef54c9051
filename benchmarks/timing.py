"""Processor times and peak memory.

What is compared here runs in one thread without waiting for anything, so that its processor time is the wall
time of a machine that does nothing else, and stays nearly the same on one that does.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

T = TypeVar("T")


def clocked(call: Callable[[], T], repeats: int = 1) -> tuple[float, T]:
    """The least processor time of some calls [s], and what they gave."""
    best = float("inf")
    for _ in range(repeats):
        begin = time.process_time()
        found = call()
        best = min(best, time.process_time() - begin)
    return best, found


def say(what: str) -> None:
    """Progress, apart from what is printed as the result."""
    print(f"  {what}", file=sys.stderr, flush=True)


def own_peak_mb() -> float:
    """The largest resident size of this process so far [MB].

    Not by getrusage: that counts the process that it was forked from, too.
    """
    status = Path("/proc/self/status").read_text(encoding="ascii")
    return float(next(line.split()[1] for line in status.splitlines() if line.startswith("VmHWM"))) / 1000.0
