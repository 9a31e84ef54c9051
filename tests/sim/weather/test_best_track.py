import math
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

from planner.grid import Grid
from sim.errors import WeatherError
from sim.scenario import load_scenario
from sim.weather.best_track import BestTrackFix, parse_fixes, read_best_track
from sim.weather.storms import STORMS
from sim.weather.vortex import quadrant_profiles, vortex_field

LINE = "20220929, 0000,  , HU, 27.2N,  81.7W, 100,  960,  180,  120,  120,  220,   50,   60,   50,   70,   30,   40,   30,   45,   20"  # noqa: E501


def test_a_line_becomes_si() -> None:
    (fix,) = parse_fixes(LINE)
    assert datetime.fromtimestamp(fix.time_s, UTC) == datetime(2022, 9, 29, tzinfo=UTC)
    assert math.degrees(fix.lat_rad) == pytest.approx(27.2)
    assert math.degrees(fix.lon_rad) == pytest.approx(-81.7)
    assert fix.max_wind_mps == pytest.approx(51.4444, abs=1e-4)
    assert fix.max_wind_radius_m == 37040.0
    assert fix.radii_m[0] == (333360.0, 222240.0, 222240.0, 407440.0)
    assert fix.radii_m[2] == (55560.0, 74080.0, 55560.0, 83340.0)


@pytest.mark.parametrize("storm", STORMS)
def test_the_storms_that_ship_are_the_published_ones(storm: str, data_folder: Path) -> None:
    published = read_best_track(data_folder / "hurdat2_atlantic_2021_2022.txt", storm)
    begin_s, end_s = STORMS[storm][0].time_s, STORMS[storm][-1].time_s
    assert tuple(fix for fix in published if begin_s <= fix.time_s <= end_s) == STORMS[storm]


@pytest.mark.parametrize("name", ["ian", "ida", "fiona", "henri"])
def test_they_cover_their_scenarios_and_an_hour_more(name: str) -> None:
    scenario = load_scenario(name).scenario
    fixes, departure_s = STORMS[scenario.weather.storm or ""], scenario.mission.departure_s
    assert fixes[0].time_s < departure_s
    assert fixes[-1].time_s >= departure_s + 19 * 3600


def test_every_storm_of_two_seasons_can_be_read(data_folder: Path) -> None:
    path = data_folder / "hurdat2_atlantic_2021_2022.txt"
    storms = [line[:8] for line in path.read_text().splitlines() if line.startswith("AL")]
    assert len(storms) == 37
    for storm in storms:
        fixes = read_best_track(path, storm)
        assert (np.diff([fix.time_s for fix in fixes]) > 0.0).all()
        assert all(len(quadrant_profiles(fix)) == 4 for fix in fixes)


def test_only_the_fixes_around_the_mission_are_read(tmp_path: Path) -> None:
    lines = [LINE.replace("20220929", day) for day in ("20220928", "20220929", "20220930")]
    path = tmp_path / "track.txt"
    early = LINE.replace("20220929", "20220927").replace(" 120,", " -999,")  # would be refused
    path.write_text("\n".join(["AL092022, IAN, 4,", early, *lines]))
    begin_s = parse_fixes(LINE)[0].time_s
    known = read_best_track(path, "AL092022", span_s=(begin_s - 3600.0, begin_s + 3600.0))
    assert known == parse_fixes("\n".join(lines))
    assert read_best_track(path, "AL092022", span_s=(begin_s, begin_s + 3600.0)) == known[1:]
    with pytest.raises(
        WeatherError, match=r"holds 2022-09-27 00:00 to 2022-09-30 00:00 UTC, but the mission"
    ):
        read_best_track(path, "AL092022", span_s=(begin_s + 24 * 3600.0, begin_s + 25 * 3600.0))


