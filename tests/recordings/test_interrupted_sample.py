"""Ctrl-C between any two instructions of a sample leaves the whole samples before it, in both files."""

import sys
from contextlib import suppress

import pytest

import recordings
from recordings.mcap_writer import McapRecorder
from recordings.recorder import Recorders
from recordings.rerun_writer import RerunRecorder
from recordings.samples import Samples

BEFORE = 15


class Interruption:
    """Raises after so many instructions in the code of samples and recorders; `struck`: whether it did."""

    def __init__(self, instructions):
        self.left = instructions
        self.struck = False

    def trace(self, frame, event, _):
        if not frame.f_code.co_filename.endswith(("samples.py", "_writer.py", "recorder.py")):
            return None
        frame.f_trace_opcodes = True
        if event == "opcode":
            self.left -= 1
            if self.left < 0 and not self.struck:
                self.struck = True
                raise KeyboardInterrupt
        return self.trace


@pytest.mark.parametrize("instructions", range(0, 120, 3))
def test_half_a_sample_is_none(workshop, instructions):
    flight = workshop.fly(workshop.header(workshop.corners), until_s=3.0)
    samples = Samples()
    files = workshop.folder / "flight.mcap", workshop.folder / "flight.rrd"
    mcap, rerun = McapRecorder(files[0], samples), RerunRecorder(files[1], samples)
    recorder = Recorders([mcap, rerun])
    recorder.begin(flight.header)
    told = list(zip(flight.states, flight.guidance, strict=True))
    for state, guidance in told[:BEFORE]:
        recorder.sample(state, guidance)
    interruption = Interruption(instructions)
    before = sys.gettrace()
    sys.settrace(interruption.trace)
    try:
        with suppress(KeyboardInterrupt):
            for state, guidance in told[BEFORE:]:
                recorder.sample(state, guidance)
    finally:
        sys.settrace(before)
    recorder.abandon()
    assert interruption.struck
    times_s = [state.time_s for state, _ in told]
    for path in (mcap.partial_path, rerun.partial_path):
        kept = recordings.open(path).state["time_s"]
        assert len(kept) >= BEFORE
        assert kept.tolist() == pytest.approx(times_s[: len(kept)])
