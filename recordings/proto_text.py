"""Writes `galeway.proto` from the schema: `make proto`."""

from __future__ import annotations

import textwrap

from recordings.schema import MESSAGES, Column, Message

_HEAD = """\
// The messages of a galeway recording that Foxglove's schemas have no type for.
//
// Written by `make proto` from recordings/schema.py. Units are the suffixes of the names: m, s, mps, rad,
// radps, kg. Wind is the velocity of the air, toward.
syntax = "proto3";

package galeway;
"""
_WIDTH = 110


def proto_text() -> str:
    """The whole file."""
    return "\n".join([_HEAD, *map(_message, MESSAGES)])


def _message(message: Message) -> str:
    fields = "".join(_field(column, number) for number, column in enumerate(message.columns, 1))
    comment = "".join(f"// {line}\n" for line in textwrap.wrap(message.content, _WIDTH - 3))
    return f"{comment}message {message.name.removeprefix('galeway.')} {{\n{fields}}}\n"


def _field(column: Column, number: int) -> str:
    label = "repeated " if column.repeated else "optional " if column.optional else ""
    return f"  {label}{column.kind.protobuf} {column.name} = {number};  // {column.meaning}\n"


if __name__ == "__main__":
    print(proto_text(), end="")
