"""Ctrl-C is held back while half of something is done, and let in afterwards."""

import signal
import threading
from contextlib import suppress

import pytest

from sim.closed_loop import fly
from sim.interruption import put_off, terminated_as_interrupted


@pytest.fixture(autouse=True)
def usual_handler():
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def press():
    signal.raise_signal(signal.SIGINT)


def do(*steps):
    """Everything in turn in one block, each given what lets Ctrl-C in."""
    with put_off() as let_in:
        for step in steps:
            step(let_in)


def pressed(_):
    press()


def let_in_now(let_in):
    let_in()


def test_the_first_one_waits_until_it_is_let_in():
    done = []
    with pytest.raises(KeyboardInterrupt):
        do(
            let_in_now,
            pressed,
            lambda _: done.append("this round"),
            let_in_now,
            lambda _: done.append("next"),
        )
    assert done == ["this round"]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_the_end_of_the_block_lets_it_in():
    done = []
    with pytest.raises(KeyboardInterrupt):
        do(pressed, lambda _: done.append("the end of the flight"))
    assert done == ["the end of the flight"]


def test_the_second_one_does_not_wait():
    done = []
    with pytest.raises(KeyboardInterrupt):
        do(pressed, pressed, lambda _: done.append("anything"))
    assert not done


def test_sigterm_waits_as_it_does():
    done, before = [], signal.getsignal(signal.SIGTERM)
    with pytest.raises(KeyboardInterrupt), terminated_as_interrupted() as was_terminated:
        do(lambda _: signal.raise_signal(signal.SIGTERM), lambda _: done.append("this round"), let_in_now)
    assert was_terminated()
    assert done == ["this round"]
    assert signal.getsignal(signal.SIGTERM) is before


def test_where_ctrl_c_is_ignored_sigterm_is_not():
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with pytest.raises(KeyboardInterrupt), terminated_as_interrupted():
        signal.raise_signal(signal.SIGTERM)


def test_an_error_is_not_hidden_by_it():
    def break_down(_):
        raise ValueError("broken")

    with pytest.raises(ValueError, match="broken"):
        do(pressed, break_down)


def test_whoever_has_his_own_use_for_it_keeps_it():
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    do(pressed, let_in_now)
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN


def test_other_threads_fly_without():
    done = []

    thread = threading.Thread(target=do, args=(let_in_now, lambda _: done.append("flown")))
    thread.start()
    thread.join()
    assert done == ["flown"]


def test_an_interrupted_flight_ends_with_whole_rounds(ready, kept):
    setup = ready()
    every = setup.sample_hz // setup.guidance_hz
    record = kept.sample

    def pressed_meanwhile(state, guidance):
        record(state, guidance)
        if len(kept.samples) == 50:
            press()

    kept.sample = pressed_meanwhile
    times_s = []
    with suppress(KeyboardInterrupt):
        fly(setup, kept, times_s.append)
    assert kept.abandoned
    assert 50 <= len(kept.samples) <= 50 + every
    assert len(times_s) == (len(kept.samples) - 1) // every
