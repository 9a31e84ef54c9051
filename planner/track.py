"""The rest of a wind-aware plan as its waypoints have it, flown on time: what it meets, what it is worth."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from planner.legs import Legs, are_safe
from planner.passage import Spot, around, lay_passage, spot_at
from planner.plans import Waypoint
from planner.price import along, while_waiting
from planner.ways import WaySearch
from planner.windfield import Floats, WindField

_OFF_S = 2.0  # by which the time at a place may differ from that of the flight that the plan was made from
_OFF_MPS = 0.5  # and the mean airspeed to a waypoint that the schedule asks for, from the limits
_SAME_PLACE = 1e-3  # of a cell


class Trouble(NamedTuple):
    """When a plan runs into hazard, or into wind that asks for airspeeds the aircraft does not have."""

    time_s: float
    hazard: bool


class _Piece(NamedTuple):
    """From one waypoint to the next; without legs it is a wait. `time_s`: at the cuts, [1, cut]."""

    spot: Spot
    legs: Legs | None
    time_s: Floats
    altitude_m: float


@dataclass(frozen=True, eq=False)
class Track:
    """Waypoints, their times since departure, on a forecast: `search` made from `wind`, at any altitude."""

    search: WaySearch
    wind: WindField
    points: Sequence[Waypoint]

    @cached_property
    def _pieces(self) -> list[_Piece]:
        country = self.search.country
        spots = [
            spot_at(country.chart, self.wind.grid, point.lat_deg, point.lon_deg) for point in self.points
        ]
        pieces = []
        for (first, last), (before, after) in zip(pairwise(spots), pairwise(self.points), strict=True):
            took_s = after.time_s - before.time_s
            if math.dist(first, last) < _SAME_PLACE:
                pieces.append(
                    _Piece(first, None, np.array([[before.time_s, after.time_s]]), before.altitude_m)
                )
            else:
                stages_s = country.stage_s * np.arange(len(country.intervals.run))
                within_s = stages_s[(stages_s > before.time_s) & (stages_s < after.time_s)]
                shares = ((within_s - before.time_s) / took_s).tolist()
                legs = lay_passage(country.chart, first, last, shares)
                time_s = before.time_s + legs.share * took_s
                pieces.append(_Piece(first, legs, time_s, before.altitude_m))
        return pieces

    def trouble(self) -> Trouble | None:
        """The first that cannot be flown, if any of it cannot."""
        request = self.search.request
        for piece in self._pieces:
            if not self._is_safe(piece):
                return Trouble(self._unsafe_s(piece), hazard=True)
            mean_mps = float(self._airspeed_mps(piece).mean())
            if not (request.airspeed_min_mps - _OFF_MPS <= mean_mps <= request.airspeed_max_mps + _OFF_MPS):
                return Trouble(float(piece.time_s[0, 0]), hazard=False)
        return None

    def _is_safe(self, piece: _Piece) -> bool:
        country = self.search.country
        if piece.legs is not None:
            tried = (piece.time_s + off_s for off_s in (0.0, -_OFF_S, _OFF_S))
            return any(are_safe(country, piece.legs, time_s)[0] for time_s in tried)
        intervals = country.intervals
        first, last = (int(time_s // country.stage_s) for time_s in piece.time_s[0].tolist())
        places = [intervals.place_of(*cell) for cell in around(piece.spot)]
        return last < len(intervals.run_end) and bool((intervals.run_end[first, places] > last).all())

    def _unsafe_s(self, piece: _Piece) -> float:
        """When a leg that is not safe crosses the last line before that; of a wait, when it begins."""
        time_s, legs = piece.time_s, piece.legs
        if legs is not None:
            for cut in range(3, time_s.shape[1], 2):
                begun = replace(
                    legs, share=legs.share[:, :cut], row=legs.row[:, :cut], column=legs.column[:, :cut]
                )
                if not self._is_safe(piece._replace(legs=begun, time_s=time_s[:, :cut])):
                    return float(time_s[0, cut - 3])
            return float(time_s[0, -3])
        return float(time_s[0, 0])

    def _airspeed_mps(self, piece: _Piece) -> Floats:
        """What the schedule asks for at the cuts of a leg; on a wait the cruise."""
        if piece.legs is None:
            return np.array([self.search.cruise_mps])
        legs, grid, chart = piece.legs, self.wind.grid, self.search.country.chart
        took_s = float(piece.time_s[0, -1] - piece.time_s[0, 0])
        north_m, east_m = (
            np.interp(index[0], np.arange(line_m.size), line_m)
            for index, line_m in ((legs.row, chart.north_m), (legs.column, chart.east_m))
        )
        lat_rad, lon_rad = grid.frame.to_geodetic(north_m, east_m)
        time_s = self.search.request.clock.departure_s + piece.time_s[0]
        north_mps, east_mps, _ = self.wind.at_many(time_s, lat_rad, lon_rad, piece.altitude_m)
        ground_mps = legs.course[0] * legs.length_m.sum() / max(took_s, 1e-9)
        airspeed_mps: Floats = np.abs(ground_mps - (north_mps + 1j * east_mps))
        return airspeed_mps

    @property
    def arrival_s(self) -> float:
        """At the last waypoint, since departure."""
        return self.points[-1].time_s

    def worth(self, objective: str) -> float:
        """What the objective makes large, from the first waypoint on."""
        measure = {"score": self._score, "survival": self._log_survival, "fuel": self._saved_kg}
        return measure[objective]() if objective in measure else -self.arrival_s

    def _score(self) -> float:
        """Equation (2), as `planner.appraisal` counts it."""
        appraisal, request = self.search.appraisal, self.search.request
        clock, weights = request.clock, request.weights
        took_s = max(self.arrival_s - self.points[0].time_s, 1e-9)
        last = self.points[-1]
        end = spot_at(self.search.country.chart, self.wind.grid, last.lat_deg, last.lon_deg)
        goal = round(end[0]), round(end[1])
        length_m = sum(float(piece.legs.length_m.sum()) for piece in self._pieces if piece.legs is not None)
        return (
            weights.alpha * float(appraisal.clearance[(clock.stage_at(self.arrival_s), *goal)])
            + weights.beta * self._integral(appraisal.clearance) / took_s
            - weights.gamma * length_m / appraisal.cell_m
            - weights.delta * took_s / clock.step_s
        )

    def _log_survival(self) -> float:
        return -self._integral(self.search.appraisal.risk) / self.search.request.clock.step_s

    def _integral(self, rate: Floats) -> float:
        """Over time, of a rate of the cells [stage, north, east]."""
        country = self.search.country
        return sum(
            while_waiting(
                rate, country, (round(piece.spot[0]), round(piece.spot[1])), *piece.time_s[0].tolist()
            )
            if piece.legs is None
            else float(along(rate, country, piece.legs, piece.time_s)[0])
            for piece in self._pieces
        )

    def _saved_kg(self) -> float:
        return -sum(self._burned_kg())

    def _burned_kg(self) -> Iterator[float]:
        flow = self.search.request.fuel_flow
        for piece in self._pieces:
            took_s = float(piece.time_s[0, -1] - piece.time_s[0, 0])
            if flow is not None:
                yield float(np.mean(flow.at(self._airspeed_mps(piece)))) * took_s
