"""Rows are on the disk when they are added, and a journal is one process's at a time."""

import os
import signal
import subprocess
import sys

import pytest

from sim.campaign.journal import CampaignBusyError, Journal
from sim.errors import CampaignError

ADDS_AND_DIES = """
import os, signal, sys
from pathlib import Path
from sim.campaign.journal import Journal
journal = Journal(Path(sys.argv[1]))
for run in (5, 3, 8):
    journal.add([{"run": run, "reason": "x" * 1000}])
print("added", flush=True)
if sys.argv[2] == "die":
    os.kill(os.getpid(), signal.SIGKILL)
sys.stdin.read()
"""

FILLS = """
import resource, sys
from pathlib import Path
from sim.campaign.journal import Journal
from sim.errors import CampaignError
resource.setrlimit(resource.RLIMIT_FSIZE, (40_000, 40_000))
journal, added = Journal(Path(sys.argv[1])), 0
try:
    for added in range(100):
        journal.add([{"run": added, "reason": "x" * 1000}])
except CampaignError as error:
    print(added, error)
"""


def process(script, *arguments):
    return subprocess.Popen(
        [sys.executable, "-c", script, *map(str, arguments)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )


def test_rows_outlive_the_process_that_was_killed_when_it_had_added_them(tmp_path):
    path = tmp_path / "journal.sqlite"
    with process(ADDS_AND_DIES, path, "die") as killed:
        assert killed.stdout.read() == "added\n"
    assert killed.returncode == -signal.SIGKILL
    journal = Journal(path)
    assert [row["run"] for row in journal.rows()] == [3, 5, 8]
    assert journal.runs() == {3, 5, 8}
    assert len(journal) == 3


def test_a_journal_is_one_processs_until_that_is_gone(tmp_path):
    path = tmp_path / "journal.sqlite"
    with process(ADDS_AND_DIES, path, "wait") as other:
        other.stdout.readline()
        with pytest.raises(CampaignBusyError, match="by another process"):
            Journal(path)
        os.kill(other.pid, signal.SIGKILL)
    assert len(Journal(path)) == 3


def test_a_flight_lands_once(tmp_path):
    journal = Journal(tmp_path / "journal.sqlite")
    journal.add([{"run": 1}])
    with pytest.raises(CampaignError):
        journal.add([{"run": 2}, {"run": 1}])
    assert journal.runs() == {1}
    journal.add([{"run": 2}, {"run": 3}])
    assert journal.runs() == {1, 2, 3}


def test_a_disk_that_is_full_is_told_and_leaves_what_was_added(tmp_path):
    path = tmp_path / "journal.sqlite"
    with process(FILLS, path) as filling:
        told = filling.communicate()[0]
    added, words = told.split(" ", 1)
    assert "make room" in words
    journal = Journal(path)
    assert 5 < int(added) < 90
    assert journal.runs() == set(range(int(added)))
    journal.add([{"run": 1000}])


def test_what_is_no_journal_is_refused(tmp_path):
    path = tmp_path / "journal.sqlite"
    path.write_bytes(b"not a data base at all" * 100)
    with pytest.raises(CampaignError, match="damaged"):
        Journal(path)
    with pytest.raises(CampaignError, match="cannot"):
        Journal(tmp_path / "nowhere" / "journal.sqlite")
