"""Makes a golden recording of a schema, and the figures of its report.

The galeway that is on the path makes one of its own schema; that of an older revision makes an older one:

    python tests/golden/make.py

    git worktree add ../older 2360397        # the last revision that wrote schema 1
    PYTHONPATH=../older python tests/golden/make.py
    git worktree remove ../older

Beside `golden.toml` there is a flight whose plan changes, which schema 3 was the first to record:

    python tests/golden/make.py replanned

A recording is made once, when a schema is new, and never again: what was written has to be read for ever.
"""

import json
import shutil
import sys
import tempfile
from pathlib import Path

from recordings.schema import SCHEMA_VERSION
from sim.cli import main

HERE = Path(__file__).parent


def make(scenario: str) -> None:
    of = "" if scenario == "golden" else f"-{scenario}"
    target = HERE / f"schema-{SCHEMA_VERSION}{of}.mcap"
    if target.exists():
        raise SystemExit(f"{target} exists, and is kept as it was made")
    with tempfile.TemporaryDirectory() as folder:
        sys.argv = ["galeway", "fly", str(HERE / f"{scenario}.toml"), "--out", folder]
        try:
            main()
        except SystemExit as ended:
            if ended.code:
                raise
        report = json.loads((Path(folder) / "report.json").read_text())
        shutil.copyfile(Path(folder) / "flight.mcap", target)
    del report["real_time_factor"]
    target.with_suffix(".json").write_text(json.dumps(report, indent=1) + "\n")


if __name__ == "__main__":
    make(*sys.argv[1:] or ["golden"])
