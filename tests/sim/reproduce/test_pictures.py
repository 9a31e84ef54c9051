"""What the pictures' axes show."""

import numpy as np
import pytest

from sim.reproduce import figure2, figure4, figure_flown
from sim.reproduce.costs import DayCosts
from sim.reproduce.days_judged import DayTask
from sim.reproduce.one_stage import longest_pair
from sim.reproduce.sources import SeededDays
from sim.reproduce.tuning import TUNED_SMALL


@pytest.fixture
def drawn(monkeypatch):
    """The figures that a module draws, in place of their files: (module) -> list of them."""

    def kept(module):
        figures = []
        monkeypatch.setattr(module, "save", lambda figure, _: figures.append(figure))
        return figures

    return kept


def test_the_map_of_one_stage_ends_where_the_weather_does(drawn, small, tmp_path):
    figures = drawn(figure2)
    pair, hazard = longest_pair(DayTask(SeededDays(small, 1.0), 3, ("bfs", "score"), TUNED_SMALL))
    figure2.draw(pair, hazard, tmp_path / "map.png", 6.0)
    on_map = figures[0].axes[0]
    rows, columns = hazard.shape
    (west, east), (south, north) = on_map.get_xlim(), on_map.get_ylim()
    assert min(west, south) == -0.5  # there was less room than it asks for
    assert east <= columns - 0.5
    assert north <= rows - 0.5
    cells = np.array([*pair.bfs.cells, *pair.staged.cells])
    assert (cells.min(axis=0) >= (south, west)).all()
    assert (cells.max(axis=0) <= (north, east)).all()


@pytest.mark.parametrize("days", [1, 2, 3, 12, 30])
def test_the_days_of_figure_4_are_whole(drawn, tmp_path, days):
    figures = drawn(figure4)
    values = np.linspace(2.0, 3.0, days)
    figure4.draw(DayCosts(np.arange(days), values, values + 1.0, np.ones(days, int)), tmp_path / "cost.png")
    axes = figures[0].axes[0]
    low, high = axes.get_xlim()
    ticks = [tick for tick in axes.get_xticks() if low <= tick <= high]
    assert ticks
    assert all(tick == round(tick) for tick in ticks)


def test_markers_at_the_ends_have_room(drawn, tmp_path):
    rows = [
        {"seed": 1, "scale": 1.0, "policy": policy, "goal": 0, "planned": "safe", "flown": fate}
        for policy, fate in (("bfs", "lost"), ("survival", "safe"))
    ]
    figures = drawn(figure_flown)
    figure_flown.draw(rows, figure_flown.ranked(rows, {1.0: "published"}), tmp_path / "flown.png")
    figure = figures[0]
    figure.draw_without_rendering()
    panel = figure.axes[0]
    left, right = (panel.transData.transform((share, 0.0))[0] for share in (0.0, 100.0))
    marker_px = (7.0 / 2.0 + 1.0) * figure.dpi / 72.0
    assert panel.bbox.x0 < left - marker_px
    assert panel.bbox.x1 > right + marker_px
