"""A recording that cannot be read is refused with the one that may have been meant."""

import pytest

import recordings
from recordings.errors import BadRecordingError


def refusal(path):
    with pytest.raises(BadRecordingError) as refused:
        recordings.open(path)
    return str(refused.value)


@pytest.fixture
def folder(tmp_path):
    for name in ("flight.partial.mcap", "flight.partial.rrd", "ian.mcap", "notes.txt"):
        (tmp_path / name).touch()
    return tmp_path


def test_what_a_stopped_flight_left_is_named_and_how_it_is_repaired(folder):
    partial = folder / "flight.partial.mcap"
    assert f"left {partial}; `galeway repair {partial}` makes" in refusal(folder / "flight.mcap")
    assert refusal(folder / "flight.rrd").endswith(f"stopped, and left {folder / 'flight.partial.rrd'}")


def test_a_name_that_is_nearly_one_of_the_folder_is_asked_for(folder):
    assert refusal(folder / "ian.mcp").endswith(f"; did you mean {folder / 'ian.mcap'}?")


def test_the_recordings_of_a_folder_are_named(folder):
    told = refusal(folder)
    assert f"give a file in it: {folder / 'flight.partial.mcap'} or " in told
    assert "notes.txt" not in told
    for number in range(5):
        (folder / f"{number}.mcap").touch()
    assert refusal(folder).endswith(f"{folder / '2.mcap'} or another")


def test_a_folder_without_recordings_is_told_what_is_wanted(tmp_path):
    assert refusal(tmp_path).endswith("Is a directory; give the file of a flight, *.mcap or *.rrd")


def test_where_nothing_is_like_it_nothing_is_guessed(folder, tmp_path):
    assert refusal(folder / "xyz").endswith("No such file or directory")
    assert refusal(tmp_path / "lost" / "flight.mcap").endswith("No such file or directory")
