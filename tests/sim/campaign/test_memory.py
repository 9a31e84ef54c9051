"""A worker takes no more memory after a thousand flights than after a few."""

import subprocess
import sys
from pathlib import Path

import pytest

HOP = Path(__file__).parent.parent / "scenarios" / "hop.toml"
FLIGHTS, WARM, EVERY = 1000, 200, 50
GROWTH_MB = 5.0  # six kilobytes a flight; a JSBSim that is not let go takes hundreds

FLIES = """
import sys
from pathlib import Path
from sim.campaign.flight import Flight, Origin
from sim.campaign.flying import Flying
from sim.campaign.keeping import Keep

origin, work = Origin.of(sys.argv[1]), Flying(Keep.parse("none"), Path())
for run in range(int(sys.argv[2])):
    row = work(Flight(run, origin, (f"turbulence.severity={run % 3}",), run))
    assert row["outcome"] == "arrived", row
    if run % int(sys.argv[3]) == 0:
        status = Path("/proc/self/status").read_text()
        print(next(line.split()[1] for line in status.splitlines() if line.startswith("VmRSS")), flush=True)
"""


@pytest.mark.slow
def test_memory_stays_flat_over_a_thousand_flights():
    done = subprocess.run(
        [sys.executable, "-c", FLIES, str(HOP), str(FLIGHTS), str(EVERY)],
        check=True,
        capture_output=True,
        text=True,
    )
    resident_mb = [int(word) / 1000.0 for word in done.stdout.split()]
    assert len(resident_mb) == FLIGHTS // EVERY
    print(resident_mb)
    warm_mb = resident_mb[WARM // EVERY]
    assert max(resident_mb[WARM // EVERY :]) - warm_mb < GROWTH_MB
