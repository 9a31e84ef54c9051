"""TOML turned into a typed object, with one clear message for each mistake in it."""

from __future__ import annotations

import difflib
import math
import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, TypeVar

import msgspec

Table = TypeVar("Table")


class TableError(ValueError):
    """Anything wrong with a file of TOML or in it; the message names file, key, value and remedy."""


def read_toml(path: Path) -> tuple[dict[str, Any], str]:
    """The tables of a file, and its text.

    Raises:
        TableError: if it cannot be read or is not TOML.
    """
    try:
        text = path.read_text(encoding="utf-8")
        return tomllib.loads(text), text
    except (OSError, UnicodeDecodeError) as error:
        raise TableError(f"cannot read {path}: {error}") from error
    except tomllib.TOMLDecodeError as error:
        raise TableError(f"{path} is not TOML: {error}") from error


def convert(tables: dict[str, Any], kind: type[Table], source: str) -> Table:
    """Check tables as TOML gives them and make a msgspec struct of them.

    Raises:
        TableError: naming the key, the value or limit, and the nearest valid key if it is unknown.
    """
    _refuse_unknown_keys(tables, msgspec.inspect.type_info(kind), source)
    for key, value in _leaves(tables):
        if isinstance(value, float) and not math.isfinite(value):
            raise TableError(f"{source}: {key} is {value}; give a finite number")
    try:
        return msgspec.convert(tables, kind)
    except msgspec.ValidationError as error:
        what, _, where = str(error).partition(" - at `$.")
        key = where.rstrip("`")
        given = dict(_leaves(tables)).get(key)
        shown = f" is {given!r}" if given is not None else ""
        raise TableError(f"{source}: {key + shown + ': ' if key else ''}{what}") from error


def nearest(word: str, known: Sequence[str]) -> str:
    """The end of a message, asking whether one of the known words was meant; empty if none is near."""
    match = difflib.get_close_matches(word, known, n=1, cutoff=0.5)
    return f"; did you mean {match[0]!r}?" if match else ""


def _refuse_unknown_keys(value: Any, info: Any, source: str, where: str = "") -> None:
    if isinstance(info, msgspec.inspect.StructType) and isinstance(value, dict):
        fields = {field.encode_name: field.type for field in info.fields}
        for key, inner in value.items():
            if key not in fields:
                remedy = nearest(key, list(fields)) or f"; the keys are {', '.join(fields)}"
                raise TableError(f"{source}: unknown key {where + key!r}{remedy}")
            _refuse_unknown_keys(inner, fields[key], source, f"{where}{key}.")
    elif isinstance(info, msgspec.inspect.VarTupleType) and isinstance(value, list):
        for inner in value:
            _refuse_unknown_keys(inner, info.item_type, source, where)


def _leaves(value: Any, where: str = "") -> Iterator[tuple[str, Any]]:
    """Every plain value with its path, written as msgspec writes it."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _leaves(inner, f"{where}.{key}" if where else key)
    elif isinstance(value, list):
        for index, inner in enumerate(value):
            yield from _leaves(inner, f"{where}[{index}]")
    else:
        yield where, value
