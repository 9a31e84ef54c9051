"""What waits for a chunk is kept beside the file, and changes nothing in it."""

import pytest

from recordings import mcap_tail
from recordings.errors import RecordingError
from recordings.mcap_reader import read
from recordings.mcap_tail import tail_path
from recordings.mcap_writer import McapRecorder
from recordings.schema import SAMPLES_PER_CHUNK


@pytest.fixture
def flight(workshop):
    return workshop.fly(workshop.header(workshop.straight), until_s=45.0)


@pytest.fixture
def recorder(workshop):
    return McapRecorder(workshop.folder / "flight.mcap")


def keep_now(recorder, flight, time_s):
    """Take one more sample, as if half a second had passed on the wall."""
    recorder._tail._due_s = 0.0
    recorder.sample(flight.states[-1]._replace(time_s=time_s), flight.guidance[-1])


def test_the_bytes_are_the_same_however_often_a_tail_is_kept(workshop, flight, monkeypatch):
    seldom = workshop.file(flight, "seldom")
    monkeypatch.setattr(mcap_tail, "EVERY_S", 0.001)
    often = workshop.file(flight, "often")
    assert len(flight.states) > SAMPLES_PER_CHUNK
    assert seldom.read_bytes() == often.read_bytes()
    assert sorted(path.name for path in workshop.folder.iterdir()) == ["often.mcap", "seldom.mcap"]


def test_with_its_tail_an_unfinished_file_holds_everything(flight, recorder):
    flight.record(recorder, finish=False)
    without = read(recorder.partial_path)
    assert len(without.state) == SAMPLES_PER_CHUNK
    keep_now(recorder, flight, 45.1)
    whole = read(recorder.partial_path)
    recorder.abandon()
    closed = read(recorder.partial_path)
    assert not tail_path(recorder.partial_path).exists()
    for name in ("state", "guidance", "estimate"):
        assert getattr(whole, name).tobytes() == getattr(closed, name).tobytes()
    assert len(whole.state) == len(flight.states) + 1
    assert "cut off" in whole.missing


def test_a_tail_that_cannot_be_written_is_one_error(flight, recorder):
    flight.record(recorder, finish=False)
    tail_path(recorder.partial_path).mkdir()
    with pytest.raises(RecordingError, match=r"cannot go on writing .*tail: .*; make room"):
        keep_now(recorder, flight, 45.1)
    tail_path(recorder.partial_path).rmdir()
    recorder.abandon()


def test_a_tail_from_before_the_last_chunk_is_passed_over(flight, recorder):
    flight.record(recorder, finish=False)
    keep_now(recorder, flight, 45.1)
    waiting = tail_path(recorder.partial_path).read_bytes()
    for tick in range(2, 2 * SAMPLES_PER_CHUNK - len(flight.states) + 1):
        recorder.sample(flight.states[-1]._replace(time_s=45.0 + tick / 10), flight.guidance[-1])
    assert tail_path(recorder.partial_path).read_bytes() == waiting
    assert len(read(recorder.partial_path).state) == 2 * SAMPLES_PER_CHUNK
    recorder.abandon()


def test_a_chunk_that_is_half_written_gives_way_to_the_tail(flight, recorder, tmp_path):
    """Killed in the middle of writing the chunk that the tail is of."""
    flight.record(recorder, finish=False)
    keep_now(recorder, flight, 45.1)
    left = recorder.partial_path.read_bytes()
    waiting = tail_path(recorder.partial_path).read_bytes()
    recorder.abandon()
    whole = recorder.partial_path.read_bytes()
    assert whole.startswith(left)
    cut = tmp_path / "cut.partial.mcap"
    for length in (1, 9, 100, 1000):
        cut.write_bytes(whole[: len(left) + length])
        tail_path(cut).write_bytes(waiting)
        assert len(read(cut).state) == len(flight.states) + 1
