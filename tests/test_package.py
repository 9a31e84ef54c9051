"""The wheel holds what a user needs, and nothing else."""

import subprocess
import sys
import zipfile
from pathlib import Path

ROOT = Path(__file__).parent.parent


def test_the_wheel_holds_the_four_packages_with_their_data(tmp_path):
    subprocess.run(
        [sys.executable, "-m", "hatchling", "build", "--target", "wheel", "--directory", str(tmp_path)],
        check=True,
        capture_output=True,
        cwd=ROOT,
    )
    (wheel,) = tmp_path.glob("*.whl")
    names = set(zipfile.ZipFile(wheel).namelist())
    assert {name.split("/")[0] for name in names if "dist-info" not in name} == {
        "sim",
        "planner",
        "aircraft",
        "recordings",
    }
    assert {f"{package}/py.typed" for package in ("sim", "planner", "aircraft", "recordings")} <= names
    shipped = {
        str(path.relative_to(ROOT))
        for pattern in (
            "aircraft/models/**/*.xml",
            "aircraft/models/**/*.toml",
            "sim/scenarios/*.toml",
            "*/[a-z]*.py",
        )
        for path in ROOT.glob(pattern)
        if path.parts[len(ROOT.parts)] in ("sim", "planner", "aircraft", "recordings")
    }
    assert any(name.endswith("aerosonde.xml") for name in shipped)
    assert {"sim/scenarios/ian.toml", "aircraft/models/c172p/aircraft.toml"} <= shipped
    assert shipped <= names
    assert not [name for name in names if name.endswith((".mcap", ".rrd", ".pyc"))]
