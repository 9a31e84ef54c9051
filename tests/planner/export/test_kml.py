"""KML, judged by the OGC schema with Google's extensions that fastkml ships, and read by fastkml."""

import io

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.export.kml import to_kml

etree = pytest.importorskip("lxml.etree", reason="the schema validator lxml is missing")
fastkml = pytest.importorskip("fastkml", reason="the reader fastkml is missing")
validator = pytest.importorskip("fastkml.validator", reason="the reader fastkml is missing")


def read(plan):
    """The placemarks, once the schema has taken the file."""
    text = to_kml(plan)
    validator.get_schema_parser().assertValid(etree.fromstring(text))
    (document,) = fastkml.KML.parse(io.BytesIO(text)).features
    return document.features


@settings(deadline=None)
@given(data=st.data())
def test_positions_times_and_waits_come_back(journeys, data):
    plan, visits = data.draw(journeys)
    route, start, *loiters = read(plan)
    found = [(*item.coord.coords[0], item.when.dt.timestamp()) for item in route.kml_geometry.track_items]
    assert found == [
        pytest.approx((visit.lon_deg, visit.lat_deg, visit.altitude_m, plan.departure_s + time_s), rel=1e-15)
        for visit in visits
        for time_s in visit.times_s
    ]
    assert start.times.timestamp.dt.timestamp() == plan.departure_s
    spans = [
        (loiter.times.begin.dt.timestamp(), loiter.times.end.dt.timestamp(), loiter.geometry.coords[0])
        for loiter in loiters
    ]
    assert spans == [
        (
            pytest.approx(plan.departure_s + visit.arrive_s, rel=1e-15),
            pytest.approx(plan.departure_s + visit.leave_s, rel=1e-15),
            pytest.approx((visit.lon_deg, visit.lat_deg, visit.altitude_m)),
        )
        for visit in visits
        if len(visit.times_s) == 2
    ]


def test_heights_are_absolute_and_goals_tell_their_outcome(short_plan):
    route, start, loiter, reached, missed = read(short_plan)
    assert route.kml_geometry.altitude_mode.value == "absolute"
    assert start.kml_geometry.altitude_mode.value == "absolute"
    assert loiter.description == "600 s"
    assert (reached.name, reached.description) == ("Tampa", "reached 2022-09-28T00:16:00Z")
    assert (missed.name, missed.description) == ("Ponce & <co>", "no route: no safe way")
    assert missed.geometry.coords[0] == (-66.0, 18.0)


def test_the_schema_would_find_a_misplaced_element(short_plan):
    text = to_kml(short_plan).replace(b"<altitudeMode>absolute</altitudeMode>", b"", 1)
    broken = text.replace(b"</gx:Track>", b"<altitudeMode>absolute</altitudeMode></gx:Track>")
    with pytest.raises(etree.DocumentInvalid):
        validator.get_schema_parser().assertValid(etree.fromstring(broken))
