"""The table as text and as data."""

import json

import numpy as np

from planner.departure_table import DepartureTable, clock, percent
from planner.departures import BestBy, Departures, choose_slots

ARRIVALS = np.array([[30, -1, 40], [45, -1, 39]], dtype=np.int32)
SURVIVAL = np.array([[0.5, 0.0, 0.25], [0.875, 0.0, 1.0]])


def table(by=BestBy.ARRIVAL, survival=None, distinct=False):
    departures = Departures((0, 15), ((0, 1), (0, 2), (0, 3)), 120.0, ARRIVALS, survival)
    chosen = choose_slots(departures, by, distinct=distinct)
    return DepartureTable(departures, by, distinct, chosen, ("A", "B", "C"))


def test_text():
    assert table().text("noon").splitlines() == [
        "arrival against departure, h:mm after noon; * is chosen",
        "departure     A    B       C",
        "     0:00  1:00 *  -    1:20",
        "     0:30  1:30    -    1:18 *",
        "A: leave at 0:00, 1:00 h of flight",
        "B: no departure reaches it",
        "C: leave at 0:30, 0:48 h of flight",
    ]
    safest = table(BestBy.SURVIVAL, SURVIVAL).text()
    assert "1:30 87.5 % *" in safest
    assert "1:18 100 % *" in safest
    assert "1:30 (1:00)" in table(BestBy.FLIGHT).text()


def test_a_fleet_tells_its_total_and_who_stays_behind():
    departures = Departures((0,), ((0, 1), (0, 3)), 120.0, np.array([[30, 40]], dtype=np.int32))
    chosen = choose_slots(departures, BestBy.ARRIVAL, distinct=True)
    text = DepartureTable(departures, BestBy.ARRIVAL, True, chosen, ("A", "C")).text()
    assert "A: leave at 0:00" in text
    assert "C: all 1 departure slots are better used for other goals; give more" in text
    assert text.endswith("total: 1500 min, 1440 of them for each of 1 goals missed")


def test_data_is_plain():
    found = table(BestBy.SURVIVAL, SURVIVAL).to_dict()
    assert json.loads(json.dumps(found)) == found
    assert found["table"][1] == {
        "depart_min": 30.0,
        "arrival_min": [90.0, None, 78.0],
        "flight_min": [60.0, None, 48.0],
        "survival": [0.875, None, 1.0],
    }
    assert [choice["depart_min"] for choice in found["chosen"]] == [30.0, None, 30.0]
    assert "survival" not in table().to_dict()["table"][0]


def test_times_and_chances():
    assert (clock(0.0), clock(59.6), clock(1439.0)) == ("0:00", "1:00", "23:59")
    assert (percent(1.0), percent(0.0453), percent(0.0)) == ("100 %", "4.53 %", "0 %")
