"""What machines of a cluster are compared by: each difference is told, and nothing else."""

import dataclasses

import pytest

from sim import provenance
from sim.campaign.premises import Premises


@pytest.fixture
def weather(tmp_path):
    path = tmp_path / "wind.nc"
    path.write_bytes(b"wind" * 1_000_000)
    return path


def test_the_same_machine_is_fit(tmp_path, weather):
    assert Premises.here([weather], tmp_path).complaints() == ()


def test_a_version_that_differs_is_told():
    here = Premises.here()
    other = tuple((name, "1.0" if name == "python" else version) for name, version in here.versions)
    (told,) = dataclasses.replace(here, versions=other).complaints()
    assert told == f"python is {dict(here.versions)['python']} there and 1.0 here"
    (told,) = dataclasses.replace(here, versions=(*here.versions, ("pyglide", "2.0"))).complaints()
    assert told == "pyglide is missing there and 2.0 here"


def test_source_that_differs_is_told_whatever_its_version(tmp_path, monkeypatch):
    source_sha256 = provenance.source_sha256.__wrapped__  # not what is remembered of this process
    monkeypatch.setattr(provenance, "_ROOT", tmp_path)
    (tmp_path / "sim").mkdir()
    source = tmp_path / "sim" / "clock.py"
    source.write_text("tick = 1\n")
    first = source_sha256()
    source.with_suffix(".pyc").write_text("of no account")
    assert source_sha256() == first
    source.write_text("tick = 2\n")
    assert source_sha256() != first


@pytest.mark.parametrize("change", [b"", b"wind" * 999_999 + b"lull", b"wind" * 1_000_001])
def test_another_file_of_the_same_name_is_told(weather, change):
    here = Premises.here([weather])
    weather.write_bytes(change)
    (told,) = here.complaints()
    assert told == f"its {weather} is another file ({len(change)} bytes, here 4000000)"


def test_a_file_that_is_missing_is_told(weather):
    here = Premises.here([weather])
    weather.unlink()
    assert here.complaints() == (f"it cannot read {weather} (No such file or directory)",)


def test_a_store_that_lacks_a_part_is_told(tmp_path):
    store = tmp_path / "wind.zarr"
    for name in ("u", "v"):
        (store / name).mkdir(parents=True)
    here = Premises.here([store])
    assert here.complaints() == ()
    (store / "v").rmdir()
    assert len(here.complaints()) == 1


def test_a_folder_that_cannot_be_written_to_is_told(tmp_path):
    (told,) = Premises.here(writes=tmp_path / "gone").complaints()
    assert told == f"it cannot write to {tmp_path / 'gone'} (No such file or directory)"


def test_of_many_files_some_travel_from_first_to_last(tmp_path):
    paths = [tmp_path / f"{hour:04d}.nc" for hour in range(1000)]
    for path in paths:
        path.touch()
    looked_at = [path for path, _ in Premises.here(paths).files]
    assert len(looked_at) == 100
    assert looked_at[0] == paths[0]
    assert looked_at[-1] >= paths[-10]
