"""Limits on a flight, such as `cross_track_m.p95 <= 2`, of texts or a file; docs/limits.md explains."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable
from pathlib import Path

from recordings.errors import BadLimitError
from recordings.judging import judge
from recordings.limit_kinds import Limit
from recordings.limit_names import figure_kinds
from recordings.limit_parser import EXAMPLE, parse_limit
from recordings.verdicts import Verdict

__all__ = ["Limit", "Verdict", "figure_kinds", "judge", "load_limits", "parse_limits"]


def parse_limits(texts: Iterable[str]) -> list[Limit]:
    """Limits from their expressions.

    Raises:
        BadLimitError: if one cannot be understood, or is on something that no flight has.
    """
    return [parse_limit(text) for text in texts]


def load_limits(path: Path) -> list[Limit]:
    """Limits from a TOML file, `limits = ["...", ...]`.

    Raises:
        BadLimitError: if the file cannot be read, holds something else or no limit, or one is bad.
    """
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise BadLimitError(f"cannot read the limits {path}: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise BadLimitError(f"{path} is not text in UTF-8; save it as such") from error
    except tomllib.TOMLDecodeError as error:
        raise BadLimitError(f"{path} is not TOML: {error}") from error
    texts = content.pop("limits", None)
    if content or not isinstance(texts, list) or not all(isinstance(text, str) for text in texts):
        raise BadLimitError(f'{path} must hold `limits = ["...", ...]` and nothing else; {EXAMPLE}')
    if not texts:
        raise BadLimitError(f"{path} holds no limit, so nothing would be checked; {EXAMPLE}")
    return parse_limits(texts)
