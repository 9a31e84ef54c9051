"""Places and areas as people read them."""

import pytest

from planner.whereabouts import area_text, place_text


@pytest.mark.parametrize(
    ("west_deg", "east_deg", "told"),
    [
        (-93.0, -80.0, "93.00 W to 80.00 W"),
        (267.0, 280.0, "93.00 W to 80.00 W"),
        (-2.0, 2.0, "2.00 W to 2.00 E"),
        (358.0, 362.0, "2.00 W to 2.00 E"),
        (177.0, 184.0, "177.00 E to 176.00 W"),
        (-183.0, -176.0, "177.00 E to 176.00 W"),
        (-180.0, 180.0, "all longitudes"),
        (-180.0, 0.0, "180.00 W to 0.00 E"),
        (0.0, 180.0, "0.00 E to 180.00 E"),
        (0.0, 359.75, "0.00 E to 0.25 W"),
    ],
)
def test_an_area_lies_east_and_west_of_greenwich_however_it_is_counted(west_deg, east_deg, told):
    assert area_text(-1.5, 20.25, west_deg, east_deg) == f"1.50 S to 20.25 N, {told}"


def test_a_place_has_as_many_digits_as_are_asked_for():
    assert place_text(27.56, -83.3) == "27.56 N 83.30 W"
    assert place_text(-27.5, 320.0, 3) == "27.500 S 40.000 W"
    assert place_text(-0.001, -0.001) == "0.00 N 0.00 E"
