import math
from datetime import UTC, datetime
from pathlib import Path

import pytest

from sim.errors import WeatherError
from sim.weather.best_track import HURRICANE_IAN, BestTrackFix, parse_fixes, read_best_track

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


def test_the_table_of_ian_is_the_published_one(data_folder: Path) -> None:
    published = read_best_track(data_folder / "hurdat2_atlantic_2021_2022.txt", "AL092022")
    assert len(published) == 40
    begin_s, end_s = HURRICANE_IAN[0].time_s, HURRICANE_IAN[-1].time_s
    assert tuple(fix for fix in published if begin_s <= fix.time_s <= end_s) == HURRICANE_IAN


def test_the_table_of_ian_covers_a_day_and_more_from_its_departure() -> None:
    departure_s = datetime(2022, 9, 29, tzinfo=UTC).timestamp()
    assert HURRICANE_IAN[0].time_s < departure_s
    assert HURRICANE_IAN[-1].time_s >= departure_s + 48 * 3600


def test_a_storm_is_read_from_a_file_in_the_format(tmp_path: Path) -> None:
    path = tmp_path / "track.txt"
    path.write_text(f"AL082022,            HERMINE,      1,\n{LINE}\nAL092022,   IAN,  2,\n{LINE}\n{LINE}\n")
    assert read_best_track(path, "AL082022") == parse_fixes(LINE)
    assert len(read_best_track(path, "AL092022")) == 2
    with pytest.raises(WeatherError, match=r"track\.txt has no storm 'IAN'"):
        read_best_track(path, "IAN")
    with pytest.raises(WeatherError, match=r"cannot read the best track .*nothing\.txt"):
        read_best_track(tmp_path / "nothing.txt", "AL092022")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("27.2N", "27.2X", "not a HURDAT2 fix.*27.2X"),
        ("20220929", "20221329", "not a HURDAT2 fix.*20221329"),
        (" 20", "", "not a HURDAT2 fix"),
        ("27.2N", "27.2S", r"2022-09-29 00:00 UTC lies at -27\.2 deg"),
        ("   20", " -999", "2021 or later"),
        (" 100,", "  50,", r"radii of 32\.9 m/s, but a maximum wind of 25\.7"),
        ("  50,   60", "   0,   60", "zero where a speed is not reached"),
        (" 180,", "  40,", "must shrink from speed to speed"),
        (" 180,", "-180,", "must shrink from speed to speed"),
    ],
)
def test_lines_that_make_no_sense_are_refused(old: str, new: str, message: str) -> None:
    head, tail = (LINE[:-5], LINE[-5:]) if old in ("   20", " 20") else (LINE, "")
    line = head + tail.replace(old, new) if tail else head.replace(old, new, 1)
    if not new:
        line = line.rstrip(" ,")
    with pytest.raises(WeatherError, match=message):
        parse_fixes(line)


def test_radii_of_the_wrong_shape_are_refused() -> None:
    with pytest.raises(WeatherError, match="three speeds in four quadrants"):
        BestTrackFix(0.0, 0.5, -1.4, 30.0, 3e4, ((1e5,) * 4, (0.0,) * 4))
