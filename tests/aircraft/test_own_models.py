"""A user's own model, whole and broken in every way that was met, some of which end JSBSim's process."""

import re
import sys

import pytest

from aircraft import envelope_store, own_models
from aircraft.description import load_aircraft
from aircraft.errors import ModelError
from aircraft.jsbsim_aircraft import JsbsimAircraft
from aircraft.own_models import envelope_of
from aircraft.turbulence import Turbulence

AIRFRAME, AUTOPILOT, TOML = "aerosonde.xml", "autopilot.xml", "aircraft.toml"


@pytest.fixture(autouse=True)
def fresh_cache(tmp_path, monkeypatch):
    monkeypatch.setenv(envelope_store.FOLDER_VARIABLE, str(tmp_path / "cache"))
    monkeypatch.setattr(own_models, "_known", {})


@pytest.mark.parametrize(
    ("file", "old", "new", "said"),
    [
        pytest.param(AIRFRAME, "</fdm_config>", "", "cannot load .* XML parse error", id="bad XML"),
        pytest.param(
            AIRFRAME,
            'engine file="aerosonde_engine"',
            'engine file="merlin"',
            "open file: merlin",
            id="engine",
        ),
        pytest.param(AIRFRAME, 'file="autopilot"', 'file="automat"', "open file: automat", id="missing file"),
        pytest.param(
            AUTOPILOT, "-attitude/phi-rad", "-attitude/bank-rad", "cannot run .*attitude/bank-rad", id="read"
        ),
        pytest.param(
            AUTOPILOT,
            "ap/climb-command-fps",
            "ap/climb-order-fps",
            "lacks 1 of .*ap/climb-command-fps",
            id="lack",
        ),
        pytest.param(
            AUTOPILOT, "ap/engaged == 0", "ap/engaged == 0 and more", "cannot load .*0 and more", id="ignored"
        ),
        pytest.param(
            AUTOPILOT,
            "<value> -3.0 </value>",
            "<value> 3.0 </value>",
            "does not hold level flight",
            id="sign",
        ),
        pytest.param(
            TOML,
            "cruise_mps = 27.0",
            "cruise_mps = 70.0",
            r"cannot fly its cruise .*70\.0 m/s.*trim",
            id="trim",
        ),
        pytest.param(
            TOML,
            "[limits]",
            "fuel_kg = 9.0\n[limits]",
            r"take 5\.0 kg, less than the fuel_kg of 9",
            id="fuel",
        ),
        pytest.param(
            AIRFRAME,
            '<alphalimits unit="DEG">',
            '<limits unit="DEG">',
            "cannot load .*XML parse error",
            id="mismatched tag",
        ),
        pytest.param(
            AIRFRAME,
            '<alphalimits unit="DEG"> <min> -8 </min> <max> 14 </max> </alphalimits>',
            "",
            "does not say at which angle of attack it stalls",
            id="no stall",
        ),
    ],
)
def test_a_broken_model_is_told_in_one_message(own, file, old, new, said):
    folder = own(file, old, new)
    with pytest.raises(ModelError, match=said) as error:
        envelope_of(load_aircraft(folder))
    assert "mine" in str(error.value)
    assert "Traceback" not in str(error.value)
    assert str(error.value).count("XML parse error") <= 1  # JSBSim says it twice
    assert not list(folder.parent.glob("cache/envelopes/*"))


@pytest.mark.parametrize(
    ("old", "new", "killed"),
    [
        pytest.param(
            '<function name="aero/pitch-rate-norm">',
            '<function name="aero/empty"/><function name="aero/pitch-rate-norm">',
            r"killed by SIG\w+ .*empty <function>",
            id="empty function",
        ),
        pytest.param(
            "<sense> 1 </sense>", "<sense> clockwise </sense>", r"killed by SIG\w+", id="word for a number"
        ),
        pytest.param(
            "<property> aero/beta-rad </property>",
            "<property> aero/slip-rad </property>",
            r"killed by SIGABRT .*aero/slip-rad does not exist",
            id="unknown property",
        ),
    ],
)
@pytest.mark.skipif(sys.platform == "win32", reason="signals have no names there")
def test_a_model_that_ends_jsbsim_is_told_too(own, old, new, killed):
    with pytest.raises(ModelError, match=killed):
        envelope_of(load_aircraft(own(AIRFRAME, old, new)))


def test_a_model_that_takes_for_ever_is_given_up(own, monkeypatch):
    monkeypatch.setattr(own_models, "TIMEOUT_S", 0.01)
    with pytest.raises(ModelError, match=r"'mine' was still being tried"):
        envelope_of(load_aircraft(own()))


def test_a_whole_model_is_tried_once_and_flies(own, monkeypatch):
    folder = own()
    found = envelope_of(load_aircraft(folder))
    assert found == envelope_of(load_aircraft("aerosonde"))
    monkeypatch.setattr(own_models, "_known", {})
    monkeypatch.setattr(own_models, "_measure_in_child", lambda _: pytest.fail("tried again"))
    aircraft = JsbsimAircraft(str(folder), turbulence=Turbulence(), seed=1)
    assert (aircraft.model, aircraft.envelope) == ("mine", found)
    (folder / "engine" / "aerosonde_engine.xml").write_text("<piston_engine/>")
    with pytest.raises(pytest.fail.Exception, match="tried again"):
        envelope_of(load_aircraft(folder))


def test_a_broken_or_missing_cache_is_harmless(tmp_path, monkeypatch):
    aircraft = load_aircraft("aerosonde")
    found = envelope_of(aircraft)
    (kept,) = (tmp_path / "cache" / "envelopes").iterdir()
    for content in (b"", b'{"airspeed_min_mps": "slow"}', b"\xff\x00", kept.read_bytes()[:40]):
        kept.write_bytes(content)
        assert envelope_store.recall(kept.stem) is None
    monkeypatch.setattr(own_models, "_known", {})
    assert envelope_of(aircraft) == found
    assert envelope_store.recall(kept.stem) == found
    in_the_way = tmp_path / "file"
    in_the_way.touch()
    monkeypatch.setenv(envelope_store.FOLDER_VARIABLE, str(in_the_way))
    envelope_store.store("key", found)
    assert envelope_store.recall("key") is None


def test_the_key_changes_with_everything_that_decides(own):
    folder = own()
    keys = {own_models.fingerprint(load_aircraft(folder))}
    for name in (AIRFRAME, AUTOPILOT, TOML, "engine/aerosonde_propeller.xml"):
        text = (folder / name).read_text()
        (folder / name).write_text(re.sub(r"\Z", "\n" if name == TOML else "<!-- -->", text))
        keys.add(own_models.fingerprint(load_aircraft(folder)))
    assert len(keys) == 5
