"""Writes docs/recording.md from the schema and recording.template.md: `make proto`."""

from __future__ import annotations

from pathlib import Path

from recordings.foxglove_fields import FOXGLOVE_FIELDS
from recordings.schema import MESSAGES, SCHEMA_VERSIONS, TOPICS, Message

HERE = Path(__file__).parent


def table(heads: list[str], rows: list[list[str]]) -> str:
    lines = [heads, ["---"] * len(heads), *rows]
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines)


def topics() -> str:
    rows = [
        [f"`{topic.name}`", f"`{topic.message}`", topic.content, topic.rate.value, topic.frame]
        for topic in TOPICS
    ]
    return table(["topic", "message", "what it holds", "rate", "frame"], rows)


def fields(message: Message) -> str:
    names = ", ".join(f"`{topic.name}`" for topic in TOPICS if topic.message == message.name)
    rows = []
    for column in message.columns:
        how_many = ", a list" if column.repeated else ", may be absent" if column.optional else ""
        kind = f"{column.kind.protobuf}{how_many}"
        step = f"{column.step:.1e}" if column.step else ""
        rows.append([f"`{column.name}`", kind, column.unit, column.meaning, step])
    heads = ["field", "type", "unit", "meaning", "rounded to"]
    if not any(row[-1] for row in rows):
        heads, rows = heads[:-1], [row[:-1] for row in rows]
    content = message.content.partition(":")[0].rstrip(".")
    return f"### {names}: `{message.name}`\n\n{content}.\n\n{table(heads, rows)}"


def filled() -> str:
    rows = [
        [f"`{topic.name}`" if not index else "", f"`{field.path}`", field.unit, field.meaning]
        for topic, fields in FOXGLOVE_FIELDS.items()
        for index, field in enumerate(fields)
    ]
    return table(["topic", "field", "unit", "meaning"], rows)


def versions() -> str:
    return table(["schema", "what came new"], [[str(number), new] for number, new in SCHEMA_VERSIONS.items()])


def page() -> str:
    text = (HERE / "recording.template.md").read_text(encoding="utf-8")
    for name, part in (
        ("topics", topics()),
        ("fields", "\n\n".join(map(fields, MESSAGES))),
        ("filled", filled()),
        ("versions", versions()),
    ):
        text = text.replace(f"<!-- {name} -->", part)
    return text


if __name__ == "__main__":
    print(page(), end="")
