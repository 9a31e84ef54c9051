"""Values put in place of a scenario's own: "table.key=value"."""

from __future__ import annotations

import tomllib
from typing import Any

from sim.errors import ScenarioError


def value_of(text: str) -> Any:
    """What a text means: a value in TOML, or a bare word."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text.strip()


def key_of(override: str) -> str:
    """What is in front of the value."""
    return override.partition("=")[0].strip()


def put(tables: dict[str, Any], override: str) -> None:
    """Put a value into the tables of a scenario; whether it makes sense there is not asked.

    Raises:
        ScenarioError: if it has no key or no value, or its key leads through a value.
    """
    key, equals, text = override.partition("=")
    *path, last = key.strip().split(".")
    if not equals or not last:
        raise ScenarioError(f"--set {override!r} is not of the form table.key=value")
    for name in path:
        tables = tables.setdefault(name, {})
        if not isinstance(tables, dict):
            raise ScenarioError(f"--set {override!r}: {name!r} is a value, not a table")
    tables[last] = value_of(text)
