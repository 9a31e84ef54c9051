"""Bootstrap intervals over days: goals of a day share their weather, so that days are what is drawn again."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats

RESAMPLES = 9999
LEVEL = 0.95

Statistic = Callable[..., NDArray[np.float64]]


class Interval(NamedTuple):
    """A figure and its bootstrap interval; the ends are not numbers where there is but one day."""

    value: float
    low: float
    high: float


def mean_interval(days: ArrayLike) -> Interval:
    """The mean over days of one figure a day; of paired policies give the difference of each day."""
    return _interval(_mean, [np.asarray(days, dtype=np.float64)])


def ratio_interval(above: ArrayLike, below: ArrayLike) -> Interval | None:
    """The sum over days of one figure over that of another, paired by day; None where that is no number.

    Days whose resample has nothing below are left out of the interval.
    """
    samples = [np.asarray(part, dtype=np.float64) for part in (above, below)]
    return None if samples[1].sum() == 0.0 else _interval(_ratio, samples)


def _mean(days: NDArray[np.float64], axis: int = -1) -> NDArray[np.float64]:
    return np.asarray(days.mean(axis=axis))


def _ratio(above: NDArray[np.float64], below: NDArray[np.float64], axis: int = -1) -> NDArray[np.float64]:
    total = below.sum(axis=axis)
    return np.asarray(above.sum(axis=axis) / np.where(total == 0.0, np.nan, total))


def _interval(statistic: Statistic, samples: Sequence[NDArray[np.float64]]) -> Interval:
    value = float(statistic(*samples))
    if samples[0].size < 2:
        return Interval(value, np.nan, np.nan)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", stats.DegenerateDataWarning)  # of days that are all the same
        drawn: Any = stats.bootstrap(
            samples,
            statistic,
            paired=True,
            vectorized=True,
            n_resamples=RESAMPLES,
            method="percentile",
            random_state=np.random.default_rng(0),
        )
    tail = (1.0 - LEVEL) / 2.0
    low, high = np.nanquantile(drawn.bootstrap_distribution, [tail, 1.0 - tail])
    return Interval(value, float(low), float(high))