def test_a_missing_radius_of_maximum_wind_is_estimated_when_asked_for() -> None:
    for line in (LINE[:-5] + " -999", LINE[: LINE.rindex(",")]):  # from 2021 on, and before
        (fix,) = parse_fixes(line, estimate_core=True)
        assert fix.max_wind_radius_m == pytest.approx(
            46.4e3 * math.exp(-0.0155 * 51.444 + 0.0169 * 27.2), rel=1e-4
        )
    assert parse_fixes(LINE, estimate_core=True) == parse_fixes(LINE)


def test_a_track_runs_on_across_the_date_line() -> None:
    lines = [LINE.replace(" 0000", hour).replace(" 81.7W", lon) for hour, lon in
             ((" 0000", "179.2W"), (" 0600", "179.5E"), (" 1200", "178.1E"))]  # fmt: skip
    there = parse_fixes("\n".join(lines))
    assert [math.degrees(fix.lon_rad) for fix in there] == pytest.approx([-179.2, -180.5, -181.9])
    grid = Grid.covering(*map(math.radians, (24.0, 30.0, 176.0, 184.0)), rows=61, columns=81)
    field = vortex_field(there, grid, [there[0].time_s + 3 * 3600.0])
    assert field.at(field.time_s[0], there[0].lat_rad, math.radians(180.15)).speed_mps < 3.0  # the centre
    assert np.hypot(field.north_mps, field.east_mps).max() > 45.0


def test_an_extratropical_fix_is_taken() -> None:
    assert parse_fixes(LINE.replace("HU", "EX")) == parse_fixes(LINE)


def test_a_storm_is_read_from_a_file_in_the_format(tmp_path: Path) -> None:
    path = tmp_path / "track.txt"
    path.write_text(f"AL082022,            HERMINE,      1,\n{LINE}\nAL092022,   IAN,  2,\n{LINE}\n{LINE}\n")
    assert read_best_track(path, "AL082022") == parse_fixes(LINE)
    assert len(read_best_track(path, "AL092022")) == 2
    with pytest.raises(WeatherError, match=r"track\.txt has no storm 'IAN'"):
        read_best_track(path, "IAN")
    with pytest.raises(WeatherError, match=r"cannot read the best track .*nothing\.txt"):
        read_best_track(tmp_path / "nothing.txt", "AL092022")
    path.write_bytes(b"\x89HDF\r\n")
    with pytest.raises(WeatherError, match=r"track\.txt is not text, .* take weather\.storm out"):
        read_best_track(path, "AL092022")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("27.2N", "27.2X", "not a HURDAT2 fix.*27.2X"),
        ("20220929", "20221329", "not a HURDAT2 fix.*20221329"),
        ("   20", "", "has no radius of maximum wind"),
        (" 120,", " -999,", "has no radii of 34, 50 and 64 kt.*2004 and later"),
        ("27.2N", "27.2S", r"2022-09-29 00:00 UTC lies at -27\.2 deg.*storms of the south are not made"),
        ("   20", " -999", "has no radius of maximum wind.*2021 and later.*core_radius"),
        ("   20", "    0", "both must be positive"),
        (" 100,", "  50,", r"radii of 32\.9 m/s, but a maximum wind of 25\.7"),
        ("  50,   60", "   0,   60", "zero where a speed is not reached"),
        (" 180,", "  40,", "must shrink from speed to speed"),
        (" 180,", "-180,", "must shrink from speed to speed"),
    ],
)
def test_lines_that_make_no_sense_are_refused(old: str, new: str, message: str) -> None:
    head, tail = (LINE[:-5], LINE[-5:]) if old == "   20" else (LINE, "")
    line = head + tail.replace(old, new) if tail else head.replace(old, new, 1)
    if not new:
        line = line.rstrip(" ,")
    with pytest.raises(WeatherError, match=message):
        parse_fixes(line)


def test_radii_of_the_wrong_shape_are_refused() -> None:
    with pytest.raises(WeatherError, match="three speeds in four quadrants"):
        BestTrackFix(0.0, 0.5, -1.4, 30.0, 3e4, ((1e5,) * 4, (0.0,) * 4))
