"""The command, on small maps."""

import re
import sys

import numpy as np
import pytest
from PIL import Image

from sim.cli import main
from sim.cli_reproduce import _Progress
from sim.reproduce.arrivals_by_policy import figures_of
from sim.reproduce.costs import costs_by_day
from sim.reproduce.figure3 import first_days, verdict
from sim.reproduce.job import Asked, commands_of

LARGEST_BYTES = 100_000


@pytest.fixture
def galeway(monkeypatch, capsys):
    """Runs the command in this process: (*arguments) -> exit code, output, errors."""

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["galeway", "reproduce", *map(str, arguments)])
        try:
            main()
            code = 0
        except SystemExit as stopped:
            code = stopped.code
        told = capsys.readouterr()
        return code, told.out, told.err

    return run


def test_a_quick_run_makes_the_page_its_pictures_and_goes_on_where_it_was(galeway, tmp_path):
    page = tmp_path / "docs" / "paper.md"
    parts = ("figure2", "figure3", "figure4", "--quick", "--days", "2", "--out", tmp_path / "kept")
    code, out, err = galeway(*parts, "--page", page)
    assert (code, out.strip()) == (0, str(page))
    assert "figure2: 2 of 2" in err
    text = page.read_text()
    assert "forecasts.md)" in text
    assert "](forecasts.md)" not in text  # since it is not beside this page
    assert "Of 2 days alone intervals and verdicts mean little" in text
    assert "misses the aim" not in text
    assert "blurred by 1 cell |" in text
    assert "![Safe arrivals on two days](paper/figure3_two_days.png)" in text
    for part in ("figure2", "figure3", "figure4"):
        assert f"galeway reproduce {part} --days 2 --seed 1 --quick" in text
    pictures = re.findall(r"!\[.+\]\((.+)\)", text)
    assert len(pictures) == 4
    for name in pictures:
        picture = page.parent / name
        assert picture.stat().st_size < LARGEST_BYTES
        with Image.open(picture) as opened:
            assert opened.size[0] > 500
    kept = sorted((tmp_path / "kept" / "results").iterdir())
    times = [path.stat().st_mtime_ns for path in kept]
    kept[0].unlink()
    (page.parent / "forecasts.md").touch()
    code, _, err = galeway(*parts, "--page", page)
    linked = text.replace("project's model (docs/forecasts.md)", "[project's model](forecasts.md)")
    assert (code, page.read_text()) == (0, linked)
    assert len(re.findall(r": 1 of 2\n", err)) == 1  # the one that was missing
    assert [path.stat().st_mtime_ns for path in kept[1:]] == times[1:]


