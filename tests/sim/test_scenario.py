"""Scenarios: what ships is sound, and what is wrong is named."""

import math

import pytest

from sim.errors import ScenarioError
from sim.scenario import built_in_names, load_scenario

MINIMAL = """
name = "mine"
[mission]
departure = 2022-09-29T06:00:00Z
goal = "b"
start = { name = "a", lat_deg = 29.0, lon_deg = -90.0 }
goals = [{ name = "b", lat_deg = 28.0, lon_deg = -89.0 }]
[weather]
file = "wind.nc"
"""


@pytest.fixture
def write(tmp_path):
    def written(text):
        path = tmp_path / "mine.toml"
        path.write_text(text, encoding="utf-8")
        return str(path)

    return written


def test_ian_is_the_paper_sized_mission():
    loaded = load_scenario("ian")
    scenario = loaded.scenario
    assert (scenario.stages.count, scenario.stages.steps, scenario.stages.step_s) == (18, 30, 120.0)
    assert scenario.mission.departure_s == 1664409600.0  # 2022-09-29 00:00 UTC
    assert scenario.hazard.threshold_mps == 15.0
    assert len(scenario.mission.goals) == 10
    assert scenario.limits
    assert loaded.toml.startswith("# Hurricane Ian")


@pytest.mark.parametrize("name", built_in_names())
def test_every_built_in_scenario_loads(name):
    assert load_scenario(name).scenario.name == name


def test_an_own_file_gets_defaults(write):
    loaded = load_scenario(write(MINIMAL))
    assert loaded.scenario.weather.file == "wind.nc"
    assert loaded.scenario.hazard.threshold_mps == 15.0
    assert loaded.scenario.grid.south_deg is None


