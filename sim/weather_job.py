"""What `galeway weather` does with a scenario's weather, or with that of files: told, saved, drawn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Literal

import numpy as np

from planner.hazards import Bools, strongest_mps
from planner.pictures import check_picture
from planner.windfield import WindField
from sim.clock import make_clock
from sim.errors import SimError, WeatherError
from sim.hazard_text import hazard_lines
from sim.scenario import LoadedScenario, Scenario
from sim.weather.cf_writer import check_writable, write_wind
from sim.weather.files import Reading, read_values, read_wind
from sim.weather.picture import Panels, chosen_times, draw_weather, panels_of
from sim.weather.source import MissionWeather, bring_weather
from sim.weather.times import utc


@dataclass(frozen=True, slots=True)
class Wanted:
    """What is to be made: a NetCDF file, a picture; of one time `at_s` (s since 1970 UTC), or of many."""

    save: Path | None = None
    picture: Path | None = None
    at_s: float | None = None

    def check(self) -> None:
        """Find out first whether it can be written.

        Raises:
            SimError: if it cannot; PlannerError for the picture.
        """
        if self.save is not None:
            check_writable(self.save)
        if self.picture is not None:
            check_picture(self.picture)


def moment_s(text: str) -> float:
    """A time as people write it; UTC unless it has an offset.

    Raises:
        SimError: if it is none.
    """
    try:
        moment = datetime.fromisoformat(text)
    except ValueError as error:
        raise SimError(f"--at {text!r} is no time; write one such as 2022-09-29T06:00") from error
    return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()


def scenario_weather(loaded: LoadedScenario, wanted: Wanted) -> str:
    """Save and draw the forecast that a scenario is planned on, and tell of it, stage by stage.

    Raises:
        SimError: if the weather cannot be brought, or a file not be written.
    """
    wanted.check()
    scenario, weather = loaded.scenario, bring_weather(loaded)
    if wanted.save is not None:
        sounding = "a sounding" if scenario.weather.sounding else "no wind at all"
        source = scenario.weather.storm or str(scenario.weather.file or sounding)
        title = f"Forecast of the scenario {scenario.name}"
        write_wind(wanted.save, weather.forecast, title=title, source=f"galeway, from {source}")
    closures = weather.also.planned
    closed = None if closures is None else closures.closed
    if wanted.picture is not None:
        clock = make_clock(scenario)
        stages = np.array([clock.span_s(stage)[0] for stage in range(clock.stage_count)])
        if wanted.at_s is None:
            which = chosen_times(stages)
            panels = panels_of(
                weather.forecast, stages[which].tolist(), None if closed is None else closed[which]
            )
        else:
            which = np.array([clock.stage_at(wanted.at_s - clock.departure_s)])
            panels = panels_of(weather.forecast, [wanted.at_s], None if closed is None else closed[which])
        title = f"{scenario.name}: wind at {scenario.mission.altitude_m:.0f} m"
        threshold_mps = scenario.hazard.mean_threshold_mps
        draw_weather(wanted.picture, panels, threshold_mps=threshold_mps, title=title)
    return "\n".join(_told(scenario, weather, closed))


def _told(scenario: Scenario, weather: MissionWeather, closed: Bools | None) -> list[str]:
    clock, hazard = make_clock(scenario), scenario.hazard
    speed_mps = strongest_mps(weather.forecast, clock, corridor_m=hazard.corridor_m)
    by_wind = speed_mps > hazard.mean_threshold_mps
    grid = weather.forecast.grid
    lines = [
        f"forecast of {scenario.name}: {clock.stage_count} stages, {grid.rows} x {grid.columns} cells, "
        f"{grid.describe()}",
        *hazard_lines(hazard),
        "",
    ]
    lines.append("stage  from (UTC)        strongest   hazardous  besides the wind")
    for stage in range(clock.stage_count):
        whole = by_wind[stage] if closed is None else by_wind[stage] | closed[stage]
        begins = utc(clock.span_s(stage)[0])[:16]
        besides = 0.0 if closed is None else 100.0 * float(closed[stage].mean())
        strongest = float(speed_mps[stage].max())
        lines.append(
            f"{stage:5d}  {begins}  {strongest:5.1f} m/s   {100.0 * whole.mean():7.1f} %  {besides:14.1f} %"
        )
    return [*lines, *_levels_told(scenario, weather)]


def _levels_told(scenario: Scenario, weather: MissionWeather) -> list[str]:
    """The wind at each level that the plan may change to, over all stages."""
    if weather.levels is None:
        return []
    lines = ["", f"the above is at {scenario.mission.altitude_m:g} m; at the levels, in all stages:"]
    for level_m in scenario.mission.levels_m:
        wind = weather.levels.forecast.at_altitude(level_m)
        speed_mps = strongest_mps(wind, make_clock(scenario), corridor_m=scenario.hazard.corridor_m)
        share = float((speed_mps > scenario.hazard.mean_threshold_mps).mean())
        lines.append(f"{level_m:7.0f} m  {speed_mps.max():5.1f} m/s at most, {share:.1%} hazardous by it")
    return lines


def files_weather(
    paths: Sequence[Path],
    reading: Reading,
    wanted: Wanted,
    *,
    threshold_mps: float,
    member: int | Literal["mean"] = "mean",
    altitude_m: float | None = None,
    gust: str | None = None,
) -> None:
    """Save and draw the weather of files.

    Args:
        paths: of one forecast's files.
        reading: what to take where there is a choice.
        wanted: what to make.
        threshold_mps: what is outlined in the picture.
        member: of an ensemble.
        altitude_m: what the picture shows of several heights; the lowest by default.
        gust: the name of a speed to draw where there is no wind to be had.

    Raises:
        WeatherError: if the files have no wind, or cannot be read.
    """
    wanted.check()
    if wanted.save is None and gust is not None:
        _draw_speed(paths, reading, wanted, gust, threshold_mps, member)
        return
    wind = read_wind(paths, reading=reading, member=member)
    names = ", ".join(path.name for path in paths[:3])
    if wanted.save is not None:
        write_wind(wanted.save, wind, title=f"Wind of {names}", source=f"galeway, from {names}")
    if wanted.picture is not None:
        here, height = _at_altitude(wind, altitude_m)
        times_s = (
            [wanted.at_s] if wanted.at_s is not None else wind.time_s[chosen_times(wind.time_s)].tolist()
        )
        panels = panels_of(here, times_s)
        draw_weather(wanted.picture, panels, threshold_mps=threshold_mps, title=f"{names}: wind{height}")


def _at_altitude(wind: WindField, altitude_m: float | None) -> tuple[WindField, str]:
    if wind.height_m is None:
        return wind, ""
    wanted_m = float(wind.height_m[0]) if altitude_m is None else altitude_m
    return wind.at_altitude(wanted_m), f" at {wanted_m:.0f} m"


def _draw_speed(
    paths: Sequence[Path],
    reading: Reading,
    wanted: Wanted,
    name: str,
    threshold_mps: float,
    member: int | Literal["mean"],
) -> None:
    """A speed without direction, of one member or the mean of all."""
    if wanted.picture is None:
        return
    found = read_values(paths, name, reading=reading)
    if member != "mean" and member not in found.numbers:
        raise WeatherError(
            f"{name} has the members {found.numbers[0]} to {found.numbers[-1]}, not {member}; choose one"
        )
    values = found.values[:, :, 0]
    speed_mps = values.mean(axis=0) if member == "mean" else values[found.numbers.index(int(member))]
    spans = found.spans
    which = chosen_times(found.time_s)
    if wanted.at_s is not None:
        off_s = np.maximum(spans.begin_s - wanted.at_s, wanted.at_s - spans.end_s)
        if off_s.min() > 1.0:
            times = ", ".join(map(utc, found.time_s[:12]))
            held = f"{found.name} holds {'windows that end at ' if spans.windowed else ''}{times} UTC"
            raise WeatherError(f"{held}, not {utc(wanted.at_s)}; choose one of them")
        which = np.array([int(off_s.argmin())])
    whose = f"mean of {len(found.numbers)} members" if len(found.numbers) > 1 else "speed"
    title = f"{paths[0].name}: {name}, {whose if member == 'mean' else f'member {member}'}"
    panels = Panels(found.grid, spans.end_s[which], speed_mps[which], begin_s=spans.begin_s[which])
    draw_weather(wanted.picture, panels, threshold_mps=threshold_mps, title=title)
