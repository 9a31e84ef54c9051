"""Changes of level against Dijkstra's algorithm over (level, cell, interval), in plain Python."""

import heapq
import math
from itertools import permutations, product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.air import Air, Chart
from planner.climbs import at_every_level, with_climbs
from planner.earliest import sweep
from planner.edges import TimedProblem
from planner.grid import Grid, geodesic_m
from planner.hazards import StageClock
from planner.intervals import SafeIntervals
from planner.levels import Climbing, Levels, stacked
from planner.moves import Moves

AIRSPEED_MPS = 27.0
WIND_MAX_MPS = 15.0
STEP_RAD = 3600.0 / 6_371_000.0


class World:
    """A small world with random hazard and wind at several heights; some are flown, some only passed."""

    def __init__(self, seed, share, count=None):
        random = np.random.default_rng(seed)
        stages, rows, columns = (int(random.integers(*ends)) for ends in ((1, 5), (2, 6), (2, 7)))
        count = count or int(random.integers(2, 4))
        self.height_m = np.cumsum(random.uniform(80.0, 600.0, count))
        flown = random.random(count) < 0.7
        flown[0] = flown[-1] = True
        self.climbing = Climbing(float(random.uniform(1.5, 5.0)), float(random.uniform(1.5, 5.0)))
        self.clock = StageClock(0.0, stages, int(random.integers(2, 6)), 120.0)
        self.grid = Grid(math.radians(25.0), math.radians(-85.0), STEP_RAD, STEP_RAD, rows, columns)
        self.hazard = random.random((stages, count, rows, columns)) < share
        self.hazard[0, 0, 0, 0] = False
        self.time_s = np.union1d(
            np.arange(stages + 1) * self.clock.stage_s,
            random.uniform(0.0, stages * self.clock.stage_s, int(random.integers(3))),
        )
        speed = WIND_MAX_MPS * np.sqrt(random.random((self.time_s.size, count, rows, columns)))
        self.wind_mps = (speed * np.exp(2j * np.pi * random.random(speed.shape))).astype(np.complex64)
        self.flown = flown

    def levels(self, flown=None):
        return Levels(self.height_m, self.flown if flown is None else flown, self.grid.rows)

    def problem(self, flown=None, climbs=True):
        levels = self.levels(flown)
        chart = Chart.of(self.grid, levels)
        moves = Moves.on(chart)
        if climbs:
            moves = with_climbs(moves, chart, self.climbing, AIRSPEED_MPS, WIND_MAX_MPS)
        else:
            moves = at_every_level(moves, levels)
        return TimedProblem(
            SafeIntervals.of(stacked(self.hazard, True)),
            self.clock,
            Air(self.time_s, stacked(self.wind_mps, 0.0)),
            moves,
            AIRSPEED_MPS,
            AIRSPEED_MPS + WIND_MAX_MPS + 0.1,
        )

    def arrivals(self, flown=None, climbs=True):
        """The earliest arrival at every (level, row, column), and the sweep."""
        found = sweep(self.problem(flown, climbs), {(0, 0): 0.0})
        levels = self.levels(flown)
        arrive_s = {}
        for level, row, column in np.ndindex(self.hazard.shape[1:]):
            state = found.best_state(levels.cell(level, (row, column)))
            if state is not None:
                arrive_s[level, row, column] = float(found.arrive_s[state])
        return arrive_s, found


def bearing_and_length(grid, here, there):
    rows, columns = [here[0], there[0]], [here[1], there[1]]
    north_m, east_m = grid.frame.to_plane(grid.lat_rad[rows], grid.lon_rad[columns])
    course = math.atan2(east_m[1] - east_m[0], north_m[1] - north_m[0])
    return course, geodesic_m(
        grid.lat_rad[rows[0]], grid.lon_rad[columns[0]], grid.lat_rad[rows[1]], grid.lon_rad[columns[1]]
    )


def moves_of(world):
    """(level, other level, rows, columns, cells, least time, rate): all that can be done from a level."""
    flown = np.flatnonzero(world.flown).tolist()
    compass = [step for step in product((-1, 0, 1), repeat=2) if step != (0, 0)]
    for level in flown:
        for step in compass:
            yield level, level, *step, 1, 0.0, 0.0
    for (here, there), step in product(permutations(flown, 2), compass):
        rise_m = world.height_m[there] - world.height_m[here]
        rate_mps = world.climbing.up_mps if rise_m > 0 else world.climbing.down_mps
        least_s = abs(rise_m) / rate_mps
        lengths = [
            bearing_and_length(world.grid, (row, column), (row + step[0], column + step[1]))[1]
            for row, column in np.ndindex(world.grid.shape)
            if 0 <= row + step[0] < world.grid.rows and 0 <= column + step[1] < world.grid.columns
        ]
        for wind_mps in {-WIND_MAX_MPS, 0.0, WIND_MAX_MPS}:
            cells = max(1, math.ceil(least_s * (AIRSPEED_MPS + wind_mps) / min(lengths)))
            yield here, there, step[0] * cells, step[1] * cells, cells, least_s, rate_mps


