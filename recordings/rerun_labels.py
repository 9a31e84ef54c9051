"""Labels on the chart: where each goes so that none hides another, in points of the screen."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from recordings.rerun_chart import Chart
from recordings.rerun_text import drawable

Floats = NDArray[np.float64]
Colour = tuple[int, ...]

HEIGHT_PX = 22.0
"""Height of a label with its frame."""

_HANGS_PX = 13.0  # middle of the frame below the point that carries it
_LETTER_PX, _FRAME_PX = 6.7, 12.0


def width_px(text: str) -> float:
    """About how wide a label is with its frame."""
    return _LETTER_PX * len(text) + _FRAME_PX


def labels(chart: Chart, middle_km: Floats, texts: Sequence[str], colours: Sequence[Colour]) -> rr.Points2D:
    """Labels with their middles at places (east, north), shape (n, 2)."""
    carriers = (middle_km + np.array([0.0, _HANGS_PX * chart.px_km])) * np.array([1.0, -1.0])
    drawn = [drawable(text) for text in texts]
    return rr.Points2D(carriers, labels=drawn, colors=colours, radii=0.0, show_labels=True, draw_order=60.0)


def arrange(
    chart: Chart, marks_km: Floats, texts: Sequence[str], line_km: Floats, beside_px: Sequence[float]
) -> list[Floats | None]:
    """A place for the label of each mark, within the picture: under, over, right or left, best off the line.

    Args:
        chart: what they lie on.
        marks_km: (east, north), shape (n, 2); the first are placed first.
        texts: the labels.
        line_km: a line that should stay visible, close points, shape (m, 2).
        beside_px: how far from its mark each label begins.

    Returns:
        The middle of each label (east, north), None for one that has no room.
    """
    px_km = chart.px_km
    low, high = np.array(chart.extent).reshape(2, 2) / px_km
    taken: list[tuple[Floats, Floats]] = []
    places: list[Floats | None] = []
    for mark, text, off_px in zip(marks_km / px_km, texts, beside_px, strict=True):
        half = np.array([width_px(text), HEIGHT_PX]) / 2.0
        free = [
            place
            for place in (np.clip(aside, low + half, high - half) for aside in _around(mark, half + off_px))
            if not _overlaps(place, half, [(mark, np.zeros(2)), *taken])
        ]
        clear = [place for place in free if not np.any(np.all(abs(line_km / px_km - place) < half, axis=1))]
        chosen = next(iter(clear or free), None)
        if chosen is not None:
            taken.append((chosen, half))
        places.append(None if chosen is None else chosen * px_km)
    return places


def _around(mark: Floats, aside: Floats) -> list[Floats]:
    """Middles of labels under, over, right and left of a mark, so far aside across and along."""
    along = np.eye(2)
    return [
        mark - aside * along[1],
        mark + aside * along[1],
        mark + aside * along[0],
        mark - aside * along[0],
    ]


def _overlaps(place: Floats, half: Floats, taken: Sequence[tuple[Floats, Floats]]) -> bool:
    return any(np.all(abs(place - other) < half + other_half) for other, other_half in taken)
