"""Texts in letters that the viewer has: one that its font lacks would end it."""

from __future__ import annotations

import unicodedata

_MARKS = "\n–—‘’“”•…−≤≥≠←→↑↓"
_RANGES = ((0x20, 0x7E), (0xA0, 0x148), (0x14A, 0x17F), (0x386, 0x3CE), (0x400, 0x45F))
"""Latin, Greek and Cyrillic as Rerun's own font has them."""


def drawable(text: str) -> str:
    """The text, with a question mark for each letter that cannot be drawn."""
    composed = unicodedata.normalize("NFC", text)
    return "".join(letter if _is_drawable(letter) else "?" for letter in composed)


def _is_drawable(letter: str) -> bool:
    code = ord(letter)
    return letter in _MARKS or (
        any(first <= code <= last for first, last in _RANGES) and unicodedata.category(letter) != "Cn"
    )
