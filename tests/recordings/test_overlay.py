"""Which flights go together, and what tells them apart."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from planner.grid import Grid
from recordings.errors import RecordingError
from recordings.overlay import MOST, Overlaid, overlaid, truth_met


@pytest.fixture(scope="module")
def recording(kept):
    return kept.recording(kept.fly(kept.header(kept.straight), hz=1))


def labels(*pairs):
    return [flight.label for flight in overlaid([(Path(path), recording) for path, recording in pairs])]


def with_header(recording, **fields):
    return replace(recording, header=replace(recording.header, **fields))


def with_plan(recording, **fields):
    return with_header(recording, plan=replace(recording.header.plan, **fields))


def test_a_label_names_what_differs_and_nothing_else(recording):
    other = with_header(recording, seed=8)
    assert labels(("a.mcap", recording), ("b.mcap", other)) == ["seed 7", "seed 8"]
    other = with_plan(other, planner="windaware")
    assert labels(("a.mcap", recording), ("b.mcap", other)) == ["staged, seed 7", "windaware, seed 8"]
    other = with_plan(recording, objective="survival")
    assert labels(("a.mcap", recording), ("b.mcap", other)) == ["by score", "by survival"]


def test_flights_that_differ_in_nothing_known_go_by_their_files(recording):
    def named(*paths):
        return labels(*((path, recording) for path in paths))

    assert named("runs/a/flight.mcap", "runs/b/flight.mcap") == ["a", "b"]
    assert named("runs/one.mcap", "runs/two.mcap") == ["one", "two"]
    assert named("x/a/flight.mcap", "y/a/flight.mcap") == ["x/a/flight.mcap", "y/a/flight.mcap"]
    mixed = [("a.mcap", recording), ("b.mcap", recording), ("c.mcap", with_header(recording, seed=8))]
    assert labels(*mixed) == ["seed 7, a", "seed 7, b", "seed 8, c"]


def refused(recording, other, match):
    with pytest.raises(RecordingError, match=match) as caught:
        labels(("a.mcap", recording), ("b.mcap", other))
    assert str(caught.value).startswith("b.mcap cannot be laid over a.mcap: ")


def test_another_area_is_refused(recording):
    grid = recording.header.grid
    moved = Grid(grid.south_rad + 0.01, grid.west_rad, grid.north_step_rad, grid.east_step_rad, *grid.shape)
    refused(recording, with_header(recording, grid=moved), "another area or cell size")


def test_another_departure_is_refused(recording):
    refused(recording, with_plan(recording, departure_s=0.0), "departed at another time")


def test_another_threshold_is_refused(recording):
    refused(
        recording, with_header(recording, threshold_mps=12.5), r"above 12\.5 m/s, to the other above 15 m/s"
    )


def test_another_truth_is_refused_with_its_stage(recording):
    sheets = list(recording.hazards)
    (index,) = [i for i, sheet in enumerate(sheets) if (sheet.layer, sheet.stage) == ("truth", 0)]
    hazard = sheets[index].hazard.copy()
    hazard[3:5, 7] = True
    sheets[index] = replace(sheets[index], hazard=hazard)
    other = replace(recording, hazards=tuple(sheets))
    refused(recording, other, "the true hazard of stage 0 at 1000 m differs in 2 cells")


def at_altitude(recording, altitude_m, hazard=None):
    """With all sheets of one altitude, and of its own hazard."""
    sheets = [
        replace(sheet, altitude_m=altitude_m, hazard=sheet.hazard if hazard is None else hazard)
        for sheet in recording.hazards
    ]
    return replace(recording, hazards=tuple(sheets))


def test_truths_of_different_altitudes_are_not_compared(recording):
    calm = np.zeros_like(recording.hazards[0].hazard)
    high = at_altitude(recording, 1500.0, calm)
    assert len(labels(("a", recording), ("b", high))) == 2
    both = replace(recording, hazards=(*recording.hazards, *high.hazards))
    assert len(labels(("a", both), ("b", high))) == 2
    refused(both, at_altitude(recording, 1500.0), "the true hazard of stage 0 at 1500 m differs in 100 cells")


def test_where_altitudes_are_not_known_of_both_stages_alone_are_compared(recording):
    unknown = at_altitude(recording, None)
    assert len(labels(("a", recording), ("b", unknown))) == 2
    calm = np.zeros_like(recording.hazards[0].hazard)
    refused(recording, at_altitude(recording, None, calm), "of stage 0 differs in 100 cells")


def test_all_that_the_first_flight_met_is_shown_and_stages_that_only_others_met(recording):
    (low,) = [sheet for sheet in recording.hazards if sheet.layer == "truth"]
    high, later = replace(low, altitude_m=1500.0, time_s=60.0), replace(low, stage=1, time_s=600.0)
    first, second = replace(recording, hazards=(low, high)), replace(recording, hazards=(high, later))
    assert truth_met([Overlaid("a", first), Overlaid("b", second)]) == [low, high, later]


def test_another_forecast_is_no_reason(recording):
    sheets = [
        replace(sheet, hazard=np.zeros_like(sheet.hazard)) if sheet.layer == "forecast" else sheet
        for sheet in recording.hazards
    ]
    assert len(labels(("a", recording), ("b", replace(recording, hazards=tuple(sheets))))) == 2


def test_a_file_given_twice_is_refused(recording):
    with pytest.raises(RecordingError, match=r"a\.mcap is given twice"):
        labels(("a.mcap", recording), ("./a.mcap", recording))


def test_more_than_can_be_told_apart_are_refused(recording):
    with pytest.raises(RecordingError, match="9 recordings are too many"):
        labels(*((f"{number}.mcap", recording) for number in range(MOST + 1)))
