"""What can be written as a limit, and what is said of what cannot."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from recordings.errors import BadLimitError
from recordings.limit_kinds import (
    PHASES,
    Always,
    Compared,
    During,
    Happening,
    Never,
    Span,
    Time,
    Timely,
    Within,
)
from recordings.limit_names import figure_kinds
from recordings.limit_parser import parse_limit
from recordings.quantities import DURATIONS, QUANTITIES
from recordings.recorder import Outcome

numbers = st.floats(allow_nan=False, allow_infinity=False)
times = st.builds(Time, st.integers(0, 400_000)) | st.builds(
    Time, st.integers(0, 4_000_000_000), st.just(True)
)
durings = st.builds(
    During, st.lists(st.sampled_from(list(PHASES)), min_size=1, max_size=3).map(tuple), st.booleans()
)


@st.composite
def spans(draw):
    start, end = draw(st.none() | times), draw(st.none() | times)
    if start is None and end is None:
        start = draw(times)
    if start is not None and end is not None and start.absolute == end.absolute:
        start, end = sorted((start, end), key=lambda time: time.time_s)
        end = Time(end.time_s + 1, end.absolute)
    return Span(start, end, draw(st.booleans()))


windows = st.lists(durings | spans(), max_size=3).map(tuple)
percentiles = st.integers(0, 100).map(lambda share: f"p{share}") | st.just("p99.9")
statistics = st.builds(
    lambda name, of: f"{name}.{of}",
    st.sampled_from(list(QUANTITIES)),
    st.sampled_from(["mean", "min", "max"]) | percentiles,
)
comparisons = st.sampled_from(["<", "<=", ">", ">=", "==", "!="])
happenings = st.builds(Happening, st.sampled_from(list(Outcome)).map(str), st.just(False)) | st.builds(
    Happening, st.text(min_size=1).filter(str.strip), st.just(True)
)
quantities = st.sampled_from(list(QUANTITIES))
limits = st.one_of(
    st.builds(Compared, statistics | st.sampled_from(list(DURATIONS)), comparisons, numbers, windows),
    st.builds(
        Compared,
        st.sampled_from([name for name, kind in figure_kinds().items() if kind is float]),
        comparisons,
        numbers,
    ),
    st.builds(Compared, st.sampled_from(["scenario", "goal"]), st.sampled_from(["==", "!="]), st.text()),
    st.builds(Compared, st.just("arrived"), st.sampled_from(["==", "!="]), st.booleans()),
    st.builds(Within, quantities, st.none(), numbers.filter(lambda size: size > 0.0), windows),
    st.tuples(numbers, numbers)
    .filter(lambda bounds: bounds[0] < bounds[1])
    .flatmap(lambda bounds: st.builds(Within, quantities, st.just(bounds[0]), st.just(bounds[1]), windows)),
    st.builds(Always, quantities, st.sampled_from(["<", "<=", ">", ">="]), numbers, windows),
    st.builds(Never, happenings, windows),
    st.builds(Timely, happenings, st.booleans(), times),
)


@given(limits)
def test_a_limit_is_read_as_it_is_written(limit):
    assert parse_limit(str(limit)) == limit


@pytest.mark.parametrize(
    "text",
    [
        "cross_track_m.p95 <= 2",
        'cross_track_m.p99.5 < 2.5 during "turn" or "loiter" except from 0:10 to 0:11:30',
        'altitude_error_m within 10 except during "takeoff"',
        "altitude_m within 950 to 1050 until 2:00",
        "airspeed_mps always >= 18",
        "hazard_exposure_s == 0 from 1:00",
        "never crashed",
        'never "engine" during "leg"',
        "arrived before 12:00",
        "arrived before 2022-09-29T12:00Z",
        '"holding" after 0:00:05',
        'goal == "São Tomé"',
    ],
)
def test_a_limit_is_written_as_it_is_read(text):
    assert str(parse_limit(text)) == text


def test_space_does_not_matter_and_numbers_may_be_written_otherwise():
    assert str(parse_limit("  seed<1e6\n")) == "seed < 1000000"
    assert str(parse_limit("cross_track_m.p95<=.5 from 01:00 to 90:00:00")) == (
        "cross_track_m.p95 <= 0.5 from 1:00 to 90:00"
    )


@pytest.mark.parametrize(
    ("limit", "message"),
    [
        ("", 'at its end: expected a name such as cross_track_m.p95, never, or the "words" of an event'),
        ("arrived", "at its end: expected one of <= >= == != < > or within, always, before"),
        ("2 >= cross_track_m.p95", "at '2', character 1: expected a name"),
        ("cross_track_m.p95 =< 2", "at '=', character 19: expected one of <="),
        ("cross_track_m.p95 = 2", "at '=', character 19"),
        ("cross_track_m.p95 <=", "at its end: expected a number"),
        ("cross_track_m.p95 <= 2 and arrived == true", "at 'and', character 24: expected nothing more"),
        ("cross_track_m.p95 <= 2 m", "no unit: it is in the name"),
        ("cross_track_m.p95 <= two", "with two, but cross_track_m.p95 is a number"),
        ("cross_track_m.p95 <= NaN", "is a number"),
        ("cross_track_m.p95 <= Infinity", "is a number"),
        ("cross_track_m.p95 <= 1" + "0" * 400, "too large"),
        ("cross_track_m.p95 <= true", "is a number"),
        ("cross_track_m.p95 <= [2]", "is a number"),
        ("arrived == 1", "arrived is true or false"),
        ("arrived == null", "arrived is true or false"),
        ("arrived <= true", "use =="),
        ('outcome < "arrived"', "use =="),
        ("outcome == 3", 'outcome is a "text"'),
        ('outcome != "crahsed"', "did you mean crashed"),
        ("cros_track_m.p95 <= 2", "did you mean cross_track_m.p95?"),
        ("cros_track_m.p97 <= 2", "did you mean cross_track_m.p97?"),
        ("arived == true", "did you mean arrived?"),
        ("cross_track_m.p101 <= 2", "mean, min, max and percentiles such as p95"),
        ("cross_track_m.median <= 2", "is on median of cross_track_m"),
        ("cross_track_m. <= 2", "no statistic of cross_track_m"),
        ("cross_track_m <= 2", "cross_track_m.mean or cross_track_m.p95 or cross_track_m.max"),
        ("series <= 2", "no report has"),
        ("real_time_factor >= 10", "stands in report.json alone"),
        ("real_time_factor within 10", "stands in report.json alone"),
        ("worst.arrived <= 2", "no report has"),
        ("recording == 2", "no report has"),
        ("__class__ == 2", "no report has"),
        ("altitude_eror_m within 10", "did you mean altitude_error_m?"),
        ("altitude_error_m.max within 10", "did you mean altitude_error_m?"),
        ("delay_s within 10", "which is one figure; write `delay_s <= …`"),
        ("altitude_error_m within 0", "expected a size above zero"),
        ("altitude_error_m within 5 to 5", "expected a bound above 5"),
        ("altitude_error_m within", "at its end: expected a number"),
        ("airspeed_mps always 18", "at '18', character 21: expected one of <= >= < >"),
        ("airspeed_mps always == 18", "expected one of <= >= < >"),
        ('bank_deg within 30 during "trun"', "takeoff, lead_in, leg, turn, loiter, did you mean turn?"),
        ("bank_deg within 30 during turn", "a phase in quotes"),
        ('bank_deg within 30 except "turn"', "expected during or from or until"),
        ("bank_deg within 30 from 2:00 to 1:00", "put the earlier one first"),
        ("bank_deg within 30 from 90", "a time since departure such as 1:30"),
        ("bank_deg within 30 from 1:60", "minutes or seconds are over 59"),
        ("arrived before noon", "a time since departure such as 1:30"),
        ("arrived before 2022-13-29T12:00Z", "which no calendar has"),
        ("arrived before 12:00Z", "expected"),
        ("never", "an end of the flight (arrived, crashed"),
        ("never crahsed", "did you mean crashed?"),
        ("never engine", 'The words of an event stand in quotes: "engine"'),
        ('never " "', "without a word"),
        (r'never "\q"', "backslash"),
        ('"holding"', "expected before or after"),
        ('"holding', "character 1"),
        ('planned_time_s <= 480 during "leg"', "planned_time_s is of the whole"),
        ("min_clearance_m > 5 from 1:00", "min_clearance_m is of the whole"),
    ],
)
def test_limits_that_are_refused(limit, message):
    with pytest.raises(BadLimitError) as refused:
        parse_limit(limit)
    assert message in str(refused.value)
    assert repr(limit) in str(refused.value)


@given(
    text=st.text(max_size=40)
    | limits.map(str).flatmap(
        lambda whole: st.integers(0, len(whole)).map(lambda at: whole[:at] + whole[at + 1 :])
    )
)
def test_any_text_is_a_limit_or_refused(text):
    try:
        limit = parse_limit(text)
    except BadLimitError:
        return
    assert parse_limit(str(limit)) == limit
