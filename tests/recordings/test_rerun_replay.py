"""Pictures and the viewer; those that need a Vulkan driver say so and skip where there is none."""

import os
from dataclasses import replace

import numpy as np
import psutil
import pytest
from PIL import Image

from recordings.errors import RecordingError
from recordings.rerun_replay import picture, replay
from recordings.rerun_scene import FLOWN_COLOUR, PLAN_COLOUR
from recordings.rerun_writer import RerunRecorder

LONG_CORNERS = ((-40e3, -80e3), (-40e3, 20e3), (20e3, 20e3), (20e3, 60e3))
LEG_S = 1200.0


@pytest.fixture(scope="module")
def recording(kept):
    """A flight over an hour that crosses most of the chart."""
    sheets = [
        replace(sheet, stage=stage, time_s=sheet.time_s if stage == 0 else 600.0 * stage)
        for stage in range(6)
        for sheet in kept.sheets(stages=1)
    ]
    flight = kept.fly(kept.header(LONG_CORNERS, LEG_S), hz=1, sheets=sheets)
    path = kept.folder / "flight.rrd"
    flight.record(RerunRecorder(path))
    return path


def pictured(path, out, **options):
    """The pixels of a picture, shape (down, right, 3)."""
    picture(path, out, **options)
    return np.asarray(Image.open(out).convert("RGB")).astype(int)


def like(pixels, colour, within=40):
    """How many pixels are near a colour."""
    return int(np.sum(np.abs(pixels - np.array(colour)).max(axis=-1) <= within))


@pytest.mark.usefixtures("vulkan")
def test_the_picture_shows_hazard_plan_and_flight(recording, tmp_path):
    early = pictured(recording, tmp_path / "early.png", at_s=300.0)
    late = pictured(recording, tmp_path / "late.png")
    assert early.shape == late.shape == (900, 1600, 3)
    chart = slice(60, 660), slice(220, 880)
    for pixels in (early[chart], late[chart]):
        red, green, blue = pixels[..., 0], pixels[..., 1], pixels[..., 2]
        assert np.sum((red > 95) & (green < 70) & (blue < 70)) > 2000  # hazard
        assert like(pixels, PLAN_COLOUR) > 300
    assert like(late[chart], FLOWN_COLOUR) > 4 * like(early[chart], FLOWN_COLOUR) > 0
    assert like(early[chart], PLAN_COLOUR) > 1.3 * like(late[chart], PLAN_COLOUR)
    assert no_viewer_is_left()


@pytest.mark.usefixtures("vulkan")
def test_a_partial_recording_gives_a_picture_in_the_size_asked_for(recording, workshop, tmp_path):
    recorder = RerunRecorder(tmp_path / "other.rrd")
    workshop.fly(workshop.header(LONG_CORNERS, LEG_S), hz=1, until_s=500.0).record(recorder, finish=False)
    recorder.abandon()
    assert pictured(recorder.partial_path, tmp_path / "o.png", size_px=(800, 450)).shape == (450, 800, 3)


def no_viewer_is_left():
    children = psutil.Process().children(recursive=True)
    return not [child for child in children if "rerun" in child.name()]


@pytest.mark.skipif(os.name != "posix", reason="hides the drivers by the Vulkan loader's own variables")
def test_without_a_vulkan_driver_it_says_what_to_install(recording, tmp_path, monkeypatch):
    for name in ("VK_DRIVER_FILES", "VK_ICD_FILENAMES"):
        monkeypatch.setenv(name, str(tmp_path / "none.json"))
    with pytest.raises(RecordingError, match="apt-get install mesa-vulkan-drivers libvulkan1"):
        picture(recording, tmp_path / "picture.png")
    assert not (tmp_path / "picture.png").exists()
    assert no_viewer_is_left()


def test_the_folder_of_the_picture_must_be_there(recording, tmp_path):
    with pytest.raises(RecordingError, match="there is no folder"):
        picture(recording, tmp_path / "nowhere" / "picture.png")


@pytest.mark.parametrize(("at_s", "text"), [(7200.0, "2:00:00"), (-1.0, "-0:00:01")])
def test_a_moment_outside_the_flight_is_refused_with_its_range(recording, tmp_path, at_s, text):
    with pytest.raises(RecordingError, match=rf"^{text} is not in the flight.* from 0:00:00 to 1:00:00"):
        picture(recording, tmp_path / "picture.png", at_s=at_s)


def test_a_picture_that_cannot_be_written_is_refused_before_it_is_drawn(recording, tmp_path):
    (tmp_path / "folder.png").mkdir()
    for out in (tmp_path / "folder.png", tmp_path / "closed" / "picture.png"):
        out.parent.mkdir(exist_ok=True)
        if out.name == "picture.png":
            out.parent.chmod(0o500)
            if os.access(out.parent, os.W_OK):
                continue  # who may write everywhere is not refused
        with pytest.raises(RecordingError, match="it is a folder or not permitted"):
            picture(recording, out)


def test_a_viewer_that_is_not_installed_is_asked_for(recording, tmp_path, monkeypatch):
    monkeypatch.setattr("recordings.viewer_program.find_spec", {}.get)
    with pytest.raises(RecordingError, match="the Rerun viewer is not installed; `pip install"):
        picture(recording, tmp_path / "picture.png")


@pytest.mark.skipif(os.name != "posix", reason="other systems always have a screen")
def test_without_a_screen_the_viewer_is_not_started(recording, monkeypatch):
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr("sys.platform", "linux")
    with pytest.raises(RecordingError, match="there is no screen"):
        replay(recording)
