"""The fan-out to several recorders."""

import pytest

from recordings.errors import RecordingError
from recordings.mcap_reader import read
from recordings.mcap_writer import McapRecorder
from recordings.recorder import Recorders


def test_every_recorder_is_told_everything(workshop):
    paths = [workshop.folder / "one.mcap", workshop.folder / "two.mcap"]
    flight = workshop.fly(workshop.header(workshop.straight))
    flight.record(Recorders([McapRecorder(path) for path in paths]))
    assert paths[0].read_bytes() == paths[1].read_bytes() == workshop.file(flight).read_bytes()


class Broken(McapRecorder):
    """Fails in the way a recorder of some other format might."""

    def abandon(self):
        super().abandon()
        raise RecordingError("broken")


def test_all_are_abandoned_even_if_one_fails(workshop):
    recorders = [Broken(workshop.folder / "one.mcap"), McapRecorder(workshop.folder / "two.mcap")]
    both = Recorders(recorders)
    flight = workshop.fly(workshop.header(workshop.straight))
    flight.record(both, finish=False)
    with pytest.raises(RecordingError, match="broken"):
        both.abandon()
    for recorder in recorders:
        assert len(read(recorder.partial_path).state) == len(flight.states)
