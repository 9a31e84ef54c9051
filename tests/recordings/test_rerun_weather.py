"""The layers of the weather, read back: truth, forecast and their difference."""

from dataclasses import replace

import numpy as np
import pytest
import rerun as rr
from rerun.chunk import RrdReader

from recordings.recorder import Layer
from recordings.rerun_chart import Chart
from recordings.rerun_palette import difference_scale, wind_picture
from recordings.rerun_times import FlightTimes
from recordings.rerun_weather import WeatherLayers, speed_mps

THRESHOLD_MPS = 15.0
AS_FORECAST = next(band.colour for band in difference_scale() if band.from_mps == -0.1)


@pytest.fixture
def layers(workshop):
    return WeatherLayers(Chart(workshop.grid), FlightTimes(0.0), 600.0, THRESHOLD_MPS)


@pytest.fixture
def sheets(workshop):
    """A storm, and the same a little to the east of where it was forecast."""
    north_km, east_km = np.indices(workshop.grid.shape) * 3.0
    sheets = []
    for sheet, middle_km in zip(workshop.sheets(stages=1), (100.0, 112.0), strict=True):
        peak_mps = 30.0 * np.exp(-(((east_km - middle_km) / 60.0) ** 2) - ((north_km - 90.0) / 50.0) ** 2)
        wind_mps = peak_mps.astype(np.float32)
        sheets.append(
            replace(
                sheet,
                hazard=peak_mps > THRESHOLD_MPS,
                wind_north_mps=wind_mps,
                wind_east_mps=np.zeros_like(wind_mps),
                peak_mps=wind_mps,
            )
        )
    return dict(zip((Layer.FORECAST, Layer.TRUTH), sheets, strict=True))


def written(drawn, path):
    """Entity and component to its value, read back from a file."""
    stream = rr.RecordingStream("test", recording_id="weather", send_properties=False)
    stream.save(path)
    for entity, archetype in drawn:
        stream.log(entity, archetype, static=True)
    stream.flush()
    stream.disconnect()
    components = {}
    for chunk in RrdReader(path).stream():
        table = chunk.to_record_batch()
        for name in table.schema.names[1:]:
            value = table.column(name).to_pylist()[-1]
            components[chunk.entity_path.lstrip("/"), name.partition(":")[2]] = value
    return components


def pixels(components, chart, layer):
    (flat,) = components[f"chart/weather/{layer}/picture", "buffer"]
    (raised,) = components[f"scene/weather/{layer}/picture", "albedo_texture_buffer"]
    assert bytes(flat) == bytes(raised)
    return np.frombuffer(bytes(flat), np.uint8).reshape(*chart.shape, 3)


def test_each_layer_shows_its_own_weather_in_both_views(layers, sheets, tmp_path):
    for layer, sheet in sheets.items():
        components = written(layers.layer(sheet), tmp_path / f"{layer}.rrd")
        assert {entity.rpartition("/")[0] for entity, _ in components} == {
            f"{view}/weather/{layer}" for view in ("chart", "scene")
        }
        expected = wind_picture(sheet.hazard, speed_mps(sheet), THRESHOLD_MPS)
        np.testing.assert_array_equal(pixels(components, layers.chart, layer), layers.chart.upright(expected))


def test_the_difference_is_drawn_exactly_where_the_layers_differ(layers, sheets, tmp_path):
    truth, forecast = sheets[Layer.TRUTH], sheets[Layer.FORECAST]
    components = written(layers.difference(truth, forecast), tmp_path / "weather.rrd")
    drawn = np.any(pixels(components, layers.chart, "difference") != np.array(AS_FORECAST), axis=-1)
    off_mps = speed_mps(truth).astype(float) - speed_mps(forecast)
    np.testing.assert_array_equal(drawn, layers.chart.upright((off_mps < -0.1) | (off_mps >= 0.1)))
    assert 0.2 < drawn.mean() < 0.95
    (label,) = components["chart/stage", "labels"]
    assert label.endswith(f"wind at 1000 m up to {abs(off_mps).max():.1f} m/s off the forecast")


def test_where_the_forecast_is_true_the_difference_is_empty_and_says_so(layers, sheets, tmp_path):
    truth = sheets[Layer.TRUTH]
    forecast = replace(truth, layer=Layer.FORECAST, hazard=truth.hazard ^ (truth.stage == 0))  # its corridor
    components = written(layers.difference(truth, forecast), tmp_path / "weather.rrd")
    assert np.all(pixels(components, layers.chart, "difference") == np.array(AS_FORECAST))
    assert components["chart/stage", "labels"][0].endswith("wind at 1000 m as forecast")


def test_a_stage_whose_altitude_is_not_known_has_none_in_its_name(layers, sheets):
    sheet = replace(sheets[Layer.TRUTH], altitude_m=None)
    assert layers.stage_name(sheet).labels.as_arrow_array().to_pylist() == [
        "stage 0: 1970-01-01 00:00 to 00:10 UTC, wind"
    ]


def test_the_edge_of_the_hazard_lies_on_the_threshold(layers, sheets, tmp_path):
    """By brute force: a line is where the wind, linear along the lines of the grid, is the threshold."""
    east_km, north_km = layers.chart.cells_km
    for layer, sheet in sheets.items():
        components = written(layers.layer(sheet), tmp_path / f"{layer}.rrd")
        raised = np.concatenate(
            [np.array(line) for line in components[f"scene/weather/{layer}/edge", "strips"]]
        )
        flat = np.concatenate(
            [np.array(line) for line in components[f"chart/weather/{layer}/edge", "strips"]]
        )
        np.testing.assert_allclose(flat * (1.0, -1.0), raised[:, :2], atol=1e-5)
        for east, north, _ in raised[:: max(1, len(raised) // 200)]:
            along_east = [np.interp(east, east_km, row) for row in sheet.peak_mps]
            assert np.interp(north, north_km, along_east) == pytest.approx(THRESHOLD_MPS, abs=0.1)
        assert abs(raised[:, 0].max() - raised[:, 0].min()) > 50.0


def test_the_forecast_is_dashed_and_the_truth_is_not(layers, sheets, tmp_path):
    lengths = {}
    for layer, sheet in sheets.items():
        components = written(layers.layer(sheet), tmp_path / f"{layer}.rrd")
        strips = components[f"chart/weather/{layer}/edge", "strips"]
        lengths[layer] = [np.hypot(*np.diff(np.array(strip), axis=0).T).sum() for strip in strips]
    assert len(lengths[Layer.TRUTH]) == 1
    assert len(lengths[Layer.FORECAST]) > 20
    assert sum(lengths[Layer.FORECAST]) == pytest.approx(sum(lengths[Layer.TRUTH]) / 2.0, rel=0.05)


def test_a_stage_without_hazard_clears_the_edge_of_the_stage_before(layers, sheets, tmp_path):
    calm = replace(sheets[Layer.TRUTH], peak_mps=np.zeros_like(sheets[Layer.TRUTH].peak_mps))
    components = written(layers.layer(calm), tmp_path / "weather.rrd")
    assert components["chart/weather/truth/edge", "strips"] == []
    assert components["scene/weather/truth/edge", "strips"] == []
