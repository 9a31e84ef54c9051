"""The envelope of any aircraft, and the proof that a user's own model can be flown at all.

JSBSim ends the process on some mistakes in a model's XML (a function without content, a word for a thruster's
number), so a model that did not come with galeway is first loaded, swept and flown in a child process.
"""

from __future__ import annotations

import hashlib
import os
import signal
import subprocess
import sys
from pathlib import Path

import msgspec

from aircraft import envelope_store
from aircraft.description import AircraftFolder
from aircraft.envelope import Envelope
from aircraft.errors import ModelError
from aircraft.jsbsim_model import VERSION
from aircraft.trim_stand import TrimStand

TIMEOUT_S = 120.0
_REFUSED = 2
_SOURCES = ("envelope.py", "jsbsim_model.py", "trim_stand.py", "base_model.py", "properties.py")
_WHERE_TO_LOOK = (
    "look for an empty <function>, a word where a number belongs, or a missing part in the engine, thruster "
    "or propeller"
)

_known: dict[str, Envelope] = {}  # of this process


def envelope_of(aircraft: AircraftFolder) -> Envelope:
    """The measured envelope: from memory, from the user's cache, or measured now in a second or a few.

    Raises:
        ModelError: if the model cannot be loaded, or flown with the margins asked for.
    """
    key = fingerprint(aircraft)
    found = _known.get(key) or envelope_store.recall(key)
    if found is None:
        found = TrimStand(aircraft).envelope() if aircraft.built_in else _measure_in_child(aircraft)
        envelope_store.store(key, found)
    _known[key] = found
    return found


def fingerprint(aircraft: AircraftFolder) -> str:
    """A hash of everything that decides the envelope: the model, JSBSim, and how it is measured."""
    digest = hashlib.sha256(f"{aircraft.fingerprint()} {aircraft.name} {VERSION}".encode())
    for name in _SOURCES:
        digest.update((Path(__file__).parent / name).read_bytes())
    return digest.hexdigest()


def _measure_in_child(aircraft: AircraftFolder) -> Envelope:
    """Have a child process try the model, and turn however that ends into an envelope or one message."""
    name = aircraft.name
    command = [sys.executable, "-P", "-m", "aircraft.model_trial", str(aircraft.path)]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, check=False, timeout=TIMEOUT_S, env=environment
        )
    except subprocess.TimeoutExpired as error:
        raise ModelError(
            f"the model {name!r} was still being tried after {TIMEOUT_S:.0f} s; "
            "JSBSim does not come to an end with it"
        ) from error
    if done.returncode == 0:
        return msgspec.json.decode(done.stdout.splitlines()[-1], type=Envelope)
    if done.returncode == _REFUSED:
        raise ModelError(done.stderr.strip())
    raise ModelError(
        f"JSBSim {_ending(done.returncode)} while it tried the model {name!r} in {aircraft.path}; "
        + _last_words(done.stderr)
    )


def _last_words(stderr: str) -> str:
    """What JSBSim said before it ended, or where to look if it said nothing."""
    said = [line.replace("what():", "").strip() for line in stderr.splitlines()]
    last = next(filter(None, reversed(said)), "")
    return f"its last words: {last}" if last else _WHERE_TO_LOOK


def _ending(code: int) -> str:
    """How a process ended, in words."""
    if code >= 0:
        return f"ended with code {code}"
    try:
        return f"was killed by {signal.Signals(-code).name}"
    except ValueError:
        return f"was killed by signal {-code}"
