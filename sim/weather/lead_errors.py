"""How wrong forecasts are: the published mean errors of tropical cyclone forecasts by lead time.

Errors of the official forecasts of the US National Hurricane Center for the Atlantic, as its verification
states them (Cangialosi 2022, Forecast Verification Report, 2021 Hurricane Season; five-year means at
nhc.noaa.gov/verification): about 25, 40 and 55 nautical miles at 12, 24 and 36 h, and 5 to 10 kt. They are
rounded here to 5 n mi and half a knot; a season's own means lie some tenths off. Between leads they are
interpolated without a kink, since a storm has none; at lead 0 the forecast is right; beyond 72 h errors stay
as they are.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import PchipInterpolator

from sim.weather.best_track import KNOT_MPS, NAUTICAL_MILE_M

Floats = NDArray[np.float64]

LEADS_S = tuple(3600.0 * hours for hours in (0.0, 12.0, 24.0, 36.0, 48.0, 72.0))
"""Lead times of the two tables [s]."""

MEAN_TRACK_ERRORS_M = tuple(miles * NAUTICAL_MILE_M for miles in (0.0, 25.0, 40.0, 55.0, 70.0, 100.0))
"""Mean distance between the forecast centre and the true one [m]."""

MEAN_INTENSITY_ERRORS_MPS = tuple(knots * KNOT_MPS for knots in (0.0, 5.0, 7.5, 9.0, 10.0, 12.0))
"""Mean absolute error of the maximum wind [m/s]."""


# Monotone cubic interpolation (Fritsch and Butland 1984): it rises as the tables do.
_TRACK = PchipInterpolator(LEADS_S, MEAN_TRACK_ERRORS_M)
_INTENSITY = PchipInterpolator(LEADS_S, MEAN_INTENSITY_ERRORS_MPS)


def track_deviation_m(lead_s: ArrayLike) -> Floats:
    """Standard deviation of each of the two components of a normal track error [m].

    The length of such an error has the Rayleigh distribution, whose mean is sqrt(pi/2) times that.
    """
    return _between(lead_s, _TRACK) / math.sqrt(math.pi / 2.0)


def intensity_deviation_mps(lead_s: ArrayLike) -> Floats:
    """Standard deviation of a normal error of the maximum wind [m/s]: its mean size is sqrt(2/pi) of that."""
    return _between(lead_s, _INTENSITY) / math.sqrt(2.0 / math.pi)


def _between(lead_s: ArrayLike, errors: PchipInterpolator) -> Floats:
    known = np.clip(np.asarray(lead_s, dtype=np.float64), LEADS_S[0], LEADS_S[-1])
    return np.asarray(errors(known), dtype=np.float64)
