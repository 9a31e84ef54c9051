"""XML an element a line, for KML and GPX."""

from __future__ import annotations

import re
from xml.etree import ElementTree

from planner.export.schedule import Stop

_NOT_IN_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def add(parent: ElementTree.Element, tag: str, text: str = "", **attributes: str) -> ElementTree.Element:
    """Append a child; characters that XML 1.0 cannot hold become U+FFFD."""
    child = ElementTree.SubElement(parent, tag, attributes)
    child.text = _NOT_IN_XML.sub("\ufffd", text) or None
    return child


def to_bytes(root: ElementTree.Element) -> bytes:
    """The document, indented, in UTF-8."""
    ElementTree.indent(root)
    content: bytes = ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)
    return content + b"\n"


def angle(value_deg: float) -> str:
    """Degrees without an exponent, which XML's decimals do not know."""
    return f"{value_deg:.9f}"


def height(stop: Stop) -> str:
    """Metres without an exponent."""
    return f"{stop.altitude_m:.3f}"
