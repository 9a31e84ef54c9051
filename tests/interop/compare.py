"""Our recordings by Foxglove's own reader, in JavaScript: `make interop`, which needs node and npm.

The packages go to a temporary folder. Compared are counts, sums of decoded columns, times, metadata and
attachments, of the golden recordings and of the newest packed by LZ4 instead.
"""

from __future__ import annotations

import json
import math
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any

from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer

import recordings

HERE = Path(__file__).parent
GOLDEN = HERE.parent / "golden"
PACKAGES = ("@mcap/core@2.2.2", "@mcap/nodejs@1.0.2", "@mcap/support@1.1.0")


def packed_by_lz4(source: Path, target: Path) -> Path:
    with source.open("rb") as stream, target.open("wb") as out:
        reader, writer = make_reader(stream), Writer(out, compression=CompressionType.LZ4)
        writer.start()
        for record in reader.iter_metadata():
            writer.add_metadata(record.name, record.metadata)
        for attachment in reader.iter_attachments():
            writer.add_attachment(0, 0, attachment.name, attachment.media_type, attachment.data)
        channels: dict[str, int] = {}
        for schema, channel, message in reader.iter_messages():
            if channel.topic not in channels:
                schema_id = writer.register_schema(schema.name, schema.encoding, schema.data)
                channels[channel.topic] = writer.register_channel(channel.topic, "protobuf", schema_id)
            writer.add_message(channels[channel.topic], message.log_time, message.data, message.log_time)
        writer.finish()
    return target


def expected(path: Path, sums: list[str]) -> dict[str, Any]:
    """The same figures by the Python readers."""
    with path.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        times, counts = [], {}
        for _, channel, message in reader.iter_messages():
            counts[channel.topic] = counts.get(channel.topic, 0) + 1
            times.append(message.log_time)
        metadata = {record.name: record.metadata for record in reader.iter_metadata()}
        attachments = {record.name: len(record.data) for record in reader.iter_attachments()}
    recording = recordings.open(path)
    return {
        "counts": counts,
        "metadata": metadata,
        "attachments": attachments,
        "first": str(min(times)),
        "last": str(max(times)),
        "outcome": recording.outcome.value,
        "sums": {name: float(recording.state[name].astype(float).sum()) for name in sums},
    }


def compare(path: Path, found: dict[str, Any]) -> str:
    wanted = expected(path, list(found["sums"]))
    for name, value in wanted["sums"].items():
        if not math.isclose(found["sums"][name], value, rel_tol=1e-12):
            raise SystemExit(
                f"{path.name}: the sum of {name} is {found['sums'][name]}, where Python has {value}"
            )
    for name in wanted.keys() - {"sums"}:
        if found[name] != wanted[name]:
            raise SystemExit(f"{path.name}: {name} is {found[name]}, where Python has {wanted[name]}")
    counts, (packed,) = found["counts"], found["compressions"]
    return f"{path.name}: {sum(counts.values())} messages on {len(counts)} topics, {packed}: the same"


def main() -> None:
    if shutil.which("node") is None or shutil.which("npm") is None:
        raise SystemExit(
            "node and npm are needed to read recordings in JavaScript; install Node.js 18 or newer"
        )
    with tempfile.TemporaryDirectory(prefix="galeway-interop-") as name:
        folder = Path(name)
        install = [
            "npm",
            "install",
            "--silent",
            "--no-save",
            "--no-package-lock",
            "--no-audit",
            "--prefix",
            name,
        ]
        subprocess.run([*install, *PACKAGES], check=True)
        script = shutil.copy(HERE / "read.mjs", folder)
        paths = sorted(GOLDEN.glob("*.mcap"))
        paths.append(packed_by_lz4(paths[-1], folder / "lz4.mcap"))
        done = subprocess.run(["node", script, *paths], check=True, stdout=subprocess.PIPE, text=True)
        for path, line in zip(paths, done.stdout.splitlines(), strict=True):
            print(compare(path, json.loads(line)))


if __name__ == "__main__":
    main()
