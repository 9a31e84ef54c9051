"""Where the eye of the oblique view stands: in the south, above, and as near as the route allows."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_ELEVATION_RAD = math.radians(34.0)
_FROM_WEST = 0.1  # of the way from the south
_HALF_HEIGHT = math.tan(math.radians(55.0 / 2.0))  # the viewer's own angle of view, up and down
_HALF_WIDTH = 4.4 * _HALF_HEIGHT  # in the view's proportions when the recording opens at 1600 x 900
_ASIDE, _ABOVE, _BELOW = 0.85, 0.85, 0.68  # of the view, filled at most: labels hang under their places
_MARGIN = 1.0 + 1e-9  # for rounding
_SOUTHWARD = (0.0, 0.06, 0.12, 0.18, 0.24)  # of the depth of what is seen


class Eye(NamedTuple):
    """Positions are east, north and up, heights exaggerated."""

    position_km: Floats
    target_km: Floats

    @property
    def distance_km(self) -> float:
        """From the eye to what it looks at."""
        return float(np.linalg.norm(self.target_km - self.position_km))


def nearest_eye(points_km: Floats, least_km: float) -> Eye:
    """The eye that sees all points from as near as can be, but not from nearer than `least_km`.

    What is near takes more room than what is far: so it looks at a place south of their middle.

    Args:
        points_km: shape (n, 3), finite.
        least_km: distance, above zero.
    """
    low, high = points_km.min(axis=0), points_km.max(axis=0)
    southward = np.array([0.0, low[1] - high[1], 0.0])
    targets = [(low + high) / 2.0 + share * southward for share in _SOUTHWARD]
    return min((_nearest(points_km, target, least_km) for target in targets), key=lambda eye: eye.distance_km)


def _nearest(points_km: Floats, target_km: Floats, least_km: float) -> Eye:
    """The same for one target.

    Going back changes how deep a point lies in the view, and nothing else; so each point says from where on
    it is seen, and the farthest of these counts.
    """
    back = math.cos(_ELEVATION_RAD)
    toward_eye = np.array([-_FROM_WEST * back, -back, math.sin(_ELEVATION_RAD)])
    length = float(np.linalg.norm(toward_eye))
    ahead = -toward_eye / length
    right = np.cross(ahead, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    across, up, deep = np.array([right, np.cross(right, ahead), ahead]) @ (points_km - target_km).T
    needed = (
        abs(across) / (_ASIDE * _HALF_WIDTH),
        up / (_ABOVE * _HALF_HEIGHT),
        -up / (_BELOW * _HALF_HEIGHT),
    )
    distance_km = max(least_km, float((np.max(needed, axis=0) - deep).max()) / length * _MARGIN)
    return Eye(target_km + distance_km * toward_eye, target_km)
