"""Campaigns on a Dask cluster: two of its workers against one process without Dask.

By the clock on the wall, so it needs a machine that does nothing else; the sides take turns, as in
`campaign_speed.py`. `--quick` tries it with flights of minutes.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from tempfile import TemporaryDirectory

from campaign_sides import LONG, QUICK, ROUNDS, SCENARIO, TIMEOUT_S, Sides, throughput
from dask_programs import cluster

from sim.campaign.dask_cluster import connected
from sim.campaign.pool import LocalPool

TITLE = "Campaigns on a Dask cluster"

TARGET = 1.6


def section() -> str:
    return measured(LONG, ROUNDS)


def measured(scenario: dict[str, object], rounds: int) -> str:
    with TemporaryDirectory() as name, cluster(2) as started:
        path = Path(name) / "scenario.toml"
        path.write_text(SCENARIO.format(**scenario))
        with connected(started.address, TIMEOUT_S) as dask:
            local = LocalPool(1, TIMEOUT_S)
            told = throughput(Sides(("one process", local), ("two Dask workers", dask)), path, rounds, TARGET)
    return f"{told}\nScheduler and workers are on the same machine, and there before the command.\n"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Measure campaigns on Dask.")
    parser.add_argument("--quick", action="store_true", help="flights of minutes, to try it")
    print(measured(QUICK, 2) if parser.parse_args().quick else section())
