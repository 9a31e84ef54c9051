"""The rows that have landed, kept in SQLite: whole or not at all, whatever ends the process or the machine.

Rows that land together are one transaction, on the disk when `add` returns. A disk takes its time for each;
what lands meanwhile goes into the next one, so that many workers do not wait for it one by one. SQLite's lock
on the file is held as long as the journal is open, so that two campaigns never write to one folder; it goes
with the process that held it.
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from sim.errors import CampaignError

if TYPE_CHECKING:
    from sim.campaign.row import Row


class Journal:
    """Open for one campaign alone."""

    def __init__(self, path: Path) -> None:
        self._path = path
        with self._told():
            self._base = sqlite3.connect(path, timeout=0.0, isolation_level=None)
        try:
            with self._told():
                self._base.execute("PRAGMA locking_mode = EXCLUSIVE")
                self._base.execute("PRAGMA synchronous = EXTRA")
                self._base.execute("BEGIN EXCLUSIVE")
                self._base.execute(
                    "CREATE TABLE IF NOT EXISTS flights (run INTEGER PRIMARY KEY, row TEXT NOT NULL)"
                )
                self._base.execute("COMMIT")
        except BaseException:
            self._base.close()
            raise

    def close(self) -> None:
        """Let others have it."""
        self._base.close()

    def add(self, rows: Iterable[Row]) -> None:
        """Keep rows for good, all of them or, if one cannot be, none.

        Raises:
            CampaignError: if they cannot be written.
        """
        texts = [(row["run"], json.dumps(row)) for row in rows]
        with self._told(), self._base:  # which ends the transaction, one way or the other
            self._base.execute("BEGIN")
            self._base.executemany("INSERT INTO flights VALUES (?, ?)", texts)

    def runs(self) -> set[int]:
        """The numbers of the flights that have landed."""
        with self._told():
            return {run for (run,) in self._base.execute("SELECT run FROM flights")}

    def rows(self) -> Iterator[Row]:
        """All rows, by the numbers of their flights."""
        with self._told():
            for (text,) in self._base.execute("SELECT row FROM flights ORDER BY run"):
                yield json.loads(text)

    def __len__(self) -> int:
        with self._told():
            (count,) = self._base.execute("SELECT count(*) FROM flights").fetchone()
        return int(count)

    @contextmanager
    def _told(self) -> Iterator[None]:
        """Turn what SQLite raises into what a user can do about it."""
        try:
            yield
        except sqlite3.OperationalError as error:
            if error.sqlite_errorcode == sqlite3.SQLITE_BUSY:
                raise CampaignBusyError(
                    f"a campaign is being flown in {self._path.parent} by another process; wait for its end, "
                    "or name another --out"
                ) from error
            raise CampaignError(f"cannot go on writing {self._path}: {error}; make room for it") from error
        except sqlite3.DatabaseError as error:
            raise CampaignError(f"{self._path} is damaged: {error}; name another --out") from error


class CampaignBusyError(CampaignError):
    """The folder is another process's."""
