"""One flight of a campaign made again from its row, and held against it."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pyarrow.compute as pc

from sim.campaign.flight import Flight
from sim.campaign.folder import CampaignFolder
from sim.campaign.manifest import Manifest
from sim.campaign.named_files import marks_of, named_files
from sim.campaign.progress import counted
from sim.campaign.row import Row, made_by
from sim.errors import CampaignError
from sim.job import Files


@dataclass(frozen=True, slots=True)
class Again:
    """A flight and its row."""

    flight: Flight
    row: Row

    @classmethod
    def of(cls, folder: Path, run: int, tell: Callable[[str], object]) -> Again:
        """From a campaign's folder.

        Raises:
            CampaignError: if there is no such flight, or its scenario or files are not what they were.
        """
        place = CampaignFolder(folder)
        manifest, table = Manifest.load(place.manifest), place.read_table(tell)
        rows = table.filter(pc.equal(table["run"], run)).to_pylist()
        if not rows:
            raise CampaignError(
                f"run {run} is not among the {counted(table.num_rows)} in {folder} that have landed; there "
                f"are to be {manifest.flights}, from 0 on"
            )
        (row,) = rows
        flight = Flight(run, place.origin(manifest), tuple(row["overrides"]), row["seed"])
        if flight.origin.sha256 != row["scenario_sha256"]:
            raise CampaignError(
                f"{place.scenario} is not the scenario that run {run} was flown with; put it back"
            )
        marks = marks_of(named_files(flight.load()), manifest.files)
        manifest.require_same_files({**manifest.files, **marks}, folder)
        return cls(flight, row)

    @property
    def is_recorded(self) -> bool:
        """Whether the campaign has a recording, or its hash, that another can be held against."""
        return self.row["recording_sha256"] is not None

    def difference(self, out: Path) -> str:
        """How the recording in a folder differs from the campaign's; empty if it does not."""
        mcap = Files(out).mcap
        if mcap.exists():
            with mcap.open("rb") as file:
                if hashlib.file_digest(file, "sha256").hexdigest() == self.row["recording_sha256"]:
                    return ""
        what = "the recording is not the same as in the campaign" if mcap.exists() else "it was not flown now"
        before = {name: self.row.get(name) for name in made_by()}  # older rows name less
        other = [
            f"{name} {before[name] or 'unknown'}, now {now or 'unknown'}"
            for name, now in made_by().items()
            if before[name] is not None and before[name] != now
        ]
        return f"{what}; " + (
            f"it was made with {'; '.join(other)}" if other else "all versions are the same"
        )
