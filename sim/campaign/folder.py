"""The folder of a campaign: what lies where, begun or gone on with, and its table."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path

import msgspec
import pyarrow as pa
import pyarrow.parquet as pq

from sim.campaign.columns import schema, write_table
from sim.campaign.design import Design
from sim.campaign.durable import durably
from sim.campaign.flight import Origin
from sim.campaign.journal import Journal
from sim.campaign.keeping import Keep
from sim.campaign.manifest import Manifest
from sim.campaign.summary import Summary, summarize
from sim.campaign.variation import parse_variations
from sim.errors import CampaignError


@dataclass(frozen=True, slots=True)
class CampaignFolder:
    """Where a campaign has its files."""

    path: Path

    @property
    def manifest(self) -> Path:
        """What the campaign is."""
        return self.path / "campaign.json"

    @property
    def scenario(self) -> Path:
        """The scenario's text when it was begun."""
        return self.path / "scenario.toml"

    @property
    def journal(self) -> Path:
        """Rows as they land."""
        return self.path / "journal.sqlite"

    @property
    def table(self) -> Path:
        """All rows."""
        return self.path / "flights.parquet"

    @property
    def summary(self) -> Path:
        """What comes of them."""
        return self.path / "summary.json"

    @property
    def recordings(self) -> Path:
        """Those that are kept."""
        return self.path / "recordings"

    @property
    def scratch(self) -> Path:
        """Recordings of flights in the air."""
        return self.path / "scratch"

    @contextmanager
    def begun(self, design: Design, keep: Keep, tell: Callable[[str], object]) -> Iterator[Journal]:
        """Begin a campaign, or go on with the one that is there; nobody else can for that time.

        Raises:
            CampaignError: if the folder is another campaign's, or in use, or cannot be written.
        """
        try:
            self.path.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise CampaignError(
                f"cannot write to {self.path}: {error.strerror}; choose another --out"
            ) from error
        with closing(Journal(self.journal)) as journal:
            earlier = Manifest.load(self.manifest) if self.manifest.exists() else None
            now = Manifest.of(design, keep, earlier)
            if earlier is not None:
                earlier.require_same(now, self.path)
                if earlier.made_by != now.made_by:
                    tell(
                        f"galeway was {earlier.made_by} when the campaign was last flown, and is "
                        f"{now.made_by} now; each row names its own"
                    )
            else:
                with durably(self.scenario) as file:
                    file.write(design.origin.toml.encode())
            now.save(self.manifest)
            shutil.rmtree(self.scratch, ignore_errors=True)
            self.scratch.mkdir()
            self.recordings.mkdir(exist_ok=True)
            for partial in self.recordings.glob("*.partial-*"):
                partial.unlink()
            try:
                yield journal
            finally:
                shutil.rmtree(self.scratch, ignore_errors=True)

    def origin(self, manifest: Manifest) -> Origin:
        """The scenario as it was when the campaign was begun."""
        try:
            toml = self.scenario.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise CampaignError(f"cannot read {self.scenario} ({error}); put it back") from error
        return Origin(toml, manifest.scenario, Path(manifest.folder))

    def write_results(self, journal: Journal) -> None:
        """Make the table of all that has landed, and the summary of it."""
        manifest = Manifest.load(self.manifest)
        about = {
            "galeway.campaign": msgspec.json.encode(manifest).decode(),
            "galeway.scenario": self.scenario.read_text(encoding="utf-8"),
        }
        found = {path.name for path in self.recordings.glob("*.mcap")}
        names = {run: Keep.path(Path(), run).name for run in journal.runs()}
        kept = {run: f"{self.recordings.name}/{name}" for run, name in names.items() if name in found}
        columns = schema(parse_variations(manifest.vary), about)
        write_table(self.table, journal.rows(), columns, kept)
        with durably(self.summary) as file:
            file.write(self._summary(manifest).to_json())

    def read_table(self, tell: Callable[[str], object]) -> pa.Table:
        """The table, brought up to what has landed if that can be.

        Raises:
            CampaignError: if there is no campaign, or nothing to read of it yet.
        """
        Manifest.load(self.manifest)
        try:
            with closing(Journal(self.journal)) as journal:
                if not self.table.exists() or pq.read_metadata(self.table).num_rows != len(journal):
                    self.write_results(journal)
        except CampaignError as error:
            if not self.table.exists():
                raise
            tell(f"{error}; this is what had landed when {self.table.name} was written")
        return pq.read_table(self.table)

    def read_summary(self, tell: Callable[[str], object]) -> Summary:
        """What comes of the table.

        Raises:
            CampaignError: see `read_table`.
        """
        self.read_table(tell)
        return self._summary(Manifest.load(self.manifest))

    def _summary(self, manifest: Manifest) -> Summary:
        table, keep = pq.read_table(self.table), Keep.parse(manifest.keep)
        return summarize(table, self.path, manifest.scenario, manifest.flights, keep)
