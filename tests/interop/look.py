"""A recording looked at in Foxglove Studio, its last open version, with our layout: `make foxglove`.

Needs node, npm and Chromium. The packages go to a temporary folder; pictures of what was seen stay in
runs/foxglove. Foxglove's map has no tiles then, since nothing is fetched from the internet.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import recordings

HERE = Path(__file__).parent
ROOT = HERE.parent.parent
LAYOUT = ROOT / "docs" / "foxglove_layout.json"
GOLDEN = max((HERE.parent / "golden").glob("schema-*.mcap"))
PICTURES = ROOT / "runs" / "foxglove"
PACKAGES = ("@foxglove/studio-base@1.48.0", "react@17.0.2", "react-dom@17.0.2", "playwright-core@1.65.1")
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")


def looked_at(recording: Path, browser: str) -> dict[str, Any]:
    """What the script in the browser found."""
    with tempfile.TemporaryDirectory(prefix="galeway-foxglove-") as name:
        folder = Path(shutil.copytree(HERE / "foxglove", Path(name) / "site"))
        shutil.copy(recording, folder / "flight.mcap")
        shutil.copy(LAYOUT, folder / "layout.json")
        install = ["npm", "install", "--silent", "--no-save", "--no-package-lock", "--no-audit"]
        subprocess.run([*install, "--legacy-peer-deps", "--prefix", folder, *PACKAGES], check=True)
        PICTURES.mkdir(parents=True, exist_ok=True)
        command = ["node", folder / "look.mjs", browser, "flight.mcap", "layout.json", PICTURES]
        done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
    if done.returncode:
        raise SystemExit("Foxglove did not come to its end; what was seen is in runs/foxglove")
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def faults(found: dict[str, Any], goals: int) -> list[str]:
    """What should be seen and is not."""
    told = [f"an error in the page: {text}" for text in found["errors"]]
    if not found["fine"]:
        told.append("Foxglove lists problems")
    for panel, colours in found["panels"].items():
        if colours["yellow"] <= 20:
            told.append(f"nothing of the flight in {panel}")
    if found["panels"]["3D!behind"]["blue"] <= 20:
        told.append("no plan behind the aircraft")
    if found["goals"] < goals:  # Foxglove marks those of the plan in force twice
        told.append(f"{found['goals']} goals on the map instead of {goals}")
    if "#4e98e2ff" not in found["lines"] or len(set(found["lines"])) < 2:
        told.append("the map lacks the plan or the track")
    return told


def main() -> None:
    recording = Path(sys.argv[1]) if sys.argv[1:] else GOLDEN
    browser = next(filter(None, map(shutil.which, BROWSERS)), None)
    if browser is None or shutil.which("node") is None or shutil.which("npm") is None:
        raise SystemExit("node (20 or newer), npm and Chromium are needed to look at recordings in Foxglove")
    found = looked_at(recording, browser)
    told = faults(found, len(recordings.open(recording).header.plan.goals))
    if told:
        raise SystemExit("\n".join(told))
    print(f"{recording.name} in Foxglove: all panels show it; pictures are in runs/foxglove")


if __name__ == "__main__":
    main()
