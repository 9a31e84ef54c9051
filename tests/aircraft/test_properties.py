import math

import pytest

from aircraft.errors import ModelError
from aircraft.properties import Property, check_properties

FACTORS = {
    "1": 1.0,
    "rad": 1.0,
    "rad/s": 1.0,
    "ft": 0.3048,
    "ft/s": 0.3048,
    "lb": 0.45359237,
    "lb/s": 0.45359237,
}
SUFFIXES = {
    "ft": ("-ft",),
    "ft/s": ("-fps",),
    "rad": ("-rad",),
    "rad/s": ("-rad_sec",),
    "lb": ("-lbs",),
    "lb/s": ("-pps",),
}


@pytest.mark.parametrize("member", Property)
def test_factor_and_path_follow_the_unit(member: Property) -> None:
    assert math.isclose(member.to_si, FACTORS[member.unit], rel_tol=0.0, abs_tol=0.0)
    assert member.path.endswith(SUFFIXES.get(member.unit, ("",)))


def test_no_property_is_listed_twice() -> None:
    assert len({member.path for member in Property}) == len(Property.__members__)


def test_a_complete_model_passes() -> None:
    check_properties("complete", lambda _: True)


def test_every_missing_property_is_named() -> None:
    missing = {Property.ROLL_COMMAND.path, Property.FUEL.path}
    with pytest.raises(ModelError, match=r"'halfway' lacks 2 of the \d+ properties") as error:
        check_properties("halfway", lambda path: path not in missing)
    assert all(path in str(error.value) for path in missing)
