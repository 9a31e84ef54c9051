import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.grid import Grid
from recordings.rerun_chart import Chart
from recordings.rerun_labels import HEIGHT_PX, arrange, labels, width_px

NOWHERE = np.full((1, 2), 1e9)


@pytest.fixture(scope="module")
def chart():
    bounds = (math.radians(angle_deg) for angle_deg in (29.0, 31.0, -91.0, -88.0))
    return Chart(Grid.covering(*bounds, rows=60, columns=80))


def boxes(chart, texts, middles):
    return [
        (middle / chart.px_km, np.array([width_px(text), HEIGHT_PX]) / 2.0)
        for text, middle in zip(texts, middles, strict=True)
        if middle is not None
    ]


@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 14))
@settings(max_examples=60, deadline=None)
def test_no_label_hides_another(chart, seed, count):
    rng = np.random.default_rng(seed)
    marks_km = chart.px_km * rng.uniform(0.0, 250.0, (count, 2))
    texts = ["x" * int(length) for length in rng.integers(2, 14, count)]
    placed = boxes(chart, texts, arrange(chart, marks_km, texts, NOWHERE, [7.0] * len(texts)))
    for i, (place, half) in enumerate(placed):
        for other, other_half in placed[:i]:
            assert np.any(abs(place - other) >= half + other_half - 1e-6)


def test_a_lone_mark_has_its_label_under_it_and_beside_a_line_if_one_runs_there(chart):
    mark_km = np.array([[10.0, 20.0]])
    (under,) = arrange(chart, mark_km, ["Port"], NOWHERE, [7.0])
    assert under[0] == pytest.approx(10.0)
    assert under[1] < 20.0
    line_km = mark_km + chart.px_km * np.column_stack([np.zeros(300), -np.arange(300)])
    (over,) = arrange(chart, mark_km, ["Port"], line_km, [7.0])
    assert over[1] > 20.0


def test_the_first_marks_are_served_first_and_one_without_room_has_no_label(chart):
    marks_km = np.zeros((4, 2))
    places = arrange(chart, marks_km, ["somewhere"] * 4, NOWHERE, [7.0] * 4)
    assert [place is None for place in places] == [False] * 2 + [True] * 2


def test_a_label_hangs_under_the_point_that_carries_it(chart):
    points = labels(chart, np.array([[3.0, 4.0]]), ["Port"], [(1, 2, 3)])
    ((east, south),) = points.positions.as_arrow_array().to_pylist()
    assert east == pytest.approx(3.0)
    assert south < -4.0
