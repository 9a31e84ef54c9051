"""The dials turned on days of their own: what is chosen, and the page that says why."""

import sys
from itertools import chain

import pytest

from sim.cli import main
from sim.reproduce import job
from sim.reproduce.choosing import Tried, choose
from sim.reproduce.judged import judge_policies
from sim.reproduce.kept import Kept
from sim.reproduce.pool import executor_of
from sim.reproduce.sources import SeededDays
from sim.reproduce.trials import FlownDays, Trials
from sim.reproduce.tune import SETTINGS, Setting, turn
from sim.reproduce.tuning import Tuning
from sim.reproduce.worlds import FLOWN

FEW = Trials(
    betas=(1.0, 4.0), caps_cells=(3.0,), margins_cells=(1.0, 3.0), blurs_cells=(1.0,), prices=(0.0, 0.05)
)


@pytest.fixture
def setting(small):
    return Setting("A small size", small, SeededDays, range(3, 6), FEW, Tuning(margin_cells=3.0))


def rows(*fates, members=1.0):
    """Rows of (fate, steps)."""
    return [{"fate": fate, "steps": steps, "members_survived": members} for fate, steps in fates]


def tried(dials, *levels):
    return Tried(dials, levels)


def test_the_most_safe_arrivals_are_chosen_the_first_of_equals():
    score = [
        tried(Tuning(), rows(("safe", 10), ("lost", 9)), rows(("lost", 9), ("lost", 9))),
        tried(Tuning(), rows(("safe", 10), ("lost", 9)), rows(("safe", 9), ("lost", 9))),
        tried(Tuning(), rows(("safe", 10), ("safe", 9)), rows(("lost", 9), ("lost", 9))),
    ]
    found = choose({"score": score, "margins": score[::-1], "survival": score})
    assert found["score"].chosen is score[1]
    assert found["margins"].chosen is score[2]
    assert found["score"].gain(score[0], 2) == (0.25, 0.0, 0.5)


def test_survival_may_not_fly_much_longer_at_either_level():
    score = [tried(Tuning(), rows(("safe", 100), ("lost", 9)), rows(("safe", 100), ("lost", 9)))]
    long = tried(Tuning(price=0.0), rows(("safe", 100), ("safe", 9)), rows(("safe", 106), ("safe", 9)))
    brisk = tried(Tuning(price=0.1), rows(("safe", 104), ("safe", 9)), rows(("safe", 104), ("lost", 9)))
    found = choose({"score": score, "margins": score, "survival": [long, brisk]})
    assert found["survival"].chosen is brisk
    assert choose({"score": score, "margins": score, "survival": [long]})["survival"].chosen is long
    assert long.longer(score[0]) == [0.0, pytest.approx(0.06)]


def test_to_abstain_is_worth_the_aircraft_that_are_not_lost():
    doubtful = rows(("safe", 9), ("lost", 9), ("lost", 9), members=0.45)
    sure = rows(("safe", 9), ("no route", 0), ("lost", 9), members=0.65)
    found = choose(
        {policy: [tried(Tuning(), doubtful + sure)] for policy in ("score", "margins", "survival")}
    )
    chosen = found["abstain"].chosen
    assert chosen.dials.abstain_below == 0.5
    assert [row["fate"] for row in chosen.levels[0]] == ["abstained"] * 3 + ["safe", "no route", "lost"]


def test_each_value_is_tried_on_each_day_and_what_is_done_is_kept(setting, tmp_path):
    kept, told = Kept(tmp_path, executor_of(1)), []
    found = turn(setting, kept, lambda *progress: told.append(progress))
    assert told[-1] == ("A small size, twice those", 3, 3)
    assert [one.dials.price for one in found["survival"]] == [0.0, 0.05]
    cases = [setting.source(setting.world, 2.0).case(day) for day in setting.days]
    for policy, ones in found.items():
        for one in ones:
            alone = [judge_policies(case, (policy,), one.dials)[policy] for case in cases]
            assert one.levels[1] == list(chain.from_iterable(alone))
    times = {path: path.stat().st_mtime_ns for path in tmp_path.iterdir()}
    assert len(times) == 6
    assert turn(setting, kept, lambda *_: None) == found
    assert {path: path.stat().st_mtime_ns for path in tmp_path.iterdir()} == times


def test_the_flown_days_are_planned_as_they_are_flown_and_judged_on_the_grid():
    case = FlownDays(FLOWN, 1.0).case(501)
    assert case.outlook.flyable is not None
    assert case.truth.flyable is None  # a plan is safe, or not, where it is


def test_days_of_figures_are_never_tuned_on_and_the_other_way_round(monkeypatch, capsys, tmp_path):
    for setting in SETTINGS:
        for seed in (setting.days[0], setting.days[-1]):
            monkeypatch.setattr(
                sys,
                "argv",
                ["galeway", "reproduce", "--seed", str(seed), "--days", "1", "--out", str(tmp_path)],
            )
            with pytest.raises(SystemExit) as stopped:
                sys.exit(main())
            assert stopped.value.code == 2
            assert "that the policies were tuned on, seeds 1001 to 1012, for the flown part 501 to 600" in (
                capsys.readouterr().err
            )


def test_the_command_prints_the_tables_and_leaves_the_page(setting, monkeypatch, capsys, tmp_path):
    monkeypatch.setattr(job, "SETTINGS", (setting,))
    monkeypatch.setattr(sys, "argv", ["galeway", "reproduce", "--tune", "--out", str(tmp_path)])
    assert not main()
    text = capsys.readouterr().out
    assert (tmp_path / "tuning.md").read_text() == text
    assert "Seeds 3 to 5: 15 goals at each level." in text
    assert text.count("**chosen**") == 4
    (used,) = [line for line in text.splitlines() if line.startswith("| 3 | ")][:1]
    assert "used" in used
    assert "What is used was not among these." in text


@pytest.mark.parametrize("more", [("figure2",), ("--days", "3"), ("--no-replan",), ("--goal", "1,2")])
def test_what_has_nothing_to_do_with_tuning_is_refused(more, monkeypatch, capsys, tmp_path):
    monkeypatch.setattr(sys, "argv", ["galeway", "reproduce", "--tune", "--out", str(tmp_path), *more])
    with pytest.raises(SystemExit) as stopped:
        sys.exit(main())
    told = capsys.readouterr().err
    assert stopped.value.code == 2
    assert f"{more[0]} has nothing to do with --tune" in told or "--no-replan" in more
    assert "--tune" in told
    assert not list(tmp_path.rglob("*.json"))
