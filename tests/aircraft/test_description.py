import math

import pytest

from aircraft.description import as_written, built_in_names, load_aircraft
from aircraft.errors import ModelError
from aircraft.guidance import Gains
from aircraft.properties import Property

TOML = "aircraft.toml"


def test_the_built_in():
    assert built_in_names() == ["aerosonde", "c172p"]
    for name in built_in_names():
        aircraft = load_aircraft(name)
        assert aircraft.built_in
        assert aircraft.name == name
        assert aircraft.description.description


def test_a_folder_is_found_beside_the_scenario(own):
    folder = own()
    for model, beside in (("mine", folder.parent), ("../mine", folder), (str(folder), folder)):
        aircraft = load_aircraft(model, beside=beside)
        assert (aircraft.path, aircraft.built_in) == (folder, False)


@pytest.mark.parametrize(
    ("model", "said"),
    [
        ("aerosond", r"no aircraft model 'aerosond'.*aerosonde, c172p.*did you mean 'aerosonde'\?"),
        ("x/y", "x/y"),
    ],
)
def test_an_unknown_model(model, said):
    with pytest.raises(ModelError, match=said):
        load_aircraft(model)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            "cruise_mps",
            "cruise_speed_mps",
            r"unknown key 'limits\.cruise_speed_mps'; did you mean 'cruise_mps'",
        ),
        ("cruise_mps = 27.0", "", r"limits lacks cruise_mps; add cruise_mps = a number above 0"),
        ("cruise_mps = 27.0", "cruise_mps = -1.0", r"limits\.cruise_mps is -1\.0"),
        ("cruise_mps = 27.0", 'cruise_mps = "fast"', r"limits\.cruise_mps is 'fast'"),
        ("cruise_mps = 27.0", "cruise_mps = nan", r"limits\.cruise_mps is nan; give a finite number"),
        ("bank_max_deg = 35.0", "bank_max_deg = 90.0", r"limits\.bank_max_deg is 90\.0"),
        ("[limits]", "[limits", "is not TOML"),
        ("[turns]", "[gains]\ncross_track_per_m = 1\n[turns]", r"gains\.cross_track_per_m'; did you mean"),
        ("[turns]", "[gains]\napproach_max_rad = 1\n[turns]", "did you mean 'approach_max_deg'"),
        (
            "[turns]",
            "[properties]\nailerons = 'x'\n[turns]",
            r"properties\.ailerons'; did you mean 'aileron'",
        ),
        ('model = "aerosonde"', "", 'give either model = "x"'),
        ('model = "aerosonde"', 'model = "b"\nbase = "c"', 'give either model = "x"'),
        ('model = "aerosonde"', 'model = "albatross"', r"there is no file .*albatross\.xml"),
        ('model = "aerosonde"', 'base = "c172p"', 'needs autopilot = "autopilot.xml"'),
        ('model = "aerosonde"', 'base = "c172p"\nautopilot = "pilot.xml"', r"there is no file .*pilot\.xml"),
    ],
)
def test_each_mistake_in_the_file_has_its_message(own, old, new, said):
    folder = own(TOML, old, new)
    with pytest.raises(ModelError, match=said) as error:
        load_aircraft(folder)
    assert str(folder / TOML) in str(error.value)


def test_a_folder_without_the_file(tmp_path):
    with pytest.raises(ModelError, match=r"has no aircraft\.toml") as error:
        load_aircraft(tmp_path)
    assert str(error.value).count(str(tmp_path)) == 1


def test_gains_of_its_own(own):
    assert load_aircraft("aerosonde").gains == Gains()
    folder = own(TOML, "[turns]", "[gains]\napproach_max_deg = 45.0\ncourse_per_s = 2\n[turns]")
    gains = load_aircraft(folder).gains
    assert gains.approach_max_rad == pytest.approx(math.radians(45.0))
    assert gains.course_per_s == 2.0
    assert gains.cross_track_per_s == Gains().cross_track_per_s
    assert as_written(gains)["approach_max_deg"] == pytest.approx(45.0)


def test_properties_of_its_own():
    aircraft = load_aircraft("c172p")
    assert aircraft.path_of(Property.AILERON) == "fcs/left-aileron-pos-norm"
    assert aircraft.path_of(Property.ROLL) == Property.ROLL.path
