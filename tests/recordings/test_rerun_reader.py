"""What is read from a Rerun file is what is read from the MCAP file of the same flight."""

from dataclasses import fields, replace

import numpy as np
import pytest

import recordings
from recordings import rerun_writer
from recordings.errors import BadRecordingError
from recordings.mcap_writer import McapRecorder
from recordings.recorder import Outcome, Recorders
from recordings.rerun_reader import read
from recordings.rerun_writer import RerunRecorder
from recordings.tracking import track


@pytest.fixture(scope="module")
def both(tmp_path_factory):
    """Records a flight to both formats: (workshop, flight) -> paths."""

    def made(workshop, flight):
        folder = tmp_path_factory.mktemp("both")
        mcap, rrd = folder / "flight.mcap", folder / "flight.rrd"
        flight.record(Recorders([McapRecorder(mcap), RerunRecorder(rrd)]))
        return mcap, rrd

    return made


def assert_same(found, expected):
    """Field by field, arrays to the bit."""
    for field in fields(expected):
        ours, theirs = getattr(found, field.name), getattr(expected, field.name)
        if isinstance(theirs, np.ndarray):
            assert ours.dtype == theirs.dtype, field.name
            assert ours.tobytes() == theirs.tobytes(), field.name
        elif field.name in ("header", "reference"):
            assert_same(ours, theirs)
        elif field.name in ("references", "hazards"):
            assert len(ours) == len(theirs) > 0
            for one, other in zip(ours, theirs, strict=True):
                if field.name == "references":
                    assert one.time_s == other.time_s
                    assert_same(one.reference, other.reference)
                else:
                    assert_same(one, other)
        else:
            assert ours == theirs, field.name


def test_all_of_a_recording_is_the_same_from_either_file(workshop, both):
    hazard = np.random.default_rng(3).random(workshop.grid.shape) < 0.2
    flight = workshop.fly_and_hold(workshop.header(workshop.straight), 60.0, 150.0)
    sheets = [
        replace(sheet, time_s=min(sheet.time_s, 100.0 * sheet.stage)) for sheet in workshop.sheets(hazard)
    ]
    mcap, rrd = both(workshop, replace(flight, sheets=sheets))
    found, expected = recordings.open(rrd), recordings.open(str(mcap))
    assert len(expected.references) == 2
    assert len(expected.hazards) > 2
    assert expected.complete
    assert_same(found, expected)
    assert track(found).to_json() == track(expected).to_json()
    for topic, rows in expected.columns.items():
        assert np.array_equal(found.columns[topic], rows)


def test_a_flight_without_estimates_or_events(workshop, both):
    flight = replace(workshop.fly(workshop.header(workshop.straight), until_s=50.0), seen=[])
    mcap, rrd = both(workshop, replace(flight, outcome=Outcome.CRASHED))
    found = recordings.open(rrd)
    assert_same(found, recordings.open(mcap))
    assert (len(found.estimate), found.events, found.outcome) == (0, (), Outcome.CRASHED)


@pytest.fixture(scope="module")
def whole(kept):
    flight = kept.fly(kept.header(kept.straight), until_s=70.0)
    path = kept.folder / "flight.rrd"
    flight.record(RerunRecorder(path))
    return path


def test_samples_in_chunks_of_any_size_are_the_same(workshop, whole, monkeypatch):
    monkeypatch.setattr(rerun_writer, "_LONGEST_WAIT_S", 1e-4)
    paced = workshop.folder / "paced.rrd"
    workshop.fly(workshop.header(workshop.straight), until_s=70.0).record(RerunRecorder(paced))
    assert paced.stat().st_size > whole.stat().st_size
    assert_same(read(paced), read(whole))


def test_an_unfinished_file_is_read_and_says_so(workshop):
    flight = workshop.fly(workshop.header(workshop.straight), until_s=70.0)
    recorder = RerunRecorder(workshop.folder / "flight.rrd")
    flight.record(recorder, finish=False)
    recorder.abandon()
    found = read(recorder.partial_path)
    assert found.state["time_s"].tolist() == [state.time_s for state in flight.states]
    assert (found.complete, found.outcome) == (False, Outcome.INCOMPLETE)
    assert "how the flight ended" in found.missing


def test_of_a_file_that_is_cut_off_the_part_before_is_read(whole):
    content, everything = whole.read_bytes(), read(whole)
    cut, samples = whole.with_name("cut.rrd"), []
    for length in np.linspace(1000, len(content) - 40, 8).astype(int):
        cut.write_bytes(content[:length])
        try:
            found = read(cut)
        except BadRecordingError:
            samples.append(0)
            continue
        samples.append(len(found.state))
        assert found.missing.startswith("the file is cut off")
        assert np.array_equal(found.state, everything.state[: len(found.state)])
    assert samples == sorted(samples)
    assert samples[-1] == len(everything.state)


def test_a_number_that_was_changed_is_found_by_the_checksum(whole):
    """The file of Rerun has none of its own: the same file with one sample of another is well-formed."""
    content = whole.read_bytes()
    assert read(whole).complete
    found = []
    generator = np.random.default_rng(4)
    flipped = whole.with_name("flipped.rrd")
    for at in generator.integers(100, len(content), 25):
        damaged = bytearray(content)
        damaged[at] ^= 1 << int(generator.integers(8))
        flipped.write_bytes(damaged)
        try:
            recording = read(flipped)
        except BadRecordingError:
            found.append("refused")
            continue
        found.append(recording.missing)
        if recording.complete:  # what is drawn, and not logged
            assert recording.state.tobytes() == read(whole).state.tobytes()
    assert any(found)


def test_files_that_are_something_else(tmp_path):
    path = tmp_path / "flight.rrd"
    for content in (b"RRF", b"", b"RRF2", b"RRF2" + b"\1" * 200):
        path.write_bytes(content)
        with pytest.raises(BadRecordingError, match=r"flight\.rrd"):
            read(path)
    with pytest.raises(BadRecordingError, match="cannot read"):
        read(tmp_path / "none.rrd")


def test_what_a_file_is_decides_how_it_is_read(whole):
    renamed, text = whole.with_suffix(".mcap"), whole.with_suffix(".rrd.mcap")
    renamed.write_bytes(whole.read_bytes())
    assert recordings.open(renamed).complete
    text.write_text("no recording")
    with pytest.raises(BadRecordingError, match="not an MCAP file"):
        recordings.open(text)


def test_galeway_checks_a_rerun_file(whole, galeway):
    done = galeway("check", str(whole), "--json")
    assert '"scenario": "squall"' in done.stdout
    assert done.returncode in (0, 1), done.stderr
    assert "incomplete" not in done.stderr
