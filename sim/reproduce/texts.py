"""What the page says of days, forecasts, policies and flights, from the numbers that they are made with."""

from __future__ import annotations

from collections.abc import Sequence

from sim.reproduce.page import prose
from sim.reproduce.tuning import Tuning
from sim.reproduce.wording import FEW_DAYS, counted, seeds
from sim.reproduce.worlds import World

FIGURE2 = [
    prose(
        """The map of the first stage, as forecast, held for the whole day. Clearance is the distance to the
        nearest hazardous cell. The picture shows the longest of the first day's routes."""
    )
]

FIGURE4 = [
    prose(
        """Both plan on the forecast of the first level of error. f is what their routes are worth in the
        truth, with clearance 0 where they lead through hazard: the mean over the goals to which both have a
        route, whether it is safe or not."""
    )
]


def about_days(world: World, days: Sequence[int], members: int, model: str) -> list[str]:
    """Where seeded days come from, and their forecasts; `model` is what the page says of their errors'."""
    low, high = world.shares
    near, far = world.distances_cells
    slow_mps, fast_mps = world.drifts_mps
    return [
        prose(
            f"""**Days.** {counted(len(days), "day")}, {seeds(days)}: {world.rows} x {world.columns}
            cells of {world.cell_m / 1e3:g} km, {world.stage_count} stages of {world.steps_per_stage} steps
            of {world.step_s:g} s, one start, {world.goals} goals {near} to {far} moves away. Weather
            systems, in which wind is correlated over {world.system_m / 1e3:g} km, drift at {slow_mps:g} to
            {fast_mps:g} m/s, grow and fade (`sim/reproduce/systems.py`), with {100 * low:g} to
            {100 * high:g} % of the area over {world.threshold_mps:g} m/s at any moment; a cell is hazardous
            for all of a stage in which it is so once. A goal is never hazardous all day, but need not be
            reachable."""
        ),
        "",
        prose(
            f"""**Forecasts** err by the {model}: weather is displaced and made
            stronger or weaker by errors that grow with lead time, at two levels: the means published for
            hurricane forecasts, and twice those. {members} members come with each forecast; nothing but
            chance tells the truth from a member."""
        ),
        *_few(len(days)),
    ]


def about_own_days(count: int, hazards: str, forecast: str) -> list[str]:
    """Where matrices come from."""
    return [
        prose(
            f"""**Days.** {count}, given as hazard matrices: the truth from `{hazards}`, the forecast from
            `{forecast}`. No forecasts are issued later, so nothing is replanned."""
        ),
        *_few(count),
    ]


def _few(days: int) -> list[str]:
    """A warning where they are few."""
    if days >= FEW_DAYS:
        return []
    return [
        "",
        prose(
            f"""**Of {counted(days, "day")} alone intervals and verdicts mean little**: what is below shows
            what the page tells, not how the policies stand. That takes {FEW_DAYS} days or more."""
        ),
    ]


def about_policies(tuning: Tuning, small: Tuning, tuned_on: str) -> list[str]:
    """What the policies are, and what they were tuned on."""
    weights = tuning.weights
    return [
        "| policy | plans |",
        "| --- | --- |",
        "| plain BFS | the shortest way on the forecast of the first stage, as if it never changed |",
        "| the paper's score | "
        + prose(
            f"""the arrival of the best f by equation (2): alpha {weights.alpha:g}, beta {weights.beta:g},
            gamma {weights.gamma:g}, delta {weights.delta:g}, clearance at most
            {counted(weights.clearance_cap_cells, "cell")} |"""
        ),
        "| margins | "
        + prose(
            f"""the earliest arrival that stays {counted(tuning.margin_cells, "cell")} clear of forecast
            hazard; half of that where there is no such way, then none |"""
        ),
        "| survival | "
        + prose(
            f"""the least sum of -log(1 - p) + {tuning.price:g} over the steps, p the share of members,
            blurred by {counted(tuning.blur_cells, "cell")} |"""
        ),
        "| survival or abstain | "
        + prose(
            f"""the same, not flown if it survives in less than {100 * tuning.abstain_below:g} % of the
            members |"""
        ),
        "| survival, replanned | "
        + prose(
            """the same, and found anew from where the aircraft is, at each stage whose forecast gives the
            rest of the route less than 99 % |"""
        ),
        "| oracle | the earliest arrival in the truth |",
        "",
        prose(
            """Who abstains or finds no way stays at the start: neither an arrival nor a loss, but *not
            flown*. A flight is *lost* at the first step in a cell that is hazardous in the truth of that
            stage. *Of the gap*: the part of the way from the paper's score to the oracle. *Longer*: total
            flight time, against that of the paper's score, to the goals that both reach safely."""
        ),
        "",
        prose(
            f"""The dials, the paper's weights among them, were turned on other days than those reported:
            {tuned_on}. They stand where `galeway reproduce --tune` puts them, which tells what each value of
            a grid gives there (docs/tuning.md). In the smaller weather of the flown part that is beta
            {small.weights.beta:g}, clearance at most
            {counted(small.weights.clearance_cap_cells, "cell")}, margins of
            {small.margin_cells:g}, blur {small.blur_cells:g}, price {small.price:g}, and abstaining below
            {100 * small.abstain_below:g} % of the members."""
        ),
    ]


def about_flights(world: World, days: Sequence[int], corridor_m: float, severity: int) -> list[str]:
    """How the flown part is made."""
    stage_min = world.steps_per_stage * world.step_s / 60.0
    return [
        prose(
            f"""{seeds(days).capitalize()}, {counted(world.goals, "goal")} a day, both levels of error, in a
            smaller world, so that flights take half an hour to two hours: {world.rows} x {world.columns}
            cells, {world.stage_count} stages of {stage_min:g} minutes, wind correlated over
            {world.system_m / 1e3:g} km, planned on a forecast that is {world.age_s / 3600:g} hours old at
            departure. The Aerosonde flies each plan on JSBSim through the true wind, with Milspec
            turbulence of severity {severity} from a seed of its own, and is judged from its recording. Here
            plans keep a corridor of {corridor_m:g} m free, ask for moves that the aircraft can make in the
            forecast wind, and for both cells of a move to be safe in every stage that it touches."""
        ),
        "",
        prose(
            """*Planned-safe*: the cells of the plan are safe in the truth at the plan's own steps.
            *Flown-safe*: the flight arrived, and never met steady wind above the threshold. Survival or
            abstain flies those plans of survival that it does not turn down; its flights are not flown
            twice. A plan that is lost on the grid can be safe in the air, since a cell is hazardous for all
            of a stage in which it is so once, and the aircraft passes it in two minutes."""
        ),
        *_few(len(days)),
    ]
