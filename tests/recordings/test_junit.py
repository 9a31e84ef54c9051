"""JUnit XML, read by a reader of somebody else, and by the rules of the format."""

from dataclasses import replace
from pathlib import Path

import junitparser
import pytest
from lxml import etree

from recordings.checking import Checked
from recordings.junit import junit
from recordings.limits import judge, parse_limits
from recordings.tracking import track

SCHEMA = etree.RelaxNG(
    etree.fromstring(
        """
<grammar xmlns="http://relaxng.org/ns/structure/1.0" datatypeLibrary="http://www.w3.org/2001/XMLSchema-datatypes">
 <define name="counts">
  <attribute name="name"/>
  <attribute name="tests"><data type="nonNegativeInteger"/></attribute>
  <attribute name="failures"><data type="nonNegativeInteger"/></attribute>
  <attribute name="errors"><data type="nonNegativeInteger"/></attribute>
 </define>
 <define name="trouble"><attribute name="message"/><attribute name="type"/><text/></define>
 <start>
  <element name="testsuites"><ref name="counts"/><zeroOrMore><ref name="suite"/></zeroOrMore></element>
 </start>
 <define name="suite"><element name="testsuite">
  <ref name="counts"/>
  <attribute name="skipped"><data type="nonNegativeInteger"/></attribute>
  <optional><element name="properties"><oneOrMore><element name="property">
   <attribute name="name"/><attribute name="value"/>
  </element></oneOrMore></element></optional>
  <zeroOrMore><element name="testcase">
   <attribute name="classname"/><attribute name="name"/>
   <optional><choice>
    <element name="failure"><ref name="trouble"/></element>
    <element name="error"><ref name="trouble"/></element>
   </choice></optional>
  </element></zeroOrMore>
 </element></define>
</grammar>"""
    )
)
"""The part of the usual JUnit format that is written: elements, their order, attributes and counts."""

LIMITS = ("cross_track_m.p95 <= 2", "cross_track_m.p95 <= 5", 'cross_track_m within 1 during "loiter"')


@pytest.fixture(scope="module")
def checked(kept):
    tracking = track(kept.recording(kept.fly(kept.header(kept.straight), right_m=3.0)))
    return Checked(Path("runs/a&b/flight.mcap"), tracking, tuple(judge(tracking, parse_limits(LIMITS))))


def read(content):
    SCHEMA.assertValid(etree.fromstring(content))
    return list(junitparser.JUnitXml.fromstring(content))


def test_a_case_a_limit(checked):
    (suite,) = read(junit([checked]))
    assert suite.name == "runs/a&b/flight.mcap"
    assert (suite.tests, suite.failures, suite.errors, suite.skipped) == (3, 2, 0, 0)
    cases = list(suite)
    assert [case.name for case in cases] == list(LIMITS)
    assert {case.classname for case in cases} == {"squall.seed-7"}
    broken, passed, untested = cases
    assert passed.is_passed
    (failure,) = broken.result
    assert (failure.type, failure.message) == ("limit broken", str(checked.verdicts[0]))
    assert failure.text.startswith("FAIL cross_track_m.p95 <= 2: 3 (over by 1), worst 3 m at 00:")
    (failure,) = untested.result
    assert failure.type == "not measured"
    told = {held.name: held.value for held in suite.properties()}
    assert (told["scenario"], told["seed"], told["outcome"]) == ("squall", "7", "arrived")
    assert float(told["cross_track_m.p95"]) == pytest.approx(3.0, abs=1e-3)


def test_what_is_wrong_with_a_recording_is_a_case_too(checked):
    cut = replace(checked, missing="how the flight ended")
    bad = Checked(Path("rubbish.mcap"), None, (), error="rubbish.mcap is no MCAP file")
    whole, part, rubbish = read(junit([checked, cut, bad]))
    assert (whole.failures, part.failures, rubbish.failures) == (2, 3, 0)
    assert list(part)[-1].name == "recording is complete"
    assert (rubbish.tests, rubbish.errors) == (1, 1)
    root = etree.fromstring(junit([checked, cut, bad]))
    assert (root.get("tests"), root.get("failures"), root.get("errors")) == ("8", "5", "1")


def test_nothing_breaks_the_format(checked):
    strange = replace(checked, missing='\x00 "quoted" <b> & ]]> \ud800 \n\x1b[31m')
    (suite,) = read(junit([strange]))
    (failure,) = list(suite)[-1].result
    assert '"quoted" <b> & ]]>' in failure.message
