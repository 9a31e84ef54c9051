"""Recordings damaged in every way end in one message, or in a report that is marked incomplete.

Never in a traceback, a hang or a gigabyte of memory: they are read in a process of its own, which dies of
either. `make fuzz` tries ten thousand; here it is some hundred.
"""

import json
import os
import queue
import struct
import subprocess
import sys
import threading
from collections.abc import Callable
from io import BytesIO
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mcap.data_stream import ReadDataStream, RecordBuilder
from mcap.opcode import Opcode
from mcap.records import Chunk
from mcap.stream_reader import get_chunk_data_stream

from recordings.mcap_writer import McapRecorder
from recordings.recorder import Recorders
from recordings.rerun_writer import RerunRecorder

CASES = int(os.environ.get("GALEWAY_FUZZ_CASES", "200"))
PATIENCE_S = 60.0
WORKER = Path(__file__).with_name("fuzz_worker.py")
MCAP_HEADER_BYTES = 8
RRD_HEADER_BYTES = 12

Damage = Callable[[bytes], bytes]
shares = st.floats(0.0, 1.0, exclude_max=True)


def at(content: bytes, share: float) -> int:
    return int(share * len(content))


@st.composite
def cuts(draw) -> Damage:
    share = draw(shares)
    return lambda content: content[: at(content, share)]


@st.composite
def flips(draw) -> Damage:
    places = draw(st.lists(st.tuples(shares, st.integers(0, 7)), min_size=1, max_size=8))

    def flip(content: bytes) -> bytes:
        damaged = bytearray(content)
        for share, bit in places:
            damaged[at(content, share)] ^= 1 << bit
        return bytes(damaged)

    return flip


@st.composite
def overwrites(draw) -> Damage:
    share, patch = draw(shares), draw(st.binary(min_size=1, max_size=40))

    def overwrite(content: bytes) -> bytes:
        begin = at(content, share)
        return (content[:begin] + patch + content[begin + len(patch) :])[: len(content)]

    return overwrite


@st.composite
def moves(draw) -> Damage:
    """A stretch cut out, and put in elsewhere or not at all."""
    begin, end, to = draw(shares), draw(shares), draw(st.none() | shares)

    def move(content: bytes) -> bytes:
        first, last = sorted((at(content, begin), at(content, end)))
        rest = content[:first] + content[last:]
        if to is None:
            return rest
        place = at(rest, to)
        return rest[:place] + content[first:last] + rest[place:]

    return move


@st.composite
def shuffles(draw) -> Damage:
    """Records, or frames, that change places, come twice or not at all, each of them whole."""
    swaps = draw(st.lists(st.tuples(shares, shares), min_size=1, max_size=4))
    kind = draw(st.sampled_from(["swap", "drop", "double"]))
    without_checksum = draw(st.booleans())

    def shuffle(content: bytes) -> bytes:
        head, parts = split(content)
        for one, other in swaps:
            first, second = int(one * len(parts)), int(other * len(parts))
            if kind == "swap":
                parts[first], parts[second] = parts[second], parts[first]
            elif kind == "drop" and len(parts) > 1:
                del parts[first]
            else:
                parts.insert(second, parts[first])
        if without_checksum:
            parts = [without(part) for part in parts]
        return head + b"".join(parts)

    return shuffle


@st.composite
def deep_flips(draw) -> Damage:
    """Bits flipped in what a chunk holds, with no checksum that would tell."""
    inner = draw(flips())

    def flip(content: bytes) -> bytes:
        head, parts = split(content)
        return head + b"".join(opened(part, inner) for part in parts)

    return flip


def split(content: bytes) -> tuple[bytes, list[bytes]]:
    """The head of a file, and its records or frames, the last with all that follows."""
    rerun = content.startswith(b"RRF2")
    layout = struct.Struct("<QQ" if rerun else "<BQ")
    begin = RRD_HEADER_BYTES if rerun else MCAP_HEADER_BYTES
    head, parts = content[:begin], []
    while begin + layout.size < len(content):
        kind, length = layout.unpack_from(content, begin)
        end = begin + layout.size + length
        if kind == (0 if rerun else Opcode.FOOTER):
            end = len(content)
        parts.append(content[begin:end])
        begin = end
    return head, parts


