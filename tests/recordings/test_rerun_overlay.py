"""What an overlay draws, read back from the file."""

from dataclasses import replace

import numpy as np
import pyarrow as pa
import pytest
from rerun.chunk import RrdReader

from recordings.overlay import Overlaid
from recordings.rerun_overlay import COLOURS, record_overlay
from recordings.rerun_plots import LEVELS


@pytest.fixture(scope="module")
def flights(kept):
    """Two on the same plan, the second to the right of it and not to its end."""
    header = kept.header(kept.straight)
    whole = kept.fly(header, hz=1)
    part = kept.fly(replace(header, seed=8), hz=1, right_m=500.0, until_s=200.0)
    part = replace(part, guidance=[sample._replace(cross_track_m=500.0) for sample in part.guidance])
    return [Overlaid(name, kept.recording(flight)) for name, flight in (("seed 7", whole), ("seed 8", part))]


@pytest.fixture(scope="module")
def path(flights, kept):
    record_overlay(flights, kept.folder / "overlay.rrd")
    return kept.folder / "overlay.rrd"


def rows(path, entity, component):
    """(time_s, value) of every row of an entity, in order of time; the time is None of what is static."""
    found = []
    for chunk in RrdReader(path).stream():
        if chunk.entity_path != f"/{entity}":
            continue
        table = chunk.to_record_batch()
        names = [name for name in table.schema.names if name.endswith(component)]
        if names:
            count = table.num_rows
            times = [None] * count
            if "flight_time" in chunk.timeline_names:
                times = [t / 1e9 for t in table.column("flight_time").cast(pa.int64()).to_pylist()]
            found += zip(times, table.column(names[0]).to_pylist(), strict=True)
    return sorted(found, key=lambda row: row[0] if row[0] is not None else -np.inf)


def plane_km(recording):
    state = recording.state
    north_m, east_m = recording.header.grid.frame.to_plane(state["lat_rad"], state["lon_rad"])
    return np.column_stack([east_m, -north_m]) / 1000.0


def test_each_track_goes_through_its_own_positions_in_its_own_colour(path, flights):
    lines = {0: [], 1: []}
    colours = rows(path, "chart/flown", "LineStrips2D:colors")
    strips = rows(path, "chart/flown", "LineStrips2D:strips")
    for (_, drawn), (_, coloured) in zip(strips, colours, strict=True):
        for strip, colour in zip(drawn, coloured, strict=True):
            (index,) = [
                i for i, rgb in enumerate(COLOURS) if colour >> 8 == (rgb[0] << 16) + (rgb[1] << 8) + rgb[2]
            ]
            lines[index] += strip if not lines[index] else strip[1:]
    for index, flight in enumerate(flights):
        np.testing.assert_allclose(lines[index], plane_km(flight.recording), atol=1e-4)
    assert len(lines[1]) < len(lines[0])


def test_a_piece_of_track_is_of_the_time_of_its_end(path, flights):
    times_s = [time_s for time_s, _ in rows(path, "chart/flown", "LineStrips2D:strips")]
    assert times_s == sorted(times_s)
    assert times_s[-1] == pytest.approx(flights[0].recording.end_time_s, abs=1.0)


def test_errors_are_those_of_each_flight_and_nothing_where_it_is_over(path):
    values = dict(rows(path, "errors/cross_track_m", "Scalars:scalars"))
    assert values[100.0] == [0.25, 500.0]
    assert values[300.0][0] == 0.25
    assert np.isnan(values[300.0][1])
    ((_, names),) = rows(path, "errors/cross_track_m", "SeriesLines:names")
    assert names == ["seed 7", "seed 8"]


def test_plots_of_errors_show_all_of_them_with_a_number_at_their_side(path):
    (entry,) = RrdReader(path).blueprints()
    found = []
    for chunk in RrdReader(path).stream(store=entry):
        table = chunk.to_record_batch()
        for name in table.schema.names:
            if name.endswith("ScalarAxis:range"):
                found += [shown for (shown,) in table.column(name).to_pylist()]
    # Across 500 m, above 0.5 m and late 1.5 s at most.
    assert sorted(found) == [pytest.approx([-up, up]) for up in (1100.0, 1.98, 1.1)]


def test_flights_that_change_level_have_a_plot_of_their_altitudes(path, flights, kept):
    assert not rows(path, LEVELS, "Scalars:scalars")
    assert "wind at 1000 m" in rows(path, "chart/stage", "Points2D:labels")[0][1][0]
    low, high = (flight.recording for flight in flights)
    points = low.header.plan.waypoints
    climb = tuple(replace(point, altitude_m=1500.0 if i else 1000.0) for i, point in enumerate(points))
    climbing = replace(low.header, plan=replace(low.header.plan, waypoints=climb))
    changing = [Overlaid("one", replace(low, header=climbing)), Overlaid("other", high)]
    drawn = kept.folder / "levels.rrd"
    record_overlay(changing, drawn)
    values = dict(rows(drawn, LEVELS, "Scalars:scalars"))
    altitude_m = dict(zip(low.state["time_s"], low.state["altitude_m"], strict=True))
    assert values[100.0] == pytest.approx([altitude_m[100.0], 1000.0])
    assert values[300.0][0] == pytest.approx(altitude_m[300.0])
    assert np.isnan(values[300.0][1])
    ((_, names),) = rows(drawn, LEVELS, "SeriesLines:names")
    assert names == ["one", "other"]
    assert rows(drawn, "chart/stage", "Points2D:labels")[0][1][0].endswith(
        "wind at 1000 m, where the first flies"
    )


def test_the_legend_and_the_card_name_the_flights(path):
    ((_, names),) = rows(path, "chart/legend/names", "Points2D:labels")
    assert names[:2] == ["seed 7", "seed 8"]
    ((_, (card,)),) = rows(path, "card", "TextDocument:text")
    assert "**seed 7** | arrived" in card
    assert "**seed 8**" in card


def test_plans_are_drawn_for_every_flight(path):
    ((_, plans),) = rows(path, "chart/plan", "LineStrips2D:strips")
    assert len(plans) == 2


def test_the_marks_lie_at_the_aircraft_and_point_along_their_headings(path, flights):
    for index, flight in enumerate(flights):
        *_, (_, (fuselage, *_)) = rows(path, f"chart/aircraft/{index}/glyph", "LineStrips2D:strips")
        nose, tail = np.array(fuselage)
        np.testing.assert_allclose((nose + tail) / 2.0, plane_km(flight.recording)[-1], atol=1e-3)
        east, south = nose - tail
        heading_rad = flight.recording.state["heading_rad"][-1]
        assert np.arctan2(east, -south) == pytest.approx(heading_rad, abs=1e-4)


def test_each_stage_has_its_hazard_and_its_name(path, flights):
    met = sorted({sheet.time_s for sheet in flights[0].recording.hazards})
    for entity, component in (
        ("chart/weather/truth/picture", "Image:buffer"),
        ("chart/weather/truth/edge", "LineStrips2D:strips"),
        ("chart/stage", "Points2D:labels"),
    ):
        assert [time_s for time_s, _ in rows(path, entity, component)] == met
