"""Opening weather files of any kind with xarray: NetCDF-3 and -4, GRIB 1 and 2, Zarr."""

from __future__ import annotations

import glob
import warnings
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from sim.errors import WeatherError

if TYPE_CHECKING:  # xarray takes over a second to import
    import xarray as xr

_ZARR_MARKS = ("zarr.json", ".zgroup", ".zmetadata")
_WORDS = ("units", "standard_name", "long_name", "calendar", "axis", "positive", "cell_methods")
_LONGEST_HEADING = 200  # bytes that a bulletin's heading may put before a GRIB message


class Opened(NamedTuple):
    """A dataset, undecoded in time and unread, with the file it is from and that file's format."""

    path: Path
    format: str
    dataset: xr.Dataset


def found_files(names: str | Path | Sequence[str], folder: Path = Path()) -> tuple[Path, ...]:
    """The files that a name, a pattern such as "gfs_*.nc", or several of them mean, in order.

    Args:
        names: relative to the folder, or absolute.
        folder: usually the scenario's.

    Raises:
        WeatherError: if a name or a pattern has no file.
    """
    found: list[Path] = []
    for name in [names] if isinstance(names, str | Path) else names:
        path = folder / name
        if path.exists():
            found.append(path)
            continue
        matches = sorted(glob.glob(str(path))) if glob.has_magic(str(name)) else []  # noqa: PTH207
        if not matches:
            what = "no weather files match" if glob.has_magic(str(name)) else "there is no weather file"
            raise WeatherError(f"{what} {path}; check the path")
        found.extend(map(Path, matches))
    if not found:
        raise WeatherError("no weather file is named; give one or more")
    return tuple(dict.fromkeys(found))


@contextmanager
def opened(paths: Sequence[Path]) -> Iterator[list[Opened]]:
    """Open files; a GRIB file is as many datasets as its messages make.

    Raises:
        WeatherError: if a file is missing, of no known kind, broken, or needs an extra that is not installed.
    """
    with ExitStack() as stack:
        datasets: list[Opened] = []
        for path in paths:
            for one in _open(path):
                stack.callback(one.dataset.close)
                _plain_words(one.dataset)
                datasets.append(one)
        yield datasets


@contextmanager
def broken_named(path: Path) -> Iterator[None]:
    """Turn what the libraries raise on a broken file into one message that names it; they warn in vain.

    Raises:
        WeatherError: if anything but our own errors and an interruption is raised inside.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    except WeatherError:
        raise
    except MemoryError as error:
        raise WeatherError(f"{path} asks for more memory than there is; choose a smaller area") from error
    except Exception as error:  # every library has its own; the user needs the file's name and a remedy
        detail = " ".join(str(error).split())[:300] or type(error).__name__
        raise WeatherError(
            f"{path} cannot be read ({detail}); it may be broken or cut off: fetch it again"
        ) from error


def _open(path: Path) -> list[Opened]:
    if not path.exists():
        raise WeatherError(f"there is no weather file {path}; check the path")
    if path.is_dir() or path.suffixes[-2:] == [".zarr", ".zip"]:
        return [_open_zarr(path)]
    with broken_named(path):
        head = path.read_bytes()[:0] if path.stat().st_size == 0 else _head(path)
    if b"GRIB" in head:
        needs_extra("cfgrib", path, "grib")
        from sim.weather.grib import open_grib

        with broken_named(path):
            return [Opened(path, *part) for part in open_grib(path)]
    if head[:3] == b"CDF":
        return [_open_netcdf(path, "NetCDF-3")]
    if head[:8] == b"\x89HDF\r\n\x1a\n":
        return [_open_netcdf(path, "NetCDF-4")]
    begins = f"begins with {head[:8]!r}" if head else "is empty"
    raise WeatherError(f"{path} {begins}, which is neither NetCDF, GRIB nor Zarr; convert it to one of them")


def _plain_words(dataset: xr.Dataset) -> None:
    """Make words of attributes that have to be such; files hold numbers there, too, and spaces around."""
    for variable in dataset.variables.values():
        for name in _WORDS:
            if name in variable.attrs:
                variable.attrs[name] = str(variable.attrs[name]).strip()


def _head(path: Path) -> bytes:
    with path.open("rb") as file:
        return file.read(_LONGEST_HEADING)


def _open_netcdf(path: Path, kind: str) -> Opened:
    import xarray as xr

    with broken_named(path):
        if kind == "NetCDF-3":
            _refuse_cut_off(path)
        return Opened(path, kind, xr.open_dataset(path, engine="netcdf4", decode_times=False))


def _refuse_cut_off(path: Path) -> None:
    """Raise if a classic file is shorter than its header says: the NetCDF library would read zeros there."""
    if _head(path)[3] == 5:  # 64-bit data, which scipy does not know
        return
    from scipy.io import netcdf_file

    netcdf_file(path, "r", mmap=True).close()  # maps every variable, and reads none


def _open_zarr(path: Path) -> Opened:
    if path.is_dir() and not any((path / mark).exists() for mark in _ZARR_MARKS):
        raise WeatherError(
            f"the folder {path} is no Zarr store (it has none of {', '.join(_ZARR_MARKS)}); "
            f"name the files in it, such as {path / '*.nc'}"
        )
    needs_extra("zarr", path, "zarr")
    import xarray as xr

    with broken_named(path):
        return Opened(path, "Zarr", xr.open_dataset(path, engine="zarr", decode_times=False, chunks=None))


def needs_extra(module: str, path: Path, extra: str) -> None:
    """Refuse a file whose reader is not installed.

    Raises:
        WeatherError: with the command that installs it.
    """
    from importlib.util import find_spec

    if find_spec(module) is None:
        raise WeatherError(f"{path} needs {module} to be read; pip install 'galeway[{extra}]'")
