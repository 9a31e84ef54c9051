"""Wind as it is recorded: thinned and rounded, and filled again."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from recordings.errors import BadRecordingError
from recordings.wind_field import STEP_MPS, Thinned, filled, thinned


@settings(max_examples=40, deadline=None)
@given(rows=st.integers(1, 240), columns=st.integers(1, 240), slopes=st.tuples(*[st.floats(-0.1, 0.1)] * 4))
def test_wind_that_is_linear_comes_back_to_a_step(rows, columns, slopes):
    row, column = np.mgrid[:rows, :columns]
    north = (slopes[0] * row + slopes[1] * column).astype(np.float32)
    east = (5.0 + slopes[2] * row + slopes[3] * column).astype(np.float32)
    recorded = thinned(north, east)
    for found, wind in zip(filled(recorded, (rows, columns)), (north, east), strict=True):
        assert found.dtype == np.float32
        last = [max(0, (size - 1) // recorded.every * recorded.every) + 1 for size in (rows, columns)]
        inside = slice(0, last[0]), slice(0, last[1])
        np.testing.assert_allclose(found[inside], wind[inside], atol=STEP_MPS / 2.0 + 1e-4)
        assert np.abs(found - wind).max() <= STEP_MPS + 0.2 * recorded.every


def test_small_fields_are_not_thinned_and_large_ones_are():
    small, large = np.zeros((60, 80), np.float32), np.zeros((548, 421), np.float32)
    assert thinned(small, small).every == 1
    assert thinned(large, large).every == 5
    assert len(thinned(large, large).content) == 4 * 110 * 85


def test_wind_beyond_what_fits_is_cut_off_not_wrapped():
    wild = np.full((2, 2), 1e6, np.float32)
    north, east = filled(thinned(wild, -wild), (2, 2))
    assert north.min() > 2000.0
    assert east.max() < -2000.0


def test_content_of_another_size_is_refused():
    with pytest.raises(BadRecordingError, match="has 6 bytes"):
        filled(Thinned(1, b"\0" * 6), (2, 2))
