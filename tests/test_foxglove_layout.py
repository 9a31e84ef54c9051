"""The Foxglove layout names what a real recording holds; how it looks, tests/interop/foxglove shows."""

import itertools
import json
import re
import runpy
import subprocess
import sys
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

ROOT = Path(__file__).parent.parent
LAYOUT = json.loads((ROOT / "docs" / "foxglove_layout.json").read_text(encoding="utf-8"))
PANELS = LAYOUT["configById"]
POSITIONS = {"foxglove.LocationFix", "foxglove.GeoJSON"}
SCENES = [panel for name, panel in PANELS.items() if name.startswith("3D!")]
SCENE = {"foxglove.Grid", "foxglove.PosesInFrame", "foxglove.PoseInFrame"}


@pytest.fixture(scope="module")
def recorded():
    """Topic to type and first message, decoded by what is in the file alone."""
    found = {}
    with (ROOT / "tests" / "golden" / "schema-3.mcap").open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        for schema, channel, _, message in reader.iter_decoded_messages():
            found.setdefault(channel.topic, (schema.name, message))
    return found


def leaves(node):
    if isinstance(node, str):
        held = [leaves(tab["layout"]) for tab in PANELS[node].get("tabs", [])]
        return [node, *itertools.chain.from_iterable(held)]
    assert node["direction"] in ("row", "column")
    assert 0 < node["splitPercentage"] < 100
    return leaves(node["first"]) + leaves(node["second"])


def paths():
    for panel in PANELS.values():
        for series in panel.get("paths", []):
            yield series["value"]


def test_every_panel_has_its_place():
    assert sorted(leaves(LAYOUT["layout"])) == sorted(PANELS)


def test_every_path_is_a_number_of_a_message(recorded):
    assert len(list(paths())) > 8
    for path in paths():
        topic, field = re.fullmatch(r"(/[\w/]+)\.(\w+)", path).groups()
        assert isinstance(getattr(recorded[topic][1], field), int | float), path


def test_topics_are_of_the_types_that_their_panels_show(recorded):
    shown = {topic: recorded[topic][0] for topic in PANELS["map!position"]["topicConfig"]}
    shown |= {topic: recorded[topic][0] for topic in PANELS["map!position"]["topicColors"]}
    assert set(shown.values()) == POSITIONS
    assert recorded[PANELS["RosOut!events"]["topicToRender"]][0] == "foxglove.Log"
    assert recorded[PANELS["RawMessages!outcome"]["topicPath"]][1].outcome == "arrived"
    assert recorded[PANELS["RawMessages!state"]["topicPath"]][0] == "galeway.State"
    assert recorded[PANELS["map!position"]["followTopic"]][0] == "foxglove.LocationFix"


@pytest.mark.parametrize("scene", SCENES)
def test_a_scene_shows_what_is_recorded_in_its_frames(scene, recorded):
    topics, transform = scene["topics"], recorded["/tf"][1]
    assert {recorded[topic][0] for topic in topics} == SCENE
    grid = next(topic for topic in topics if recorded[topic][0] == "foxglove.Grid")
    assert topics[grid]["colorField"] in {field.name for field in recorded[grid][1].fields}
    assert scene["fixedFrame"] == transform.parent_frame_id
    assert scene["followTf"] in (transform.parent_frame_id, transform.child_frame_id)
    for topic in topics:
        assert recorded[topic][1].frame_id == scene["fixedFrame"]


def test_the_plan_is_drawn_from_near_and_from_far():
    """Foxglove, as three.js, draws no line with a width in metres that is over 100 km from the eye."""
    kinds = {scene["cameraState"]["distance"]: scene["topics"]["/plan/path"]["type"] for scene in SCENES}
    assert len(kinds) == 2
    for distance_m, kind in kinds.items():
        assert kind == ("line" if distance_m < 50e3 else "arrow")


def test_every_phase_has_a_name():
    (series,) = PANELS["StateTransitions!phase"]["paths"]
    assert [state["value"] for state in series["customStates"]["states"]] == ["0", "1", "2", "3"]


def test_the_file_is_what_the_script_writes():
    made = subprocess.run(
        [sys.executable, ROOT / "docs" / "foxglove_layout.py"], capture_output=True, text=True, check=True
    ).stdout
    assert (ROOT / "docs" / "foxglove_layout.json").read_text(encoding="utf-8") == made, "run `make proto`"


SEEN = {
    "errors": [],
    "fine": True,
    "panels": {
        "3D!area": {"yellow": 200, "blue": 0, "red": 0},
        "3D!behind": {"yellow": 200, "blue": 900, "red": 0},
    },
    "goals": 2,
    "lines": ["#4e98e2ff", "#f8e384"],
}


def look():
    return runpy.run_path(str(ROOT / "tests" / "interop" / "look.py"))["faults"]


def test_what_should_be_seen_passes():
    assert look()(SEEN, goals=1) == []


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"errors": ["TypeError: x"]}, "an error in the page: TypeError: x"),
        ({"fine": False}, "Foxglove lists problems"),
        ({"goals": 0}, "0 goals on the map instead of 1"),
        ({"lines": ["#4e98e2ff"]}, "the map lacks the plan or the track"),
        ({"panels": SEEN["panels"] | {"3D!area": {"yellow": 3}}}, "nothing of the flight in 3D!area"),
        (
            {"panels": SEEN["panels"] | {"3D!behind": {"yellow": 200, "blue": 0}}},
            "no plan behind the aircraft",
        ),
    ],
)
def test_what_is_not_seen_is_told(change, told):
    assert look()(SEEN | change, goals=1) == [told]
