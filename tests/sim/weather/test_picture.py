"""Pictures of weather: what is drawn where, the same every time, and files that cannot be."""

import math
from itertools import pairwise

import numpy as np
import pytest
from PIL import Image

from planner.errors import PlannerError
from planner.grid import Grid
from planner.windfield import WindField
from sim.weather.picture import MOST_PANELS, Panels, chosen_times, draw_weather, panels_of

GRID = Grid.covering(*map(math.radians, (26.0, 28.0, 179.0, 182.0)), rows=21, columns=31)


def wind(strong=True):
    east = np.zeros((3, *GRID.shape))
    east[:, 10:, 15:] = 30.0 if strong else 2.0
    return WindField(GRID, 3600.0 * np.arange(3), np.zeros_like(east), east)


def pixels(path):
    return np.asarray(Image.open(path).convert("RGB")).astype(int)


def reddish(picture):
    """Those of the line around what is over the threshold."""
    return (np.abs(picture - (0xD6, 0x27, 0x28)).max(axis=2) < 40).sum()


def test_what_is_over_the_threshold_is_outlined(tmp_path):
    for name, strong in (("calm", False), ("storm", True)):
        panels = panels_of(wind(strong), [0.0])
        draw_weather(tmp_path / f"{name}.png", panels, threshold_mps=15.0, title=name)
    calm, storm = (reddish(pixels(tmp_path / f"{name}.png")) for name in ("calm", "storm"))
    assert storm > calm + 300


def test_strong_wind_is_darker_where_it_blows(tmp_path):
    panels = Panels(GRID, np.zeros(1), panels_of(wind(), [0.0]).speed_mps)
    draw_weather(tmp_path / "speed.png", panels, threshold_mps=99.0, title="speed")
    grey = pixels(tmp_path / "speed.png").sum(axis=2)
    height, width = grey.shape
    calm = grey[int(0.6 * height), int(0.2 * width)]
    strong = grey[int(0.25 * height), int(0.7 * width)]  # north-east: up and right
    assert strong < calm - 50


def test_closures_are_hatched(tmp_path):
    closed = np.zeros((1, *GRID.shape), dtype=bool)
    for name, cells in (("open", None), ("closed", closed)):
        closed[:, 5:15, 5:20] = True
        draw_weather(
            tmp_path / f"{name}.png", panels_of(wind(False), [0.0], cells), threshold_mps=15.0, title="zones"
        )
    dark = [(pixels(tmp_path / f"{name}.png").max(axis=2) < 60).sum() for name in ("open", "closed")]
    assert dark[1] > dark[0] + 500


@pytest.mark.parametrize(
    ("count", "east_deg", "north_deg"),
    [(1, 2.0, 1.5), (1, 0.3, 2.0), (4, 2.0, 1.5), (4, 0.3, 2.0), (4, 12.0, 6.0)],
)
def test_the_names_of_meridians_do_not_run_into_each_other(count, east_deg, north_deg, monkeypatch, tmp_path):
    from matplotlib.figure import Figure

    figures = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_, **__: figures.append(figure))
    area = map(math.radians, (29.0, 29.0 + north_deg, -121.51, -121.51 + east_deg))
    grid = Grid.covering(*area, rows=20, columns=20)
    panels = Panels(grid, 3600.0 * np.arange(count), np.ones((count, *grid.shape)))
    draw_weather(tmp_path / "names.png", panels, threshold_mps=15.0, title="names")
    (figure,) = figures
    figure.draw_without_rendering()
    for axis in figure.axes[:count]:
        west, east = axis.get_xlim()
        ticks = [tick for tick in axis.get_xticklabels() if west <= tick.get_position()[0] <= east]
        spans = sorted((box.x0, box.x1) for box in (tick.get_window_extent() for tick in ticks))
        assert spans
        assert all(before[1] + 3.0 < after[0] for before, after in pairwise(spans))


def test_the_same_weather_gives_the_same_picture(tmp_path):
    for name in ("one.png", "other.png"):
        draw_weather(tmp_path / name, panels_of(wind(), [0.0, 3600.0, 7200.0]), threshold_mps=15.0, title="x")
    assert (tmp_path / "one.png").read_bytes() == (tmp_path / "other.png").read_bytes()


@pytest.mark.parametrize("count", [1, 2, 12, 13, 100])
def test_no_more_panels_than_can_be_looked_at(count):
    which = chosen_times(np.arange(float(count)))
    assert len(which) == min(count, MOST_PANELS)
    assert which[0] == 0
    assert which[-1] == count - 1
    assert (np.diff(which) > 0).all()


def test_a_time_that_the_wind_does_not_hold_is_refused():
    with pytest.raises(PlannerError, match="1970-01-01T05"):
        panels_of(wind(), [5 * 3600.0])


def test_each_column_names_its_meridians_once(monkeypatch, tmp_path):
    from matplotlib.figure import Figure

    figures = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_, **__: figures.append(figure))
    panels = Panels(GRID, 3600.0 * np.arange(6), np.ones((6, *GRID.shape)))
    draw_weather(tmp_path / "names.png", panels, threshold_mps=15.0, title="names")
    (figure,) = figures
    figure.draw_without_rendering()
    named = [any(tick.get_visible() for tick in axis.get_xticklabels()) for axis in figure.axes[:6]]
    assert named == [False, False, True, True, True, True]
