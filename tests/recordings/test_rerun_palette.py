import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from recordings.rerun_palette import difference_picture, difference_scale, wind_picture, wind_scale


def colour_on(scale, value):
    """The colour that a reader of the scale would expect."""
    reached = [band for band in scale if band.from_mps is None or band.from_mps <= value]
    return reached[-1].colour


@given(
    speeds=st.lists(st.floats(0.0, 80.0, width=32), min_size=1, max_size=30),
    threshold_mps=st.sampled_from([4.0, 10.0, 15.0, 17.5, 18.0, 30.0, 60.0]),
)
@settings(max_examples=100, deadline=None)
def test_the_picture_has_the_colours_of_its_scale(speeds, threshold_mps):
    speed_mps = np.array(speeds, np.float32)
    scale, hazard = wind_scale(threshold_mps), speed_mps >= threshold_mps
    picture = wind_picture(hazard, speed_mps, threshold_mps)
    assert [tuple(colour) for colour in picture.tolist()] == [
        colour_on(scale, speed) for speed in speed_mps.tolist()
    ]


@pytest.mark.parametrize("threshold_mps", [4.0, 15.0, 18.0, 60.0])
def test_the_scale_rises_from_calm_and_turns_from_blue_to_red_at_the_threshold(threshold_mps):
    scale = wind_scale(threshold_mps)
    edges = [band.from_mps for band in scale]
    assert edges[0] == 0.0
    assert edges == sorted(set(edges))
    assert threshold_mps in edges
    for from_mps, (red, _, blue) in scale:
        assert (red > blue) == (from_mps >= threshold_mps)


def test_hazard_of_another_time_of_the_stage_is_drawn_as_hazard_too():
    (colour,) = wind_picture(np.array([True]), np.array([3.0], np.float32), 18.0).tolist()
    assert tuple(colour) == colour_on(wind_scale(18.0), 18.0)


@given(seed=st.integers(0, 2**32 - 1))
@settings(max_examples=30, deadline=None)
def test_the_difference_has_the_colours_of_its_scale_and_is_grey_exactly_where_there_is_none(seed):
    rng = np.random.default_rng(seed)
    forecast_mps = rng.uniform(0.0, 40.0, (8, 9)).astype(np.float32)
    off_mps = np.where(rng.random((8, 9)) < 0.5, rng.uniform(-20.0, 20.0, (8, 9)), 0.0).astype(np.float32)
    truth_mps = forecast_mps + off_mps
    picture, scale = difference_picture(truth_mps, forecast_mps), difference_scale()
    grey = np.array(colour_on(scale, 0.0))
    off_mps = truth_mps.astype(float) - forecast_mps
    np.testing.assert_array_equal(np.all(picture == grey, axis=-1), (off_mps >= -0.1) & (off_mps < 0.1))
    for colour, off in zip(picture.reshape(-1, 3).tolist(), off_mps.ravel(), strict=True):
        assert tuple(colour) == colour_on(scale, off)


def test_no_two_colours_of_a_scale_are_alike():
    for scale in (wind_scale(15.0), wind_scale(60.0), difference_scale()):
        assert len({band.colour for band in scale}) == len(scale)
