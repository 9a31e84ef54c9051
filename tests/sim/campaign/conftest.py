"""A flight of half a minute, campaigns of it, and an executor that needs no processes."""

from pathlib import Path

import pytest

from sim.campaign.campaign import Campaign
from sim.campaign.design import Design
from sim.campaign.flight import Flight, Origin
from sim.campaign.folder import CampaignFolder
from sim.campaign.keeping import Keep
from sim.campaign.progress import Progress
from sim.campaign.variation import parse_variations

HOP = Path(__file__).parent.parent / "scenarios" / "hop.toml"


class Here:
    """Does all tasks in this process, one by one, and remembers which."""

    workers, is_local = 1, True

    def __init__(self):
        self.done = []

    def results(self, work, chunks):
        for chunk in chunks:
            for task in chunk:
                self.done.append(task.run)
                yield [(task, work(task))]


@pytest.fixture
def here():
    return Here()


@pytest.fixture
def hop():
    """The short flight: (*overrides, seed) -> Flight."""

    def made(*overrides, seed=7, run=0, scenario=HOP):
        return Flight(run, Origin.of(str(scenario)), overrides, seed)

    return made


@pytest.fixture
def campaign(tmp_path):
    """A campaign of it: (*vary, runs, keep, scenario, folder, given) -> Campaign."""

    def made(*vary, runs=2, keep="none", scenario=HOP, folder=tmp_path / "campaign", given=()):
        design = Design.of(Origin.of(str(scenario)), parse_variations(vary), runs, given)
        return Campaign(design, CampaignFolder(folder), Keep.parse(keep))

    return made


@pytest.fixture
def fly(here):
    """Flies a campaign here: (campaign, executor) -> what was told."""

    def flown(campaign, executor=here):
        told = []
        campaign.fly(executor, Progress(), told.append)
        return told

    return flown


@pytest.fixture
def rows():
    """The rows of a campaign's table: (campaign) -> list."""

    def read(campaign):
        return campaign.folder.read_table(pytest.fail).to_pylist()

    return read
