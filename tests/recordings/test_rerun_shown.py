"""What is shown of a file: the file, what is left of it, its flight drawn anew, or a message."""

import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import rerun as rr
from rerun.chunk import RrdReader

from recordings.errors import BadRecordingError, RecordingError
from recordings.mcap_writer import McapRecorder
from recordings.recorder import Recorders
from recordings.rerun_plots import PLOTS
from recordings.rerun_shown import last_time_s, shown
from recordings.rerun_writer import RerunRecorder
from recordings.viewer_program import viewer


@pytest.fixture(scope="module")
def flight(kept):
    return kept.fly(kept.header(kept.corners))


@pytest.fixture(scope="module")
def files(flight, kept):
    """The MCAP and the Rerun recording of one flight."""
    mcap, rerun = kept.folder / "flight.mcap", kept.folder / "flight.rrd"
    flight.record(Recorders([McapRecorder(mcap), RerunRecorder(rerun)]))
    return mcap, rerun


def silent(text):
    raise AssertionError(text)


def test_a_rerun_recording_is_shown_as_it_is(files, flight):
    with shown([files[1]], silent) as path:
        assert path == files[1]
        assert last_time_s(path) == flight.states[-1].time_s


def test_an_mcap_recording_is_drawn_as_its_flight_was(files):
    mcap, rerun = files
    with shown([mcap], silent) as path:
        assert entities(path) == entities(rerun)
        for name in ("/state", "/guidance", "/estimate", *(f"/{plot}" for plot in PLOTS), "/chart/flown"):
            assert same(path, rerun, name), name
    assert not path.exists()


def entities(path):
    return {chunk.entity_path for chunk in RrdReader(path).stream()}


def same(one, other, entity):
    """Whether all rows of an entity hold the same, row ids aside.

    How they lie in chunks, and which chunk comes first, a clock decides.
    """

    def content(path):
        chunks = [chunk for chunk in RrdReader(path).stream() if chunk.entity_path == entity]
        rows = [row for chunk in chunks for row in chunk.to_record_batch().to_pylist()]
        assert rows
        return sorted(repr({name: row[name] for name in sorted(row) if "RowId" not in name}) for row in rows)

    return content(one) == content(other)


def test_of_a_rerun_recording_that_is_cut_off_the_rest_is_shown(files, tmp_path):
    cut = tmp_path / "cut.rrd"
    cut.write_bytes(files[1].read_bytes()[: files[1].stat().st_size // 2])
    said = []
    with shown([cut], said.append) as path:
        assert path != cut
        assert 0.0 < last_time_s(path) < last_time_s(files[1])
    assert said == [f"{cut} is incomplete or damaged; what is left is shown"]
    assert not path.exists()


def test_of_an_mcap_recording_that_is_cut_off_the_rest_is_shown(files, tmp_path):
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(files[0].read_bytes()[: files[0].stat().st_size // 2])
    said = []
    with shown([cut], said.append) as path:
        assert last_time_s(path) > 0.0
    assert len(said) == 1
    assert said[0].startswith(f"{cut} is incomplete: ")


def test_a_recording_of_which_nothing_is_left_is_refused(files, tmp_path):
    for path, kept in ((files[1], 20), (files[0], 200)):
        cut = tmp_path / f"cut{path.suffix}"
        cut.write_bytes(path.read_bytes()[:kept])
        with pytest.raises(BadRecordingError, match=cut.name), shown([cut], lambda _: None):
            pass


def test_a_rerun_recording_of_something_else_is_refused(tmp_path):
    path = tmp_path / "cat.rrd"
    stream = rr.RecordingStream("cats", send_properties=False)
    stream.save(path)
    stream.log("cat", rr.Points2D([[0.0, 0.0]]))
    stream.disconnect()
    with (
        pytest.raises(BadRecordingError, match=r"cat\.rrd was recorded by cats, not by galeway"),
        shown([path], silent),
    ):
        pass


def test_another_kind_of_file_is_refused(tmp_path):
    path = tmp_path / "plan.json"
    path.write_text("{}")
    with pytest.raises(BadRecordingError, match=r"plan\.json is not"), shown([path], silent):
        pass


@pytest.mark.parametrize("name", ["lost.rrd", "lost.mcap", "."])
def test_a_recording_that_is_not_there_is_named(tmp_path, name):
    with (
        pytest.raises(BadRecordingError, match="cannot read the recording"),
        shown([tmp_path / name], silent),
    ):
        pass


def test_several_are_laid_over_each_other(flight, files, workshop, tmp_path):
    other = replace(flight, header=replace(flight.header, seed=8))
    with shown([files[0], workshop.file(other, "other")], silent) as path:
        assert {"/errors/cross_track_m", "/chart/flown"} <= entities(path)
        assert last_time_s(path) == pytest.approx(flight.states[-1].time_s, abs=1.0)


def test_several_that_do_not_go_together_are_refused(flight, files, workshop):
    hazard = np.ones(workshop.grid.shape, bool)
    other = workshop.file(replace(flight, sheets=workshop.sheets(hazard)), "other")
    with (
        pytest.raises(RecordingError, match="the true hazard of stage 0 at 1000 m differs"),
        shown([files[0], other], silent),
    ):
        pass


def test_what_is_made_can_be_verified_by_rerun(files):
    with shown([files[0]], silent) as path:
        done = subprocess.run([viewer(), "rrd", "verify", path], check=False, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert isinstance(path, Path)
