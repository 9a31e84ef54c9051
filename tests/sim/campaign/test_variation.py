"""What is varied, as it is written on the command line."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.campaign.variation import Variation, combinations, parse_variations
from sim.errors import CampaignError
from sim.overrides import value_of

VALUES = st.one_of(
    st.integers(-99, 99).map(str),
    st.floats(allow_nan=False, allow_infinity=False, width=16).map(repr),
    st.sampled_from(["true", "staged", "St Johns", '"a, b"', "'x]y, z'", r'"q\", r"']),
    st.sampled_from(
        ["[]", '[{kind = "engine_failure", time_s = 60}, {kind = "x", time_s = 1}]', "{a = [1, 2]}"]
    ),
)


@given(st.lists(VALUES, min_size=1, max_size=6, unique=True), st.sampled_from([",", ", ", " ,"]))
def test_values_are_those_between_commas_outside_of_quotes_and_brackets(values, comma):
    (found,) = parse_variations([f"planner.kind = {comma.join(values)}"])
    assert found.key == "planner.kind"
    assert [value_of(value) for value in found.values] == [value_of(value) for value in values]


def test_every_value_meets_every_other():
    found = parse_variations(["turbulence.severity=0,3", "planner.kind=staged,windaware"])
    assert combinations(found) == [
        ("turbulence.severity=0", "planner.kind=staged"),
        ("turbulence.severity=0", "planner.kind=windaware"),
        ("turbulence.severity=3", "planner.kind=staged"),
        ("turbulence.severity=3", "planner.kind=windaware"),
    ]
    assert combinations(()) == [()]
    assert parse_variations([str(one) for one in found]) == found
    assert found[0] == Variation("turbulence.severity", ("0", "3"))


@pytest.mark.parametrize(
    ("texts", "words"),
    [
        (["turbulence.severity"], "not of the form"),
        (["=3"], "not of the form"),
        (["turbulence.severity="], "value that is empty"),
        (["turbulence.severity=0,,3"], "value that is empty"),
        (["turbulence.severity=0,3,0"], "the value 0 twice"),
        (["seed=1,2"], "--runs N"),
        (["planner.kind=staged", "planner.kind=windaware"], "given twice"),
    ],
)
def test_what_makes_no_sense_is_refused(texts, words):
    with pytest.raises(CampaignError, match=words):
        parse_variations(texts)