def without(part: bytes) -> bytes:
    """An MCAP record of the end of the data without its checksum."""
    return part[:9] + bytes(4) if part[:9] == struct.pack("<BQ", Opcode.DATA_END, 4) else part


def opened(part: bytes, damage: Damage) -> bytes:
    """A chunk of MCAP damaged inside, uncompressed and without checksum."""
    if part[:1] != bytes([Opcode.CHUNK]):
        return without(part)
    chunk = Chunk.read(ReadDataStream(BytesIO(part[9:])))
    stream, size = get_chunk_data_stream(chunk)
    builder = RecordBuilder()
    content = damage(stream.read(size))
    Chunk("", content, chunk.message_end_time, chunk.message_start_time, 0, len(content)).write(builder)
    return builder.end()


class Worker:
    """The process that reads."""

    def __init__(self, folder: Path, *whole: Path) -> None:
        self.folder, self.whole = folder, whole
        self.start()

    def start(self) -> None:
        command = [sys.executable, str(WORKER), *map(str, self.whole)]
        self.log = (self.folder / "worker.log").open("w+")
        self.process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self.log, text=True
        )
        self.answers: queue.Queue[str] = queue.Queue()
        self.ear = threading.Thread(target=self.listen, args=(self.process.stdout, self.answers))
        self.ear.start()

    @staticmethod
    def listen(lines, answers) -> None:
        for line in lines:
            answers.put(line)
        answers.put("")

    def read(self, name: str, content: bytes) -> dict[str, str]:
        path = self.folder / name
        path.write_bytes(content)
        self.process.stdin.write(f"{path}\n")
        self.process.stdin.flush()
        try:
            answer = self.answers.get(timeout=PATIENCE_S)
        except queue.Empty:
            answer = ""
        if not answer:
            self.stop()
            complaint = f"{self.process.returncode}: {(self.folder / 'worker.log').read_text()}"
            self.start()
            pytest.fail(f"reading ended with {complaint[:5000]}")
        return json.loads(answer)

    def stop(self) -> None:
        self.process.kill()
        self.process.wait()
        self.ear.join()
        self.process.stdin.close()
        self.process.stdout.close()
        self.log.close()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("fuzz")


@pytest.fixture
def whole(workshop, folder):
    """A flight of half a minute in both formats, written once."""
    mcap, rrd = folder / "whole.mcap", folder / "whole.rrd"
    if not mcap.exists():
        flight = workshop.fly(workshop.header(workshop.straight), until_s=5.0)
        flight.record(Recorders([McapRecorder(mcap), RerunRecorder(rrd)]))
    return {"mcap": mcap.read_bytes(), "rrd": rrd.read_bytes()}


@pytest.fixture
def worker(whole, folder):
    made = Worker(folder, folder / "whole.mcap", folder / "whole.rrd")
    yield made
    made.stop()


HOW = {
    "cut": cuts(),
    "flipped": flips(),
    "overwritten": overwrites(),
    "moved": moves(),
    "shuffled": shuffles(),
    "several": st.tuples(flips() | overwrites(), cuts() | moves() | shuffles()).map(
        lambda both: lambda content: both[1](both[0](content))
    ),
}


@pytest.mark.parametrize("kind", ["mcap", "rrd"])
def test_damaged_recordings_end_in_a_message_or_are_incomplete(whole, worker, kind):
    known = worker.read(f"known.{kind}", whole[kind])
    assert known["missing"] == ""

    @settings(
        max_examples=CASES // 2,
        deadline=None,
        derandomize=True,
        database=None,
        suppress_health_check=list(HealthCheck),
    )
    @given(st.one_of(*HOW.values()))
    def damaged(how):
        content = how(whole[kind])
        found = worker.read(f"damaged.{kind}", content)
        if "refused" in found:
            assert found["refused"]
            assert "\n" not in found["refused"]
            assert "Traceback" not in found["refused"]
        elif not found["missing"]:
            assert found["digest"] == known["digest"], "what was changed was not noticed"

    damaged()


def test_what_no_checksum_tells_ends_in_a_message_too(whole, worker):
    """Chunks damaged inside, under a checksum that is right or none: as from a writer that is wrong."""

    @settings(max_examples=CASES // 4, deadline=None, derandomize=True, database=None)
    @given(deep_flips())
    def damaged(how):
        found = worker.read("damaged.mcap", how(whole["mcap"]))
        assert "\n" not in found.get("refused", "")

    damaged()
