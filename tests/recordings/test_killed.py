"""A process that is killed in the middle of a flight, and what can be made of what it leaves."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
from mcap.reader import make_reader

import recordings
from recordings.mcap_tail import tail_path
from recordings.recorder import Outcome
from recordings.schema import SAMPLES_PER_CHUNK, TOPICS

HERE = Path(__file__).parent
WATCHED_S = 1.3

PACED = f"""
import sys, time
from pathlib import Path
sys.path.insert(0, {str(HERE)!r})
import conftest
from recordings.mcap_writer import McapRecorder

class Paced(McapRecorder):
    def sample(self, state, guidance):
        super().sample(state, guidance)
        print(state.time_s, time.monotonic(), flush=True)
        time.sleep(float(sys.argv[2]))

flight = conftest.fly_along(conftest.make_header(conftest.STRAIGHT), until_s=90.0)
flight.record(Paced(Path(sys.argv[1])))
"""


def fly_and_kill(folder, every_s, least):
    """Record a sample every so often, and kill it some time after the `least` of them.

    Returns:
        The unfinished file, and of each sample its time and when on the wall it was taken.
    """
    path = folder / "flight.mcap"
    command = [sys.executable, "-c", PACED, str(path), str(every_s)]
    taken = []
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        for line in process.stdout:
            taken.append(tuple(map(float, line.split())))
            if len(taken) > least and taken[-1][1] > taken[least][1] + WATCHED_S:
                process.kill()
                break
        taken += [tuple(map(float, line.split())) for line in process.stdout if line.endswith("\n")]
    assert process.returncode == -9
    return folder / "flight.partial.mcap", taken


@pytest.fixture(scope="module")
def killed(tmp_path_factory):
    """The remains of a flight at five times real time, which no chunk was finished of."""
    return fly_and_kill(tmp_path_factory.mktemp("killed"), 0.02, 0)


def test_no_more_than_the_last_second_is_lost(killed):
    path, taken = killed
    recording = recordings.open(path)
    last_s = taken[-1][1]
    certain = [time_s for time_s, wall_s in taken if wall_s <= last_s - 1.0]
    assert 0 < len(certain) <= len(recording.state) < SAMPLES_PER_CHUNK
    assert recording.state["time_s"].tolist()[: len(certain)] == certain
    assert len(recording.guidance) == len(recording.state)
    assert "cut off" in recording.missing
    assert recording.outcome is Outcome.INCOMPLETE


def test_chunks_that_were_finished_are_read_with_what_came_after(tmp_path):
    path, taken = fly_and_kill(tmp_path, 0.003, SAMPLES_PER_CHUNK)
    recording = recordings.open(path)
    assert len(recording.state) > SAMPLES_PER_CHUNK
    last_s = taken[-1][1]
    certain = [time_s for time_s, wall_s in taken if wall_s <= last_s - 1.0]
    assert recording.state["time_s"].tolist()[: len(certain)] == certain


def test_without_what_was_kept_beside_it_there_is_less(killed, tmp_path):
    path, _ = killed
    alone = tmp_path / "flight.partial.mcap"
    alone.write_bytes(path.read_bytes())
    with pytest.raises(recordings.errors.BadRecordingError, match="no sample"):
        recordings.open(alone)
    tail_path(alone).write_bytes(tail_path(path).read_bytes()[:-1])  # damaged, so it adds nothing
    with pytest.raises(recordings.errors.BadRecordingError, match="no sample"):
        recordings.open(alone)


def test_what_is_left_is_checked_repaired_and_checked_again_and_passes_neither_time(killed, galeway):
    path, _ = killed
    before = path.read_bytes()
    checked = galeway("check", str(path), "--json")
    assert checked.returncode == 1
    assert "incomplete" in checked.stderr
    done = galeway("repair", str(path))
    repaired = path.with_name("flight.repaired.mcap")
    assert (done.returncode, done.stderr) == (0, "")
    assert "cut off" in done.stdout
    assert str(repaired) in done.stdout
    assert path.read_bytes() == before
    again = galeway("check", str(repaired), "--json")
    assert again.returncode == 1
    assert "incomplete: repaired: the file is cut off" in again.stderr
    told, told_again = json.loads(checked.stdout), json.loads(again.stdout)
    figures = list(told)[: list(told).index("recording")]
    assert {name for name in figures if told_again[name] != told[name]} <= {"outcome"}


def test_a_repaired_file_is_whole_for_others(killed, tmp_path, galeway):
    path, _ = killed
    repaired = tmp_path / "whole.mcap"
    assert galeway("repair", str(path), "-o", str(repaired)).returncode == 0
    left = recordings.open(path)
    with repaired.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        summary = reader.get_summary()
        counts = {}
        times = []
        for _, channel, message in reader.iter_messages(log_time_order=False):
            counts[channel.topic] = counts.get(channel.topic, 0) + 1
            times.append(message.log_time)
        assert [record.name for record in reader.iter_attachments()] == ["scenario.toml", "plan.json"]
    assert times == sorted(times)
    named = {summary.channels[at].topic: n for at, n in summary.statistics.channel_message_counts.items()}
    assert counts == named
    assert counts["/state"] == counts["/guidance"] == len(left.state)
    assert counts["/estimate"] == len(left.estimate)
    assert counts["/outcome"] == 1
    assert {channel.topic for channel in summary.channels.values()} == {topic.name for topic in TOPICS}
    checked = subprocess.run(
        [Path(sys.executable).parent / "rerun", "mcap", "check", repaired], capture_output=True, text=True
    )
    assert checked.returncode == 0, checked.stderr
    assert "/state" in checked.stdout
