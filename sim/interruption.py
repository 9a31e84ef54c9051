"""Ctrl-C between two rounds of a flight, never in the middle of one; and SIGTERM, likewise."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType


@contextmanager
def terminated_as_interrupted() -> Iterator[Callable[[], bool]]:
    """Let SIGTERM, as of a batch system whose time is up, end what is done in the block as Ctrl-C does.

    Windows sends none.

    Yields:
        What tells whether there has been one.
    """
    if threading.current_thread() is not threading.main_thread():
        yield lambda: False
        return
    terminated = False

    def interrupt(_number: int, _frame: FrameType | None) -> None:
        nonlocal terminated
        terminated = True
        if not callable(signal.getsignal(signal.SIGINT)):  # in the background of a script Ctrl-C is ignored
            raise KeyboardInterrupt
        signal.raise_signal(signal.SIGINT)

    before = signal.signal(signal.SIGTERM, interrupt)
    try:
        yield lambda: terminated
    finally:
        signal.signal(signal.SIGTERM, before)


@contextmanager
def put_off() -> Iterator[Callable[[], None]]:
    """Hold a first Ctrl-C back until it is let in; a second one stops whatever is being done, as always.

    Python raises `KeyboardInterrupt` between any two instructions, also where half of a sample is recorded.

    Yields:
        What lets it in: raises `KeyboardInterrupt` if Ctrl-C was pressed. As the end of the block does.
        Outside the main thread, to which all signals go, there is nothing to hold back.
    """
    pressed = False

    def press(_number: int, _frame: FrameType | None) -> None:
        nonlocal pressed
        if pressed:
            raise KeyboardInterrupt
        pressed = True

    def let_in() -> None:
        if pressed:
            raise KeyboardInterrupt

    before = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or before is not signal.default_int_handler:
        yield let_in  # somebody else has a use for it, such as a worker of a campaign, which ignores it
        return
    signal.signal(signal.SIGINT, press)
    try:
        yield let_in
        let_in()
    finally:
        signal.signal(signal.SIGINT, before)
