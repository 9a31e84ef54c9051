"""How far a campaign is."""

import pytest

from sim.campaign.progress import Progress, counted


@pytest.mark.parametrize(
    ("per_flight_s", "words"),
    [
        (400.0, "9.0 flights an hour, 9:54 h left"),
        (36.0, "100 flights an hour, 54 min left"),
        (1.2, "3000 flights an hour, 2 min left"),
        (0.5, "120 flights a minute, 44 s left"),
    ],
)
def test_rate_and_time_left_are_of_the_flights_of_this_time(per_flight_s, words):
    now_s = 1000.0
    progress = Progress(lambda: now_s)
    progress.begin(100, 1)
    assert progress.line() == "0 failed"
    for passed in (True, False, True, True, True, True, True, False, True, True):
        now_s += per_flight_s
        progress.landed({"passed": passed})
    assert (progress.done, progress.total) == (11, 100)
    assert progress.line() == f"2 failed, {words}"


def test_one_flight_is_one():
    assert [counted(number) for number in (0, 1, 2)] == ["0 flights", "1 flight", "2 flights"]
