import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner.axis import EVERYWHERE, Axis
from planner.errors import BadFieldError, OutsideFieldError


def axis(nodes: list[float], margin: float = 0.0) -> Axis:
    return Axis("height", np.array(nodes), margin, lambda value: f"{value} m", "climb")


rising = st.lists(st.floats(-1e4, 1e4), min_size=1, max_size=8, unique=True).map(sorted)


@given(nodes=rising, value=st.floats(-2e4, 2e4))
def test_one_value_and_many_agree_and_both_agree_with_numpy(nodes: list[float], value: float) -> None:
    one = axis(nodes, EVERYWHERE)
    span = one.span(value)
    assert span.low <= value <= span.high
    weight = (value - span.low) * span.inverse
    assert 0.0 <= weight <= 1.0 + 1e-12
    values = np.arange(len(nodes)) ** 2.0
    scalar = values[span.first] * (1.0 - weight) + values[span.second] * weight
    first, second, weights = one.spread(np.array([value]))
    vector = values[first] * (1.0 - weights) + values[second] * weights
    assert scalar == pytest.approx(np.interp(value, nodes, values), abs=1e-6)
    assert vector[0] == pytest.approx(scalar, abs=1e-6)


def test_beyond_an_end_the_outermost_node_has_all_the_weight() -> None:
    one = axis([1.0, 2.0, 4.0], 0.5)
    assert one.span(0.6)[:2] == (0, 0)
    assert one.span(4.5)[:2] == (2, 2)
    assert one.span(4.5).inverse == 0.0
    first, second, weight = one.spread(np.array([0.5, 4.5]))
    assert [first[0], second[1]] == [0, 2]
    np.testing.assert_allclose(weight, [0.0, 1.0])


@pytest.mark.parametrize("value", [0.4, 4.6, math.nan, math.inf])
def test_values_beyond_the_margin_are_refused(value: float) -> None:
    one = axis([1.0, 2.0, 4.0], 0.5)
    message = rf"height {value} m, but the field covers 1\.0 m to 4\.0 m; climb"
    with pytest.raises(OutsideFieldError, match=message):
        one.span(value)
    with pytest.raises(OutsideFieldError, match=message):
        one.spread(np.array([2.0, value]))


def test_not_a_number_is_refused_even_with_a_margin_that_has_no_end() -> None:
    with pytest.raises(OutsideFieldError, match="nan"):
        axis([1.0, 2.0], EVERYWHERE).span(math.nan)


@pytest.mark.parametrize(
    ("nodes", "message"),
    [
        ([1.0, 1.0], r"number 1 \(1.0\)"),
        ([1.0, 3.0, 2.0], r"number 2 \(2.0\)"),
        ([math.inf], r"number 0 \(inf\)"),
        ([], "shape"),
    ],
)
def test_nodes_that_do_not_rise_are_refused(nodes: list[float], message: str) -> None:
    with pytest.raises(BadFieldError, match=message):
        axis(nodes)
