"""A campaign that stops and goes on: every flight once, and the same table as one that was never stopped."""

import json
from contextlib import closing
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from sim.campaign.columns import NOT_REPRODUCED
from sim.campaign.executor import Loss, Lost
from sim.campaign.journal import Journal
from sim.campaign.pool import LocalPool
from sim.errors import CampaignError
from sim.provenance import source_sha256

HOP = Path(__file__).parent.parent / "scenarios" / "hop.toml"
SEVERITIES = "turbulence.severity=0,5"


class Stops:
    """An executor that something ends after so many flights; the flight that it is at is lost."""

    workers, is_local = 1, True

    def __init__(self, here, count, error):
        self._here, self._count, self._error = here, count, error

    def results(self, work, chunks):
        with closing(self._here.results(work, chunks)) as answers:
            for number, answer in enumerate(answers):
                if number == self._count:
                    raise self._error
                yield answer


def without_times(path):
    return pq.read_table(path).drop_columns(list(NOT_REPRODUCED))


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The folder of a campaign that two processes flew without being stopped."""
    from sim.campaign.campaign import Campaign
    from sim.campaign.design import Design
    from sim.campaign.flight import Origin
    from sim.campaign.folder import CampaignFolder
    from sim.campaign.keeping import Keep
    from sim.campaign.progress import Progress
    from sim.campaign.variation import parse_variations

    design = Design.of(Origin.of(str(HOP)), parse_variations([SEVERITIES]), 3)
    folder = CampaignFolder(tmp_path_factory.mktemp("whole"))
    Campaign(design, folder, Keep.parse("worst:2")).fly(LocalPool(2, 60.0), Progress(), pytest.fail)
    return folder


def test_it_does_not_matter_how_often_it_stops_nor_who_flies(campaign, fly, here, whole):
    stopped = campaign(SEVERITIES, runs=3, keep="worst:2")
    with pytest.raises(KeyboardInterrupt):
        fly(stopped, Stops(here, 1, KeyboardInterrupt()))
    assert pq.read_table(stopped.folder.table).num_rows == 1
    for error in (OSError(28, "No space left on device"), CampaignError("no more")):
        with pytest.raises(CampaignError):
            fly(stopped, Stops(here, 2, error))
    assert len(here.done) == 8  # of which three were lost on the way
    fly(stopped, again := type(here)())
    assert len(again.done) == 1
    assert without_times(stopped.folder.table).equals(without_times(whole.table))
    kept = {path.name: path.read_bytes() for path in whole.recordings.iterdir()}
    assert len(kept) == 2
    assert {path.name: path.read_bytes() for path in stopped.folder.recordings.iterdir()} == kept
    fly(stopped, idle := type(here)())
    assert idle.done == []
    assert not stopped.folder.scratch.exists()


def test_more_runs_go_on_and_fewer_are_refused(campaign, fly, here, rows):
    fly(campaign(SEVERITIES, runs=1))
    fly(campaign(SEVERITIES, runs=2))
    assert here.done == [0, 1, 2, 3]
    found = [(row["run"], row["seed"], row["vary.turbulence.severity"]) for row in rows(campaign())]
    assert found == [(0, 7, 0), (1, 7, 5), (2, 8, 0), (3, 8, 5)]
    with pytest.raises(CampaignError, match="begun with --runs 2"):
        fly(campaign(SEVERITIES, runs=1))


def test_what_is_given_for_all_is_in_each_row_and_belongs_to_the_campaign(campaign, fly, here, rows):
    given = ("hazard.corridor_m=400", "seed=30")
    fly(made := campaign(SEVERITIES, runs=1, given=given))
    found = rows(made)
    assert [row["overrides"] for row in found] == [
        ["hazard.corridor_m=400", f"turbulence.severity={severity}"] for severity in (0, 5)
    ]
    assert [row["vary.turbulence.severity"] for row in found] == [0, 5]
    assert [row["seed"] for row in found] == [30, 30]
    assert not any(name.startswith("vary.hazard") for name in found[0])
    with pytest.raises(CampaignError, match=r"with --set hazard\.corridor_m=400, not nothing"):
        fly(campaign(SEVERITIES, runs=1, given=given[1:]))
    with pytest.raises(CampaignError, match="with --seed 30, not 7"):
        fly(campaign(SEVERITIES, runs=1, given=given[:1]))
    fly(campaign(SEVERITIES, runs=1, given=given))
    assert here.done == [0, 1]


def test_a_row_says_which_source_made_it(campaign, fly, rows):
    fly(made := campaign(runs=1))
    assert rows(made)[0]["source_sha256"] == source_sha256()
    assert made.folder.manifest.read_text().count(source_sha256()) == 1


def test_another_campaign_does_not_go_on_in_its_folder(campaign, fly, here, tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(HOP.read_text())
    fly(campaign(SEVERITIES, runs=1, scenario=path))
    with pytest.raises(CampaignError, match=r"--vary turbulence\.severity=0,5, not nothing"):
        fly(campaign(runs=1, scenario=path))
    with pytest.raises(CampaignError, match="--keep none, not all; give it as it was"):
        fly(campaign(SEVERITIES, runs=1, keep="all", scenario=path))
    path.write_text(path.read_text().replace("altitude_m", "altitude_m") + "# another line\n")
    with pytest.raises(CampaignError, match=r"mine.toml is not the one.*kept as scenario.toml"):
        fly(campaign(SEVERITIES, runs=1, scenario=path))
    assert here.done == [0, 1]


def test_a_file_of_the_scenario_that_has_changed_is_noticed(campaign, fly, own, here):
    mine = own()
    vary = f'aircraft.model="{mine}",aerosonde'
    fly(campaign(vary, runs=1))
    fly(campaign(vary, runs=1))
    (mine / "aircraft.toml").touch()  # which changes nothing
    fly(campaign(vary, runs=1))
    with (mine / "aircraft.toml").open("a") as file:
        file.write("# not the same any more\n")
    with pytest.raises(CampaignError, match=r"aircraft\.toml has changed since"):
        fly(campaign(vary, runs=1))
    (mine / "new.xml").touch()
    with pytest.raises(CampaignError, match=r"aircraft\.toml has changed|new.xml is new"):
        fly(campaign(vary, runs=1))
    assert here.done == [0, 1]


def test_two_at_once_are_refused(campaign, fly):
    one = campaign(runs=1)
    fly(one)
    with closing(Journal(one.folder.journal)), pytest.raises(CampaignError, match="by another process"):
        fly(campaign(runs=1))
    fly(campaign(runs=1))


def test_a_flight_that_was_lost_has_a_row_and_leaves_nothing_behind(campaign, fly, rows):
    made = campaign(runs=2)

    class Loses:
        workers, is_local = 1, True

        def results(self, _, chunks):
            for chunk in chunks:
                for flight in chunk:
                    (made.folder.scratch / f"galeway-{flight.run}-x").mkdir()
                    yield [(flight, Lost(Loss.TIMED_OUT, "not done after 1 s", 1.0))]
                    assert not list(made.folder.scratch.iterdir())

    fly(made, Loses())
    assert [(row["outcome"], row["reason"], row["arrived"]) for row in rows(made)] == [
        ("timed_out", "not done after 1 s", None)
    ] * 2


def test_a_folder_that_cannot_be_is_refused(campaign, fly, tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(CampaignError, match="choose another --out"):
        fly(campaign(folder=tmp_path / "file"))
    with pytest.raises(CampaignError, match="choose another --out"):
        fly(campaign(folder=tmp_path / "file" / "inner"))


def test_the_file_of_a_campaign_explains_itself(whole):
    metadata = pq.read_schema(whole.table).metadata
    assert metadata[b"galeway.scenario"] == HOP.read_bytes()
    assert b'"vary":["turbulence.severity=0,5"]' in metadata[b"galeway.campaign"]
    table = pq.read_table(whole.table)
    assert table["vary.turbulence.severity"].to_pylist() == [0, 5] * 3
    assert table["samples"].type == "int64"
    kept = [name for name in table["recording"].to_pylist() if name]
    assert sorted(kept) == sorted(f"recordings/{path.name}" for path in whole.recordings.iterdir())


def test_another_version_is_told(campaign, fly):
    made = campaign(runs=1)
    assert fly(made) == []
    text = made.folder.manifest.read_text()
    made.folder.manifest.write_text(text.replace('"galeway": "', '"galeway": "0.0.'))
    (told,) = fly(campaign(runs=2))
    assert told.startswith("galeway was 0.0.")
    assert fly(campaign(runs=2)) == []


def test_a_campaign_that_is_being_flown_is_reported_as_far_as_its_table_goes(campaign, fly):
    made, told = campaign(runs=1), []
    fly(made)
    with closing(Journal(made.folder.journal)) as journal:
        assert made.folder.read_table(told.append).num_rows == 1
        made.folder.table.unlink()
        with pytest.raises(CampaignError, match="by another process"):
            made.folder.read_table(told.append)
        journal.add([{**next(journal.rows()), "run": 1}])
    assert len(told) == 1
    assert "by another process" in told[0]
    assert made.folder.read_table(pytest.fail).num_rows == 2
    assert made.folder.read_summary(pytest.fail).all.flights == 2


def test_what_is_no_campaign_is_refused(campaign, fly, tmp_path):
    made = campaign(runs=1)
    with pytest.raises(CampaignError, match="there is no campaign in"):
        made.folder.read_table(pytest.fail)
    fly(made)
    made.folder.manifest.write_text("{")
    with pytest.raises(CampaignError, match="is damaged"):
        fly(campaign(runs=1))


def test_a_folder_of_an_older_version_is_gone_on_with(campaign, fly, here, rows):
    """Without all that came later: keys of its description, columns of its rows and its table."""
    fly(made := campaign(SEVERITIES, runs=1))
    older = {"set", "source_sha256"}
    about = json.loads(made.folder.manifest.read_bytes())
    assert older <= about.keys()
    made.folder.manifest.write_text(json.dumps({key: about[key] for key in about.keys() - older}))
    with closing(Journal(made.folder.journal)) as journal:
        landed = list(journal.rows())
    made.folder.journal.unlink()
    with closing(Journal(made.folder.journal)) as journal:
        journal.add([{key: row[key] for key in row.keys() - older} for row in landed])
    table = pq.read_table(made.folder.table)
    pq.write_table(table.drop_columns(["source_sha256"]), made.folder.table)
    assert made.folder.read_summary(pytest.fail).all.flights == 2
    fly(campaign(SEVERITIES, runs=2))
    assert here.done == [0, 1, 2, 3]
    assert [row["source_sha256"] for row in rows(made)] == [None, None, source_sha256(), source_sha256()]
    assert older <= json.loads(made.folder.manifest.read_bytes()).keys()
    with pytest.raises(CampaignError, match="begun with --set nothing, not limits"):
        fly(campaign(SEVERITIES, runs=2, given=("limits=[]",)))


@pytest.mark.parametrize("key", ["first_seed", "files", "keep"])
def test_a_folder_that_cannot_be_gone_on_with_is_told_in_one_message(campaign, fly, key):
    fly(made := campaign(runs=1))
    about = json.loads(made.folder.manifest.read_bytes())
    del about[key]
    made.folder.manifest.write_text(json.dumps(about))
    for call in (lambda: fly(campaign(runs=2)), lambda: made.folder.read_summary(pytest.fail)):
        with pytest.raises(CampaignError, match=f"`{key}`.*another version wrote it, .*name another folder"):
            call()
