"""What a campaign is, in its folder, so that it is not gone on with as another one."""

from __future__ import annotations

from pathlib import Path

import msgspec
from msgspec import Struct

from sim.campaign.design import Design
from sim.campaign.durable import durably
from sim.campaign.keeping import Keep
from sim.campaign.named_files import FileMark, marks_of
from sim.errors import CampaignError
from sim.provenance import git_revision, source_sha256, versions

REMEDY = "give it as it was to go on, or name another --out"


class Manifest(Struct, frozen=True):
    """`scenario`: the name or path that was given; `folder`: what its paths start from.

    What was added later has a value that says what a campaign was before: it can be gone on with.
    """

    scenario: str
    scenario_sha256: str
    folder: str
    vary: tuple[str, ...]
    runs: int
    flights: int
    first_seed: int
    keep: str
    files: dict[str, FileMark]
    galeway: str
    git: str
    set: tuple[str, ...] = ()
    source_sha256: str = ""

    @classmethod
    def of(cls, design: Design, keep: Keep, earlier: Manifest | None) -> Manifest:
        """Of a campaign that is begun or gone on with; files that were not touched are not read again."""
        paths = {path for combination in design.combinations for path in combination.files}
        return cls(
            scenario=design.origin.source,
            scenario_sha256=design.origin.sha256,
            folder=str(design.origin.folder),
            vary=tuple(map(str, design.variations)),
            runs=design.runs,
            flights=design.count,
            first_seed=design.first_seed,
            keep=str(keep),
            files=marks_of(sorted(paths), earlier.files if earlier else {}),
            galeway=versions()["galeway"],
            git=git_revision(),
            set=design.settings,
            source_sha256=source_sha256(),
        )

    @property
    def made_by(self) -> str:
        """The version of galeway; of its source, where there is no git."""
        return f"{self.galeway} {self.git or self.source_sha256[:12]}".strip()

    def require_same(self, now: Manifest, where: Path) -> None:
        """Pass if it is the same campaign now, or one with more runs.

        Raises:
            CampaignError: naming what is another.
        """
        if now.scenario_sha256 != self.scenario_sha256:
            raise CampaignError(
                f"the scenario {now.scenario} is not the one that the campaign in {where} was begun with, "
                f"which is kept as scenario.toml there; {REMEDY}"
            )
        for option, before, given in (
            ("--set", " ".join(self.set) or "nothing", " ".join(now.set) or "nothing"),
            ("--seed", str(self.first_seed), str(now.first_seed)),
            ("--vary", " ".join(self.vary) or "nothing", " ".join(now.vary) or "nothing"),
            ("--keep", self.keep, now.keep),
        ):
            if before != given:
                raise CampaignError(
                    f"the campaign in {where} was begun with {option} {before}, not {given}; {REMEDY}"
                )
        if now.runs < self.runs:
            raise CampaignError(
                f"the campaign in {where} was begun with --runs {self.runs}; it can be given more, "
                f"but not {now.runs}"
            )
        self.require_same_files(now.files, where)

    def require_same_files(self, now: dict[str, FileMark], where: Path) -> None:
        """Pass if the scenario's files have the content that they had.

        Raises:
            CampaignError: naming one that has not.
        """
        for path in sorted({*self.files, *now}):
            before, after = self.files.get(path), now.get(path)
            if before is None or after is None or before.sha256 != after.sha256:
                what = "is new" if before is None else "is gone" if after is None else "has changed"
                raise CampaignError(
                    f"{path} {what} since the campaign in {where} was begun, so its flights would not be "
                    f"comparable; {REMEDY}"
                )

    def save(self, path: Path) -> None:
        """Write it whole or not at all."""
        with durably(path) as file:
            file.write(msgspec.json.format(msgspec.json.encode(self), indent=1) + b"\n")

    @classmethod
    def load(cls, path: Path) -> Manifest:
        """Read it.

        Raises:
            CampaignError: if it cannot be read.
        """
        try:
            return msgspec.json.decode(path.read_bytes(), type=cls)
        except OSError as error:
            raise CampaignError(
                f"there is no campaign in {path.parent}: cannot read {path.name}, {error.strerror}; name the "
                "folder that --out named"
            ) from error
        except msgspec.ValidationError as error:
            raise CampaignError(
                f"{path} is not as galeway {versions()['galeway']} writes it ({error}): another version "
                "wrote it, or it was changed; use that version, or name another folder"
            ) from error
        except msgspec.DecodeError as error:
            raise CampaignError(f"{path} is damaged ({error}); name the folder of a campaign") from error
