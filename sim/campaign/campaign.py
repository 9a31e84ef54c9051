"""A campaign flown: what is left of it, by an executor, each row kept as it lands."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass
from typing import Protocol

from recordings.errors import RecordingError
from sim.campaign.design import Design
from sim.campaign.executor import Executor, Lost
from sim.campaign.flight import Flight
from sim.campaign.flying import Flying, scratch_name
from sim.campaign.folder import CampaignFolder
from sim.campaign.journal import Journal
from sim.campaign.keeping import Keep, WorstKept
from sim.campaign.row import Row, RowMaker
from sim.errors import CampaignError


class Watch(Protocol):
    """Somebody who watches a campaign."""

    def begin(self, total: int, landed: int) -> None:
        """Hear how many flights there are, and how many have landed before."""

    def landed(self, row: Row) -> None:
        """Hear of a flight that has landed now."""


@dataclass(frozen=True, slots=True)
class Campaign:
    """What is flown, where it is kept, and what of the recordings."""

    design: Design
    folder: CampaignFolder
    keep: Keep

    def fly(self, executor: Executor, watch: Watch, tell: Callable[[str], object]) -> None:
        """Fly what is left, and make the table, also of what has landed when it is interrupted.

        Args:
            executor: flies.
            watch: hears of each flight.
            tell: told what a user has to know besides.

        Raises:
            CampaignError: if it cannot be begun or not go on, such as on a full disk; what has landed stays.
            KeyboardInterrupt: if the user has had enough; likewise.
        """
        with self.folder.begun(self.design, self.keep, tell) as journal:
            try:
                self._fly(journal, executor, watch)
                self.folder.write_results(journal)
            except (OSError, RecordingError) as error:
                raise CampaignError(
                    f"the campaign cannot go on: {error}; what has landed is kept, and the same command "
                    "goes on"
                ) from error
            except KeyboardInterrupt:
                self.folder.write_results(journal)
                raise

    def _fly(self, journal: Journal, executor: Executor, watch: Watch) -> None:
        landed = journal.runs()
        worst = WorstKept(self.keep, self.folder.recordings)
        for row in journal.rows() if self.keep.kind == "worst" else ():
            worst.add(row)
        scratch = self.folder.scratch.absolute() if executor.is_local else None
        work = Flying(self.keep, self.folder.recordings.absolute(), scratch)
        watch.begin(self.design.count, len(landed))
        chunks = self.design.chunks(landed, executor.workers)
        with closing(executor.results(work, chunks)) as answers:
            for known in answers:
                rows = [self._row(flight, answer) for flight, answer in known]
                journal.add(rows)
                for row in rows:
                    worst.add(row)
                    watch.landed(row)

    def _row(self, flight: Flight, answer: Row | Lost) -> Row:
        """That of a flight; of one that took its process with it, and could not tidy up, a row of that."""
        if not isinstance(answer, Lost):
            return answer
        for left in self.folder.scratch.glob(f"{scratch_name(flight)}*"):
            shutil.rmtree(left, ignore_errors=True)
        return RowMaker(flight).lost(answer)
