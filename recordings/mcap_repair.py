"""Makes a whole file of a recording that was cut off, or damaged: all of it that is intact, with indices."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from recordings.decoding import remedy
from recordings.errors import RecordingError
from recordings.fixed_layout import FixedLayout
from recordings.mcap_chunk import McapChunk
from recordings.mcap_file import McapFile
from recordings.mcap_stream import HEAD, Collector, collect
from recordings.messages import outcome_message
from recordings.protobuf_types import descriptor_set
from recordings.recorder import Outcome
from recordings.schema import OUTCOME, STATE, STATE_COLUMNS

_CHUNK_BYTES = 1 << 18


class Repaired(NamedTuple):
    """What was wrong with a recording, in words, and whether the whole flight is there all the same."""

    reason: str
    whole: bool


def repaired_path(path: Path) -> Path:
    """The name of the whole file where none is given: `flight.repaired.mcap` of `flight.partial.mcap`."""
    return path.with_name(f"{path.name.removesuffix('.mcap').removesuffix('.partial')}.repaired.mcap")


def repair(path: Path, out: Path) -> Repaired:
    """Write what is left of a recording as a whole file.

    Messages are in the order of their times. Nothing is made up: what was lost stays lost, the outcome is
    `incomplete`, and `check` does not pass the file. Only where the checksum of all messages proves that
    nothing of the flight is lost, as in a file whose index is damaged, does its outcome stand.

    Args:
        path: the recording, with what was kept beside it while it was made.
        out: the file to write; there must be none yet.

    Raises:
        RecordingError: if it is whole, holds no sample of a flight, or `out` exists or cannot be written.
    """
    found = collect(path, heads=True)
    outcomes, states = found.messages.get(OUTCOME.name, []), found.messages.get(STATE.name, [])
    if outcomes and not found.damage:
        raise RecordingError(f"{path} is whole; there is nothing to repair")
    if not states:
        raise RecordingError(
            f"{path} holds no sample of a flight, so nothing is left to repair; {remedy(path)}"
        )
    reason = found.damage or "it says nothing of how the flight ended"
    if out.exists():
        raise RecordingError(f"{out} exists and is not overwritten; give another file with -o")
    partial = out.with_suffix(f".partial{out.suffix}")
    try:
        with partial.open("wb") as stream:
            whole = _write(McapFile(stream), found, reason)
        partial.replace(out)
    except OSError as error:
        raise RecordingError(f"cannot write {out}: {error.strerror}; give another file with -o") from error
    return Repaired(reason, whole)


def _write(file: McapFile, found: Collector, reason: str) -> bool:
    """Write it; whether the whole flight is there."""
    for name, content in found.metadata.items():
        file.add_metadata(name, content)
    for name, attachment in found.attached.items():
        file.add_attachment(attachment.log_time, name, attachment.media_type, attachment.data)
    channels = _declare(file, found)
    times = _write_messages(file, found, channels)
    whole = found.proven and bool(found.messages.get(OUTCOME.name))
    if not whole:
        end = FixedLayout(STATE_COLUMNS).parse([found.messages[STATE.name][-1][HEAD.size :]])
        end_s = float(end["time_s"][0]) if end is not None else 0.0
        chunk, detail = McapChunk(), f"repaired: {reason}"
        chunk.add_message(channels[OUTCOME.name], times, outcome_message(end_s, Outcome.INCOMPLETE, detail))
        file.add_chunk(chunk)
    file.finish()
    return whole


def _declare(file: McapFile, found: Collector) -> dict[str, int]:
    """Declare all types and topics as they were, and the outcome's; returns topics' new numbers."""
    types: dict[int, int] = {}
    channels: dict[str, int] = {}
    for topic, channel in found.channels.items():
        schema = found.schemas[channel.schema_id]
        if schema.id not in types:
            types[schema.id] = file.add_schema(schema.name, schema.data)
        channels[topic] = file.add_channel(topic, types[schema.id], channel.metadata)
    if OUTCOME.name not in channels:
        outcome = file.add_schema(OUTCOME.message, descriptor_set(OUTCOME.message))
        channels[OUTCOME.name] = file.add_channel(OUTCOME.name, outcome, {})
    return channels


def _write_messages(file: McapFile, found: Collector, channels: dict[str, int]) -> int:
    """Write all messages in the order of their times, those of one time as topics were declared.

    Returns:
        The last log time.
    """
    topics = [topic for topic, messages in found.messages.items() if messages]
    heads = [[HEAD.unpack_from(message) for message in found.messages[topic]] for topic in topics]
    log_times = np.array([log_time for each in heads for _, _, log_time, _ in each], np.uint64)
    which = np.repeat(np.arange(len(topics)), [len(each) for each in heads])
    place = np.concatenate([np.arange(len(each)) for each in heads])
    order = np.argsort(log_times, kind="stable")
    chunk = McapChunk()
    for index, at, log_time in zip(
        which[order].tolist(), place[order].tolist(), log_times[order].tolist(), strict=True
    ):
        topic = topics[index]
        chunk.add_message(channels[topic], log_time, found.messages[topic][at][HEAD.size :])
        if chunk.size >= _CHUNK_BYTES:
            file.add_chunk(chunk)
            chunk = McapChunk()
    file.add_chunk(chunk)
    return int(log_times[order[-1]])
