"""The table of a campaign: its columns, and the Parquet file that is made of the journal."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import Any, get_type_hints

import pyarrow as pa
import pyarrow.parquet as pq

from recordings.limits import figure_kinds
from recordings.tracking import Tracking
from sim.campaign.durable import durably
from sim.campaign.row import MADE_BY, Row
from sim.campaign.variation import Variation
from sim.overrides import key_of, value_of

VARIED = "vary."
"""Before the key of a value that the campaign varies, in the name of its column."""

NOT_REPRODUCED = ("wall_time_s",)
"""Columns that say how fast the computer was: all others are the same whenever a campaign is flown again."""

_ROWS = 4096
_LIMIT = pa.struct(
    [("limit", pa.string()), ("passed", pa.bool_()), ("value", pa.string()), ("margin", pa.float64())]
)


def schema(variations: Iterable[Variation], about: Mapping[str, str]) -> pa.Schema:
    """All columns in order; `about` goes with them."""
    whole = {name for name, hint in get_type_hints(Tracking).items() if hint is int}
    kinds = {bool: pa.bool_(), str: pa.string(), float: pa.float64()}
    figures = {name: pa.int64() if name in whole else kinds[kind] for name, kind in figure_kinds().items()}
    fields: dict[str, pa.DataType] = {"run": pa.int64(), "seed": pa.int64()}
    fields |= {VARIED + variation.key: _kind(variation) for variation in variations}
    fields |= {"outcome": pa.string(), "reason": pa.string(), "passed": pa.bool_()}
    fields |= {name: kind for name, kind in figures.items() if name not in fields}
    fields |= {
        "limits": pa.list_(_LIMIT),
        "recording": pa.string(),
        "recording_bytes": pa.int64(),
        "recording_sha256": pa.string(),
        "overrides": pa.list_(pa.string()),
        "scenario_sha256": pa.string(),
    }
    fields |= {name: pa.string() for name in MADE_BY}
    fields |= dict.fromkeys(NOT_REPRODUCED, pa.float64())
    return pa.schema(list(fields.items()), metadata=dict(about))


def _kind(variation: Variation) -> pa.DataType:
    """Numbers and truth values as such; anything else, or a mixture, as it was written."""
    kinds = {type(value_of(text)) for text in variation.values}
    if kinds == {bool}:
        return pa.bool_()
    if kinds == {int}:
        return pa.int64()
    return pa.float64() if kinds <= {int, float} else pa.string()


def write_table(path: Path, rows: Iterable[Row], columns: pa.Schema, kept: Mapping[int, str]) -> None:
    """Write rows as Parquet, some at a time, whole or not at all.

    Args:
        path: of the file.
        rows: by run.
        columns: see `schema`.
        kept: run to the name of its recording, of those that are kept.
    """
    whole = (_with_columns(row, columns, kept) for row in rows)
    with durably(path) as file, pq.ParquetWriter(file, columns, compression="zstd") as writer:
        for some in _batches(whole):
            writer.write_batch(pa.RecordBatch.from_pylist(some, schema=columns))


def _with_columns(row: Row, columns: pa.Schema, kept: Mapping[int, str]) -> Row:
    varied: dict[str, Any] = {}
    for override in row["overrides"]:
        name, text = VARIED + key_of(override), override.partition("=")[2]
        if name in columns.names:  # others are the same in all flights
            value, is_text = value_of(text), columns.field(name).type == pa.string()
            varied[name] = (value if isinstance(value, str) else text) if is_text else value
    return row | varied | {"recording": kept.get(row["run"])}


def _batches(rows: Iterator[Row]) -> Iterator[Sequence[Row]]:
    while some := list(islice(rows, _ROWS)):
        yield some
