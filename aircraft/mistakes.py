"""What is wrong with a value in a table, in words: what it is, must be, and may have been meant to be."""

from __future__ import annotations

import difflib
import re
from collections.abc import Sequence
from typing import Any

from msgspec import inspect

_MISSING = re.compile(r"missing required field `(\w+)`")
_LONGEST = 60  # characters shown of a value


def nearest(word: str, known: Sequence[str]) -> str:
    """The end of a message, asking whether one of the known words was meant; empty if none is near."""
    match = difflib.get_close_matches(word, known, n=1, cutoff=0.5)
    return f"; did you mean {match[0]!r}?" if match else ""


def explained(tables: dict[str, Any], info: inspect.Type, complaint: str) -> str:
    """A complaint of msgspec about tables of a type ("Expected `int` <= 7 - at `$.a.b`"), for people."""
    what, _, where = complaint.partition(" - at `$")
    key = where.rstrip("`").lstrip(".")
    kind, value = _found(info, tables, re.findall(r"[^.\[\]]+", key.replace("[...]", "")))
    kind = _one(kind, value)
    if missing := _MISSING.search(what):
        wanted = ""
        if isinstance(kind, inspect.StructType):
            fields = {field.encode_name: field.type for field in kind.fields}
            wanted = f" = {must_be(fields[missing[1]])}"
        return f"{key or 'it'} lacks {missing[1]}; add {missing[1]}{wanted}"
    shown = repr(value) if len(repr(value)) <= _LONGEST else f"{repr(value)[:_LONGEST]}..."
    words = _words(kind)
    meant = nearest(value, words) if isinstance(value, str) else ""
    return f"{key} is {shown}; it must be {must_be(kind) or what}{meant}"


def must_be(kind: inspect.Type) -> str:
    """What a value of a type is; empty if that is no type of our tables."""
    if isinstance(kind, inspect.Metadata):
        return str((kind.extra_json_schema or {}).get("description", "")) or must_be(kind.type)
    if isinstance(kind, inspect.UnionType):
        parts = [must_be(one) for one in kind.types if not isinstance(one, inspect.NoneType)]
        return " or ".join(dict.fromkeys(filter(None, parts)))
    if isinstance(kind, inspect.IntType | inspect.FloatType):
        return ("a whole number" if isinstance(kind, inspect.IntType) else "a number") + _limits(kind)
    if isinstance(kind, inspect.LiteralType | inspect.EnumType):
        words = [repr(word) for word in _words(kind)]
        return words[0] if len(words) == 1 else f"one of {', '.join(words)}"
    if isinstance(kind, inspect.VarTupleType | inspect.ListType):
        least = f"at least {kind.min_length}" if kind.min_length else ""
        most = f"at most {kind.max_length}" if kind.max_length is not None else ""
        bounds = " and ".join(filter(None, (least, most)))
        return f"a list{bounds and f' of {bounds}'}, each {must_be(kind.item_type)}"
    if isinstance(kind, inspect.TupleType):
        return f"a list of {len(kind.item_types)}, each {must_be(kind.item_types[0])}"
    simple = {
        inspect.StrType: "text",
        inspect.BoolType: "true or false",
        inspect.DateTimeType: "a time such as 2022-09-29T06:00:00Z",
        inspect.StructType: "a table",
        inspect.DictType: "a table",
    }
    return simple.get(type(kind), "")


def _limits(kind: inspect.IntType | inspect.FloatType) -> str:
    if kind.ge is not None and kind.le is not None:
        return f" from {kind.ge:g} to {kind.le:.10g}"
    limits = (("above", kind.gt), ("of at least", kind.ge), ("below", kind.lt), ("of at most", kind.le))
    return " and".join(f" {words} {value:.10g}" for words, value in limits if value is not None)


def _words(kind: inspect.Type) -> list[str]:
    """The words that a value may be."""
    if isinstance(kind, inspect.LiteralType):
        return [str(value) for value in kind.values]
    if isinstance(kind, inspect.EnumType):
        return [str(member.value) for member in kind.cls]
    if isinstance(kind, inspect.UnionType):
        return [word for one in kind.types for word in _words(one)]
    return []


def _found(kind: inspect.Type, value: Any, steps: Sequence[str]) -> tuple[inspect.Type, Any]:
    """Type and value at the end of a path through tables and lists."""
    for step in steps:
        kind = _one(kind, value)
        if isinstance(kind, inspect.StructType):
            fields = {field.encode_name: field.type for field in kind.fields}
            kind, value = fields[step], value.get(step)
        elif isinstance(kind, inspect.VarTupleType | inspect.ListType):
            kind, value = kind.item_type, value[int(step)]
        elif isinstance(kind, inspect.TupleType):
            kind, value = kind.item_types[int(step)], value[int(step)]
    return kind, value


def _one(kind: inspect.Type, value: Any) -> inspect.Type:
    """Which of several types a table or a list is of: the table's is named in it."""
    if not isinstance(kind, inspect.UnionType):
        return kind
    if isinstance(value, dict):
        tables = [one for one in kind.types if isinstance(one, inspect.StructType)]
        named = [one for one in tables if one.tag_field and value.get(one.tag_field) == one.tag]
        return next(iter([*named, *tables]), kind)
    if isinstance(value, list):
        lists = (inspect.VarTupleType, inspect.ListType, inspect.TupleType)
        return next((one for one in kind.types if isinstance(one, lists)), kind)
    return kind
