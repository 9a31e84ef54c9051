"""Weather files written by the real libraries."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest


@pytest.fixture
def grib(tmp_path):
    """Writes GRIB messages with ecCodes: (name, edition, messages) -> path.

    A message is a dict of ecCodes keys, and "lat_deg" and "lon_deg" (evenly spaced) and "values" (rows from
    the first latitude on). Without the two the keys have to say where the points lie.
    """
    import eccodes

    def written(name: str, edition: int, messages: Iterable[dict[str, Any]]) -> Path:
        path = tmp_path / name
        with path.open("wb") as file:
            for message in messages:
                keys = dict(message)
                lat_deg, lon_deg, values = (keys.pop(key, None) for key in ("lat_deg", "lon_deg", "values"))
                handle = eccodes.codes_grib_new_from_samples(f"regular_ll_sfc_grib{edition}")
                ground = (
                    {"bitsPerValue": 24}
                    if lat_deg is None
                    else {
                        "Ni": len(lon_deg),
                        "Nj": len(lat_deg),
                        "latitudeOfFirstGridPointInDegrees": lat_deg[0],
                        "latitudeOfLastGridPointInDegrees": lat_deg[-1],
                        "longitudeOfFirstGridPointInDegrees": lon_deg[0],
                        "longitudeOfLastGridPointInDegrees": lon_deg[-1],
                        "iDirectionIncrementInDegrees": abs(lon_deg[1] - lon_deg[0]),
                        "jDirectionIncrementInDegrees": abs(lat_deg[1] - lat_deg[0]),
                        "jScansPositively": int(lat_deg[1] > lat_deg[0]),
                        "bitsPerValue": 24,
                    }
                )
                for key, value in (ground | keys).items():
                    eccodes.codes_set(handle, key, value)
                values = np.asarray(values, dtype=np.float64)
                if np.isnan(values).any():
                    eccodes.codes_set(handle, "bitmapPresent", 1)
                    values = np.where(np.isnan(values), 9999.0, values)
                    eccodes.codes_set(handle, "missingValue", 9999.0)
                eccodes.codes_set_values(handle, values.ravel())
                eccodes.codes_write(handle, file)
                eccodes.codes_release(handle)
        return path

    return written
