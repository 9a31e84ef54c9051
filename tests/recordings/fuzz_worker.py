"""Reads one damaged recording after the other, in a process that may not grow by a gigabyte.

Paths come line by line on stdin; what became of each goes to stdout, as a line of JSON.
"""

import hashlib
import json
import resource
import sys
from pathlib import Path

import recordings
from recordings.errors import RecordingError
from recordings.tracking import track

ROOM = 1 << 30


def outcome(path):
    """The error that it ended in, or what the recording lacks and a digest of its samples and report."""
    try:
        recording = recordings.open(path)
    except RecordingError as error:
        return {"refused": str(error)}
    try:
        report = track(recording).to_json()
    except RecordingError as error:
        return {"refused": str(error), "missing": recording.missing}
    content = recording.state.tobytes() + recording.guidance.tobytes() + report
    return {"missing": recording.missing, "digest": hashlib.sha256(content).hexdigest()}


def address_space():
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    return pages * resource.getpagesize()


def main():
    for path in sys.argv[1:]:  # whole ones, to load everything before memory is limited
        outcome(Path(path))
    limit = address_space() + ROOM
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    for line in sys.stdin:
        print(json.dumps(outcome(Path(line.rstrip("\n")))), flush=True)


if __name__ == "__main__":
    main()