@pytest.mark.parametrize(
    ("override", "get", "value"),
    [
        ("turbulence.severity=4", lambda s: s.turbulence.severity, 4),
        ("turbulence.kind=none", lambda s: s.turbulence.kind, "none"),
        ("mission.goal=Key West", lambda s: s.mission.goal, "Key West"),
        ('mission.goal="Key West"', lambda s: s.mission.goal, "Key West"),
        ("hazard.forecast_error_mps=3", lambda s: s.hazard.forecast_error_mps, 3.0),
        ("hazard.threshold_mps=20", lambda s: s.hazard.threshold_mps, 20.0),
        ("limits=[]", lambda s: s.limits, ()),
        ("flight.sensors=gps", lambda s: s.flight.sensors, "gps"),
        ("seed=9", lambda s: s.seed, 9),
        ("mission.departure=2022-09-29T06:00:00", lambda s: s.mission.departure_s, 1664431200.0),
    ],
)
def test_overrides(override, get, value):
    loaded = load_scenario("ian", [override])
    assert get(loaded.scenario) == value
    assert f"# --set {override}\n" in loaded.toml


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("turbulence.severty=4", r"unknown key 'turbulence.severty'; did you mean 'severity'"),
        ("turbulence.severity=9", r"turbulence.severity is 9; it must be a whole number from 0 to 7"),
        ("turbulence.severity=high", r"turbulence.severity is 'high'; it must be a whole number"),
        ("mission.goal=Miamy", r"'Miamy' is not among the goals .*did you mean 'Miami'"),
        ("planner.kind=magic", r"planner.kind is 'magic'; it must be one of 'staged', 'windaware'$"),
        ("hazard.threshold_mps=nan", r"hazard.threshold_mps is nan; give a finite number"),
        ("hazard.threshold_mps=-1", r"hazard.threshold_mps"),
        ("flight.guidance_hz=7", r"no multiple"),
        ("flight.sensors=gyro", r"flight.sensors is 'gyro'; it must be one of 'gps', 'perfect'$"),
        ("flight.sensors=gsp", r"did you mean 'gps'"),
        ("weather.member=-1", r"weather.member is -1; it must be a whole number of at least 0 or 'mean'"),
        ("weather.file=[]", r"weather.file is \[\]; it must be a list of at least 1, each text"),
        (
            "mission.levels_m=[100,200,300,400,500,600,700,800,900]",
            r"must be a list of at most 8, each a number from 50 to 6000",
        ),
        ("weather.variables=['u']", r"is \['u'\]; it must be a list of 2, each text"),
        ("weather.variables=['u', 3]", r"variables\[1\] is 3; it must be text"),
        ("weather.calm=3", r"weather.calm is 3; it must be true or false"),
        ("mission.departure=noon", r"departure is 'noon'; it must be a time such as 2022"),
        ("mission.start=3", r"mission.start is 3; it must be a table"),
        ("mission={}", r"mission lacks departure; add departure = a time"),
        ("name=a/b", r"name is 'a/b'; it must be letters, digits"),
        ("faults=[{kind='engine_fail', time_s=1}]", r"faults\[0\].kind is .*did you mean 'engine_failure'"),
        ("faults=[{kind='wind_step'}]", r"faults\[0\] lacks time_s; add time_s = a number of at least 0"),
        (
            "hazard.also=[{kind='gust'}]",
            r"also\[0\] lacks threshold_mps; add threshold_mps = a number",
        ),
        ("hazard.also=[{kind='gusts'}]", r"also.kind is 'gusts'; choose .*did you mean 'gust'"),
        ("planner.alpha=-1", r"planner.alpha is -1; it must be a number of at least 0$"),
        ("grid.south_deg=40", r"not south of"),
        ("seed", r"not of the form"),
        ("seed.more=1", r"'seed' is a value, not a table"),
        ("mission.start.lat_deg=95", r"lat_deg"),
        ("hazard.forecast_error_mps=-1", r"forecast_error_mps"),
        ("planner.objective=survival", r"needs hazard.forecast_error_mps above 0"),
        ("planner.abstain_below=0.5", r"abstain_below is 0.5, but .* needs hazard.forecast_error_mps"),
        ("planner.abstain_below=1.5", r"abstain_below is 1.5; it must be a number from 0 to 1"),
        ("planner.objective=fuel", r"'fuel' is not one of the staged planner"),
    ],
)
def test_wrong_overrides_are_named(override, message):
    with pytest.raises(ScenarioError, match=message):
        load_scenario("ian", [override])


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "lon_deg = -89.0",
            "long_deg = -89.0",
            "unknown key 'mission.goals.long_deg'; did you mean 'lon_deg'",
        ),
        ("[weather]", "[wether]", "unknown key 'wether'; did you mean 'weather'"),
        ("departure = 2022-09-29T06:00:00Z", "", "departure"),
        ("lat_deg = 28.0", "lat_deg = nan", "lat_deg is nan"),
        ('name = "mine"', 'name = "my/../mine"', "name"),
        ("[weather]", "[weather", "is not TOML"),
        ('file = "wind.nc"', "", "needs storm"),
        (
            'goals = [{ name = "b"',
            'goals = [{ name = "b", lat_deg = 1.0, lon_deg = 1.0 }, { name = "b"',
            "one name",
        ),
    ],
)
def test_wrong_files_are_named(write, old, new, message):
    assert old in MINIMAL
    with pytest.raises(ScenarioError, match=message):
        load_scenario(write(MINIMAL.replace(old, new, 1)))


def test_a_missing_scenario_names_those_that_ship():
    with pytest.raises(ScenarioError, match="did you mean 'ian'"):
        load_scenario("iann")
    with pytest.raises(ScenarioError, match="neither a file nor one of"):
        load_scenario("missing.toml")


def test_a_folder_is_no_scenario(tmp_path):
    with pytest.raises(ScenarioError, match="it is a folder; name a TOML file"):
        load_scenario(str(tmp_path))


def test_binary_rubbish_is_refused(tmp_path):
    path = tmp_path / "rubbish.toml"
    path.write_bytes(bytes(range(128, 256)))
    with pytest.raises(ScenarioError, match=r"not text in UTF-8 \(byte 0x80 at 0\); save it"):
        load_scenario(str(path))


def test_local_time_without_offset_is_utc(write):
    loaded = load_scenario(write(MINIMAL.replace("T06:00:00Z", "T06:00:00")))
    assert math.isclose(loaded.scenario.mission.departure_s, 1664431200.0)
