"""`galeway aircraft`, as a user runs it."""

import shutil

import pytest

from aircraft.description import BUILT_IN


def test_the_built_in_are_listed(galeway):
    done = galeway("aircraft")
    assert done.returncode == 0
    assert [line.split()[0] for line in done.stdout.splitlines()] == ["aerosonde", "c172p"]


def test_what_was_measured_of_one(galeway):
    done = galeway("aircraft", "c172p")
    assert done.returncode == 0, done.stderr
    assert "stall at 16.0°" in done.stdout
    table = [
        line.split() for line in done.stdout.split("range\n")[1].splitlines()[1:] if line.startswith("   ")
    ]
    airspeeds, _, alphas, flows, endurance_h, range_km = (
        [float(row[i]) for row in table[:8]] for i in range(6)
    )
    assert airspeeds == sorted(airspeeds)
    assert alphas == sorted(alphas, reverse=True)
    assert all(167.0 / flow == _about(hours) for flow, hours in zip(flows, endurance_h, strict=True))
    assert all(
        3.6 * airspeed * hours == _about(km)
        for airspeed, hours, km in zip(airspeeds, endurance_h, range_km, strict=True)
    )
    assert "cross_track_per_s" in done.stdout


def test_a_broken_folder_is_one_message(galeway, tmp_path):
    folder = tmp_path / "albatross"
    shutil.copytree(BUILT_IN / "aerosonde", folder)
    model = folder / "aerosonde.xml"
    model.write_text(model.read_text().replace("<sense> 1 </sense>", "<sense> clockwise </sense>"))
    done = galeway("aircraft", "albatross", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("galeway: JSBSim ")
    assert "albatross" in done.stderr
    assert done.stderr.count("\n") == 1


def _about(value):
    return pytest.approx(value, rel=0.02)
