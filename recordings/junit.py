"""Checked recordings as JUnit XML, which CI servers show as tests: a suite a recording, a case a limit."""

from __future__ import annotations

import re
from collections.abc import Sequence
from xml.etree import ElementTree as ET

from recordings.checking import Checked
from recordings.tracking import Tracking
from recordings.verdicts import Verdict

_NOT_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
KEY_FIGURES = (
    "flight_time_s",
    "cross_track_m.p95",
    "altitude_error_m.p95",
    "waypoint_time_error_s.p95",
    "hazard_exposure_s",
    "min_clearance_m",
)


def properties(tracking: Tracking) -> dict[str, str]:
    """What a flight was and its key figures, by name."""
    told = {name: str(getattr(tracking, name)) for name in ("scenario", "seed", "goal", "outcome")}
    for name in KEY_FIGURES:
        figure, _, part = name.partition(".")
        value = getattr(tracking, figure)
        value = getattr(value, part) if part else value
        told[name] = "none" if value is None else f"{value:.6g}"
    return told


def junit(recordings: Sequence[Checked]) -> bytes:
    """The file for one recording or more."""
    root = ET.Element("testsuites", name="galeway check")
    for checked in recordings:
        root.append(_suite(checked))
    for count in ("tests", "failures", "errors"):
        root.set(count, str(sum(int(suite.get(count, "0")) for suite in root)))
    ET.indent(root)
    content: bytes = ET.tostring(root, encoding="utf-8", xml_declaration=True)
    return content + b"\n"


def _suite(checked: Checked) -> ET.Element:
    suite = ET.Element("testsuite", name=_clean(str(checked.path)))
    tracking = checked.tracking
    if tracking is not None:
        holder = ET.SubElement(suite, "properties")
        for name, value in properties(tracking).items():
            ET.SubElement(holder, "property", name=name, value=_clean(value))
    group = f"{tracking.scenario}.seed-{tracking.seed}" if tracking is not None else checked.path.stem
    for verdict in checked.verdicts:
        case = _case(suite, group, str(verdict.limit))
        if not verdict.passed:
            _add(case, "failure", str(verdict), _type(verdict))
    if checked.missing:
        _add(_case(suite, group, "recording is complete"), "failure", checked.missing, "incomplete")
    if checked.error:
        _add(_case(suite, group, "recording can be checked"), "error", checked.error, "not checked")
    counts = {"tests": "testcase", "failures": "testcase/failure", "errors": "testcase/error"}
    for count, found in counts.items():
        suite.set(count, str(len(suite.findall(found))))
    suite.set("skipped", "0")
    return suite


def _type(verdict: Verdict) -> str:
    return "not measured" if verdict.value is None else "limit broken"


def _case(suite: ET.Element, group: str, name: str) -> ET.Element:
    return ET.SubElement(suite, "testcase", classname=_clean(group), name=_clean(name))


def _add(case: ET.Element, tag: str, message: str, kind: str) -> None:
    ET.SubElement(case, tag, message=_clean(message), type=kind).text = _clean(message)


def _clean(text: str) -> str:
    """Without the characters that XML cannot hold, not even escaped."""
    return _NOT_XML.sub("\ufffd", text)
