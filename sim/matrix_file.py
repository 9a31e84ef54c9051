"""Hazard matrices of one's own in NumPy's files."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any

import numpy as np

from sim.errors import SimError


def read_matrices(path: Path, key: str | None, *, ask: str = "--key") -> Any:
    """The array of an .npy file, or one of those of an .npz.

    Args:
        path: of the file.
        key: the array's name in an .npz with several.
        ask: what names one, for messages.

    Raises:
        SimError: if it cannot be read, or has no such array.
    """
    try:
        loaded = np.load(path, allow_pickle=False)
    except OSError as error:
        reason = error.strerror or str(error)
        raise SimError(f"cannot read hazard matrices from {path}: {reason}; give .npz or .npy") from error
    except (ValueError, EOFError, zipfile.BadZipFile) as error:
        # NumPy takes what it does not know for a pickle, and advises to allow that
        raise SimError(
            f"cannot read hazard matrices from {path}: it is no whole file of numbers in NumPy's format; "
            "give .npz or .npy as numpy.savez or numpy.save write them"
        ) from error
    if isinstance(loaded, np.ndarray):
        if key is not None:
            raise SimError(
                f"{path} holds one array, without a name; leave out {ask} {key!r}, or give an .npz"
            )
        return loaded
    with loaded:
        names = list(loaded.files)
        name = names[0] if key is None and len(names) == 1 else key
        if name not in names:
            wrong = "" if key is None else f", not {key!r}"
            raise SimError(f"{path} holds {', '.join(names) or 'nothing'}; name one with {ask}{wrong}")
        try:
            return loaded[name]
        except (OSError, ValueError) as error:
            raise SimError(f"cannot read {name!r} of {path}: {error}") from error
