"""Ensembles: members on the nodes of the weather, and members that are given as hazard matrices."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from planner.ground import Cell
from planner.hazards import Bools, StageClock
from planner.survival import blurred, survival_of
from sim.reproduce.outlook import Floats, Window
from sim.reproduce.worlds import World


@dataclass(frozen=True)
class NodeEnsemble:
    """Members on the nodes of a world's weather.

    `peaks_mps`: each member's strongest wind of each stage, [member, stage, node north, node east].
    """

    peaks_mps: NDArray[np.float32]
    world: World
    _shares: dict[float, Floats] = field(default_factory=dict)

    def probability(self, blur_cells: float, window: Window) -> Floats:
        """See `Ensemble.probability`: the share of members, blurred on the nodes, bilinear between them."""
        if blur_cells not in self._shares:
            share = (self.peaks_mps > self.world.threshold_mps).mean(axis=0, dtype=np.float64)
            self._shares[blur_cells] = blurred(share, blur_cells / self.world.node_cells)
        share = self._shares[blur_cells][window.stages]
        return np.clip(self.world.spread(share, window), 0.0, 1.0)

    def survived(self, cells: tuple[Cell, ...], clock: StageClock) -> float:
        """See `Ensemble.survived`; a member's wind speed is taken as bilinear between its nodes."""
        stages = np.arange(len(cells)) // clock.steps_per_stage
        places = np.array(cells, dtype=np.float64).T / self.world.node_cells
        met = np.zeros(len(self.peaks_mps), dtype=np.bool_)
        for stage in np.unique(stages).tolist():
            there = places[:, stages == stage]
            for member, peaks_mps in enumerate(self.peaks_mps[:, stage]):
                speed_mps = ndimage.map_coordinates(peaks_mps, there, order=1, mode="nearest")
                met[member] |= bool((speed_mps > self.world.threshold_mps).any())
        return float(1.0 - met.mean())


@dataclass(frozen=True)
class MatrixEnsemble:
    """Members as hazard matrices [member, stage, north, east]; a single forecast is an ensemble of one."""

    members: Bools

    def probability(self, blur_cells: float, window: Window) -> Floats:
        """See `Ensemble.probability`."""
        share = np.asarray(self.members.mean(axis=0, dtype=np.float64))
        return blurred(share, blur_cells)[window]

    def survived(self, cells: tuple[Cell, ...], clock: StageClock) -> float:
        """See `Ensemble.survived`."""
        chance = survival_of(cells, 0, np.zeros(self.members.shape[1:]), clock, self.members)
        return float(chance.members_survived or 0) / len(self.members)