def test_matrices_of_one_s_own(galeway, tmp_path):
    truth = np.zeros((2, 4, 12, 20), dtype=np.uint8)
    truth[:, :, 3:12, 9] = 1
    truth[1, 2:, 0:3, 9] = 1
    forecast = np.roll(truth, -1, axis=3)
    members = np.stack([truth, forecast], axis=1)
    np.savez(tmp_path / "own.npz", truth=truth, forecast=forecast, members=members)
    own = ("--hazards", tmp_path / "own.npz", "--key", "truth", "--forecast", tmp_path / "own.npz")
    own += ("--forecast-key", "forecast", "--start", "5,2", "--out", tmp_path, "--steps-per-stage", "12")
    code, _, _ = galeway(*own, "--members", "members", "--goal", "5,17", "--goal", "1,16")
    assert code == 0
    text = (tmp_path / "paper.md").read_text()
    assert "survival or abstain" in text
    assert "survival, replanned |" not in text.split("safe arrival")[1]
    code, _, err = galeway(*own, "--goal", "5,17", "flown")
    assert (code, "nothing to fly" in err) == (2, True)
    code, _, err = galeway(*own, "--goal", "5,40")
    assert (code, "off the grid" in err) == (2, True)
    keyless = [part for at, part in enumerate(own) if at not in (6, 7)]
    code, _, err = galeway(*keyless, "--goal", "5,17")
    assert (code, "holds truth, forecast, members; name one with --forecast-key\n" in err) == (2, True)
    np.save(tmp_path / "other.npy", truth[:, :, :-1])
    wrong = [tmp_path / "other.npy" if at == 5 else part for at, part in enumerate(own)]
    code, _, err = galeway(*wrong[:6], *wrong[8:], "--goal", "5,17")
    assert (code, "give a forecast for each" in err) == (2, True)


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("figure5",), "choose of figure2"),
        (("--seed", "995"), "tuned on"),
        (("--days", "0"), "1<=x"),
        (("--start", "1,2"), "belongs to --hazards"),
        (("--hazards", "none.npz"), "needs --forecast"),
        (("--hazards", "none.npz", "--days", "3"), "seeded days"),
        (("--hazards", "no.npz", "--forecast", "no.npz", "--start", "1,2", "--goal", "3"), "ROW,COLUMN"),
        (("--hazards", "no.npz", "--forecast", "no.npz", "--start", "1,2", "--goal", "3,4"), "cannot read"),
    ],
)
def test_what_makes_no_sense_is_refused_before_anything_is_made(galeway, tmp_path, arguments, told):
    code, _, err = galeway(*arguments, "--out", tmp_path / "kept")
    assert code == 2
    assert told in err
    assert not list(tmp_path.rglob("*.json"))


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("--out", "file"), "cannot write to file/results: Not a directory; choose another --out"),
        (
            ("--out", "kept", "--page", "file/paper.md"),
            "cannot write to file: it is a file; choose another --page",
        ),
        (("--out", "kept", "--page", "kept"), "give one such as kept/paper.md"),
    ],
)
def test_where_nothing_can_be_written_is_told_before_anything_is_made(
    galeway, tmp_path, monkeypatch, arguments, told
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").touch()
    code, _, err = galeway("--quick", "--days", "1", *arguments)
    assert code == 2
    assert told in err
    assert not list(tmp_path.rglob("*.json"))


def test_a_stopped_run_says_that_it_goes_on(galeway, tmp_path, monkeypatch):
    def stopped(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(_Progress, "__call__", stopped)
    code, _, err = galeway("figure2", "--quick", "--out", tmp_path)
    assert code == 130
    assert f"kept in {tmp_path / 'results'}, and the same command goes on" in err


def test_a_file_is_told_of_each_tenth(capsys):
    progress = _Progress()
    for done in range(3, 289):
        progress("flown", done, 288)
    told = capsys.readouterr().err.splitlines()
    assert (told[0], told[-1], len(told)) == ("flown: 3 of 288", "flown: 288 of 288", 11)


@pytest.mark.parametrize(
    ("days", "quick", "given", "flown"),
    [(30, False, None, 12), (2, False, None, 2), (30, True, None, 1), (2, True, 5, 5), (2, False, 20, 20)],
)
def test_days_are_flown_as_many_as_there_is_time_for(tmp_path, days, quick, given, flown):
    asked = Asked(
        parts=(),
        days=days,
        flown_days=given,
        seed=4,
        quick=quick,
        replan=True,
        own=None,
        out=tmp_path,
        page=None,
        workers=1,
    )
    assert asked.flown == range(4, 4 + flown)
    command = f"galeway reproduce flown --flown-days {flown} --seed 4" + quick * " --quick"
    assert commands_of(asked)["flown"] == command


def test_few_days_are_counted_in_words():
    assert [first_days(days) for days in (1, 2, 5, 30)] == ["one day", "two days", "five days", "five days"]


def fates(**policies):
    """Rows of a day: policy to a list of (fate, steps)."""
    return {
        name: [{"fate": fate, "steps": steps, "moves": steps, "score": float(steps)} for fate, steps in rows]
        for name, rows in policies.items()
    }


DAY = fates(
    score=[("safe", 10), ("lost", 10), ("no route", 0), ("safe", 20)],
    survival=[("safe", 11), ("safe", 12), ("lost", 9), ("safe", 20)],
    oracle=[("safe", 9), ("safe", 9), ("safe", 9), ("safe", 9)],
)


def test_the_gap_and_the_longer_flights_are_counted_as_they_say():
    found = figures_of([DAY, DAY], "survival")
    assert (found.safe.value, found.lost.value, found.not_flown.value) == (0.75, 0.25, 0.0)
    assert found.more_than_score.value == 0.25
    assert found.closed.value == 0.5  # of 4 - 2 goals one
    assert found.longer.value == pytest.approx(31 / 30 - 1)
    assert figures_of([DAY], "score").closed.value == 0.0


def test_the_verdict_says_whether_the_aim_is_met():
    met = verdict({"here": {"survival": figures_of([DAY, DAY], "survival")}}, days=10)
    assert met[0].startswith("- *survival* meets the aim")
    slow = DAY | fates(survival=[("safe", 12), ("safe", 12), ("lost", 9), ("safe", 22)])
    of_slow = {"here": {"survival": figures_of([slow, slow], "survival")}}
    assert "misses the aim" in verdict(of_slow, days=10)[0]
    assert "cannot be judged by 9 days. here: 50 %" in verdict(of_slow, days=9)[0]


def test_costs_are_of_the_goals_that_both_have_a_route_to():
    day = fates(bfs=[("safe", 4), ("lost", 6), ("safe", 1)], score=[("safe", 10), ("safe", 10), ("safe", 3)])
    del day["bfs"][2]["score"]
    costs = costs_by_day([day, day | {"bfs": [{"fate": "no route"}] * 3}])
    assert (costs.days.tolist(), costs.goals.tolist()) == ([0], [2])
    assert (costs.bfs.tolist(), costs.staged.tolist()) == ([5.0], [10.0])
