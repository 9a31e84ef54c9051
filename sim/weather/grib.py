"""GRIB 1 and 2 by cfgrib, each parameter and kind of message a dataset of its own."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import numpy as np

from sim.errors import WeatherError
from sim.weather.grib_trial import MessageWindow, try_alone

if TYPE_CHECKING:  # xarray takes over a second to import
    import xarray as xr


def open_grib(path: Path) -> list[tuple[str, xr.Dataset]]:
    """The file's datasets, unread, each with the name of its format.

    One dataset is what has one parameter on one kind of level; a control run and the perturbed members of an
    ensemble are two. Times that are those of windows have bounds, as in CF files. The index that cfgrib
    makes of a file is not left beside it.

    Raises:
        WeatherError: if ecCodes does not load, or the file's messages cannot be listed.
        Exception: whatever else cfgrib and ecCodes raise on a broken file.
    """
    try:
        from cfgrib.xarray_store import open_variable_datasets
    except (ImportError, RuntimeError) as error:  # RuntimeError: the ecCodes library is missing or too old
        raise WeatherError(
            f"{path} needs ecCodes to be read, which does not load ({error}); pip install 'galeway[grib]'"
        ) from error
    logging.getLogger("cfgrib").setLevel(logging.CRITICAL)  # what it logs, it raises, too
    with TemporaryDirectory(prefix="galeway-") as folder:
        options = {"indexpath": f"{folder}/{{short_hash}}.idx", "errors": "raise"}
        windows = try_alone(path, options["indexpath"])
        datasets = open_variable_datasets(str(path), backend_kwargs=options, decode_times=False)
    if not datasets:
        raise WeatherError(f"{path} has no GRIB message that can be read; fetch it again")
    for dataset in datasets:
        _bound(dataset, windows)
    return [(f"GRIB {dataset.attrs.get('GRIB_edition', '')}".strip(), dataset) for dataset in datasets]


def _bound(dataset: xr.Dataset, windows: Sequence[MessageWindow]) -> None:
    """Give the valid times of a dataset bounds; NaN where windows of several lengths end at the same time."""
    if "valid_time" not in dataset or "step" not in dataset or not dataset.data_vars:
        return
    said = next(iter(dataset.data_vars.values())).attrs
    own = tuple(said.get(f"GRIB_{key}") for key in ("paramId", "dataType", "typeOfLevel", "stepType"))
    begins_h: dict[float, float] = {}
    for window in windows:
        if window[:4] == own:
            same = begins_h.get(window.end_h, window.begin_h) == window.begin_h
            begins_h[window.end_h] = window.begin_h if same else np.nan
    if all(begin_h == end_h for end_h, begin_h in begins_h.items()):
        return
    long_h = np.array([hours - begins_h.get(float(hours), hours) for hours in np.ravel(dataset.step.values)])
    valid = dataset["valid_time"].variable
    long_s = 3600.0 * long_h.reshape(dataset.step.shape)
    ends_s = valid.values.astype(np.float64)
    bounds_s = np.stack((ends_s - long_s, ends_s), axis=-1)
    dataset["valid_time_bounds"] = ((*valid.dims, "window"), bounds_s)
    dataset["valid_time"].attrs["bounds"] = "valid_time_bounds"