def by_heap(world):
    """Earliest arrival of every (level, row, column), from the first cell of the lowest level."""
    stages, stage_s = len(world.hazard), world.clock.stage_s
    horizon_s = stages * stage_s
    every = sorted(set(moves_of(world)))

    def beside(here, rows, columns, cells, levels):
        north, east = np.sign(rows), np.sign(columns)
        wide = 0 if not (north and east) else 1 if cells == 1 else 2
        for level, up, right in product(levels, range(cells + 1), range(cells + 1)):
            if abs(up - right) <= wide:
                row, column = (up * north, right * east) if wide else (up * north, up * east)
                yield level, here[0] + row, here[1] + column

    def run_end(cells, stage):
        while stage < stages and not any(world.hazard[(stage, *cell)] for cell in cells):
            stage += 1
        return stage

    def is_slow_enough(cells, course, length_m, least_s, stage):
        """Whether no wind beside the line makes the change too fast, until who leaves last is there."""
        until_s = (stage + 1) * stage_s + least_s
        later = [time_s for time_s in world.time_s if time_s >= until_s]
        known = [stage * stage_s <= time_s <= (later[0] if later else until_s) for time_s in world.time_s]
        levels, rows, columns = np.array(cells).T
        winds = world.wind_mps[known][:, levels, rows, columns]
        tail = float((winds * np.exp(-1j * course)).real.max())
        return least_s * (AIRSPEED_MPS + tail + 0.1) <= length_m

    def flight_end(here, there, course, length_m, depart_s, rate_mps):
        speeds = []
        for sheet in world.wind_mps:
            wind = 0.5 * (complex(sheet[here]) + complex(sheet[there])) * np.exp(-1j * course)
            speeds.append(wind.real + math.sqrt(AIRSPEED_MPS**2 - rate_mps**2 - wind.imag**2))

        def covered_m(until_s):
            corners = [depart_s, *world.time_s[(world.time_s > depart_s) & (world.time_s < until_s)], until_s]
            return np.trapezoid(np.interp(corners, world.time_s, speeds), corners)

        low, high = depart_s, horizon_s
        if covered_m(high) < length_m:
            return math.inf
        for _ in range(40):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if covered_m(middle) < length_m else (low, middle)
        return high

    def open_until(here, move, stage):
        """The stage in which a move closes that can be made from a cell in a stage; 0 if it cannot."""
        level, other, rows, columns, cells, least_s, _ = move
        there = other, here[1] + rows, here[2] + columns
        if level != here[0] or not (0 <= there[1] < world.grid.rows and 0 <= there[2] < world.grid.columns):
            return 0
        touched = range(min(level, other), max(level, other) + 1)
        wide = list(beside(here[1:], rows, columns, cells, touched))
        course, length_m = bearing_and_length(world.grid, here[1:], there[1:])
        longest = least_s * (AIRSPEED_MPS + WIND_MAX_MPS) <= length_m
        end = run_end(wide, stage)
        if end <= stage or not (longest or is_slow_enough(wide, course, length_m, least_s, stage)):
            return 0
        return end

    def shorter_than(move):
        """Moves to the same level on the same course over fewer cells."""
        way = (*move[:2], *np.sign(move[2:4]))
        return [other for other in every if (*other[:2], *np.sign(other[2:4])) == way and other[4] < move[4]]

    shorter = {move: shorter_than(move) for move in every}
    arrive, done = {((0, 0, 0), 0): 0.0}, set()
    heap = [(0.0, (0, 0, 0), 0)]
    while heap:
        now_s, here, began = heapq.heappop(heap)
        if (here, began) in done:
            continue
        done.add((here, began))
        for move in every:
            _, level, rows, columns, _, _, rate_mps = move
            there = level, here[1] + rows, here[2] + columns
            for stage in range(int(now_s // stage_s), run_end([here], began)):
                depart_s, end = max(now_s, stage * stage_s), open_until(here, move, stage)
                if not end or any(open_until(here, other, stage) for other in shorter[move]):
                    continue
                course, length_m = bearing_and_length(world.grid, here[1:], there[1:])
                arrive_s = flight_end(here, there, course, length_m, depart_s, rate_mps)
                if arrive_s < end * stage_s:
                    first = stage
                    while first > 0 and not world.hazard[(first - 1, *there)]:
                        first -= 1
                    if arrive_s < arrive.get((there, first), math.inf):
                        arrive[there, first] = arrive_s
                        heapq.heappush(heap, (arrive_s, there, first))
    best: dict[tuple[int, int, int], float] = {}
    for (cell, _), arrive_s in arrive.items():
        if arrive_s < horizon_s:
            best[cell] = min(arrive_s, best.get(cell, math.inf))
    return best


@settings(max_examples=4, deadline=None)
@given(seed=st.integers(0, 10**6), share=st.sampled_from([0.0, 0.15, 0.3]))
def test_arrivals_at_all_levels_are_those_of_the_heap(seed, share):
    world = World(seed, share)
    ours, _ = world.arrivals()
    theirs = by_heap(world)
    assert ours.keys() == theirs.keys()
    for cell, arrive_s in ours.items():
        assert arrive_s == pytest.approx(theirs[cell], rel=2e-5, abs=1e-3)


@settings(max_examples=8, deadline=None)
@given(seed=st.integers(0, 10**6), share=st.sampled_from([0.0, 0.2, 0.4]))
def test_another_level_never_makes_an_arrival_later(seed, share):
    world = World(seed, share, count=3)
    fewer, _ = world.arrivals(flown=np.array([True, False, True]))
    more, _ = world.arrivals(flown=np.array([True, True, True]))
    alone, _ = world.arrivals(climbs=False)
    for before, after in ((alone, fewer), (fewer, more)):
        for cell, arrive_s in before.items():
            assert after[cell] <= arrive_s + 1e-3
