"""TOML turned into a typed object, with one clear message for each mistake in it."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, TypeVar

import msgspec

from aircraft.mistakes import explained, nearest

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
    except OSError as error:
        raise TableError(f"cannot read {path}: {error.strerror}; check the path") from error
    except UnicodeDecodeError as error:
        byte = f"byte 0x{error.object[error.start]:02x} at {error.start}"
        raise TableError(f"cannot read {path}: it is not text in UTF-8 ({byte}); save it as such") from error
    except tomllib.TOMLDecodeError as error:
        raise TableError(f"{path} is not TOML: {error}") from error


def convert(tables: dict[str, Any], kind: type[Table], source: str) -> Table:
    """Check tables as TOML gives them and make a msgspec struct of them.

    Raises:
        TableError: naming the key, the value, what it must be, and the nearest valid word if it is unknown.
    """
    info = msgspec.inspect.type_info(kind)
    _refuse_unknown_keys(tables, info, source)
    for key, value in _leaves(tables):
        if isinstance(value, float) and not math.isfinite(value):
            raise TableError(f"{source}: {key} is {value}; give a finite number")
    try:
        return msgspec.convert(tables, kind)
    except msgspec.ValidationError as error:
        raise TableError(f"{source}: {explained(tables, info, str(error))}") from error


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
    elif isinstance(info, msgspec.inspect.UnionType) and isinstance(value, dict):
        kinds = [kind for kind in info.types if isinstance(kind, msgspec.inspect.StructType)]
        if kinds and kinds[0].tag_field is not None:
            _refuse_unknown_kind(value, kinds, kinds[0].tag_field, source, where)


def _refuse_unknown_kind(
    value: dict[str, Any],
    kinds: Sequence[msgspec.inspect.StructType],
    field: str,
    source: str,
    where: str,
) -> None:
    """The same for a table that is of one of several kinds, which it names."""
    known = {str(kind.tag): kind for kind in kinds}
    if value.get(field) not in known:
        given = repr(value[field]) if field in value else "missing"
        meant = nearest(str(value.get(field)), list(known))
        raise TableError(f"{source}: {where}{field} is {given}; choose one of {', '.join(known)}{meant}")
    named = {key: inner for key, inner in value.items() if key != field}
    _refuse_unknown_keys(named, known[str(value[field])], source, where)


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
