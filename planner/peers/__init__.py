"""The systems that galeway is compared with, each behind `find(problem, start, goal, *, seed=0)`."""

from __future__ import annotations

from planner.peers import (
    ant_colony,
    astar_cells,
    astar_steps,
    breadth_first,
    depth_first,
    dijkstra,
    dstar_lite,
    earliest,
    genetic,
    paper,
    replanning,
    roadmap,
    rrt,
    rrt_time,
)
from planner.peers.route import Find, Peer, PeerRoute, TrackPoint

__all__ = ["PEERS", "Find", "Peer", "PeerRoute", "TrackPoint"]

PEERS: dict[str, Peer] = {
    "dfs": Peer(depth_first.find, "depth-first over (step, cell), toward the goal first", True),
    "bfs": Peer(breadth_first.find, "breadth-first on the first stage's map, the paper's baseline", False),
    "dijkstra": Peer(dijkstra.find, "Dijkstra on the first stage's map, costlier near hazard", False),
    "astar-cells": Peer(astar_cells.find, "A* with a closed list of cells: no waiting, no return", True),
    "astar-steps": Peer(astar_steps.find, "A* over (step, cell)", True, optimal=True),
    "dstar-lite": Peer(dstar_lite.find, "D* Lite, repaired on each stage's map", False),
    "replanning": Peer(replanning.find, "shortest way, found anew on each stage's map", False),
    "prm": Peer(roadmap.find, "probabilistic roadmap on the first stage's map (OMPL)", False),
    "rrt": Peer(rrt.find_rrt, "RRT on the first stage's map (OMPL)", False),
    "rrt-star": Peer(rrt.find_rrt_star, "RRT* on the first stage's map (OMPL)", False),
    "rrt-time": Peer(rrt_time.find, "control-space RRT over (row, column, step) (OMPL)", True),
    "genetic": Peer(genetic.find, "genetic algorithm over via points and waits (PyGAD)", True),
    "ants": Peer(ant_colony.find, "ant colony in the changing map", True),
    "paper": Peer(paper.find, "the paper's planner, best-scoring arrival", True),
    "staged": Peer(earliest.find, "galeway's staged sweep, earliest arrival", True, optimal=True),
}
"""Name to system, in the order of the report."""
