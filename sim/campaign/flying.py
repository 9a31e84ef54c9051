"""What a worker does with one flight: fly it, judge its recording, and make its row."""

from __future__ import annotations

import os
import shutil
import traceback
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import recordings
from aircraft.errors import AircraftError
from planner.errors import PlannerError
from recordings.errors import RecordingError
from recordings.limits import judge, parse_limits
from recordings.mcap_writer import McapRecorder
from recordings.tracking import track
from sim.campaign.durable import sync
from sim.campaign.flight import Flight
from sim.campaign.keeping import Keep
from sim.campaign.row import Row, RowMaker, Unflown
from sim.campaign.shared import plan_of, weather_of
from sim.closed_loop import fly
from sim.errors import SimError
from sim.plan_text import why_not_flown
from sim.preparation import make_aircraft, prepare_flight


@dataclass(frozen=True, slots=True)
class Flying:
    """The work of a campaign: flight to row.

    `keep`: which recordings stay, as `run_000017.mcap` in `folder`; of `worst` all that may be among them.
    `scratch`: where recordings are written until they are judged; None for the system's temporary folder.
    A worker on another machine must see `folder` by the same path, unless nothing is kept.
    """

    keep: Keep
    folder: Path
    scratch: Path | None = None

    def __call__(self, flight: Flight) -> Row:
        """Fly; whatever is wrong with the flight itself is in its row.

        Raises:
            OSError: where the machine does not let it fly, such as a full disk.
            RecordingError: where the recording cannot be written, for the same reason.
        """
        maker = RowMaker(flight)
        try:
            return self._flown(flight, maker)
        except RecordingError as error:
            if isinstance(error.__cause__, OSError):
                raise
            return maker.unflown(Unflown.REFUSED, str(error))
        except (SimError, PlannerError, AircraftError) as error:
            return maker.unflown(Unflown.REFUSED, str(error))
        except OSError:
            raise
        except Exception as error:  # one flight's fault is not to end the others
            where = traceback.extract_tb(error.__traceback__)[-1]
            place = f"{Path(where.filename).name}:{where.lineno}"
            return maker.unflown(Unflown.FAULT, f"{type(error).__name__} at {place}: {error}")

    def _flown(self, flight: Flight, maker: RowMaker) -> Row:
        loaded = flight.load()
        scenario = loaded.scenario
        limits = parse_limits(scenario.limits)
        aircraft = make_aircraft(scenario, loaded.folder)
        weather = weather_of(loaded)
        plan = plan_of(loaded, weather, aircraft)
        reason = why_not_flown(plan, scenario.planner.abstain_below)
        if reason is not None:
            return maker.unflown(Unflown.ABSTAINED if plan.outcome.abstained else Unflown.NO_ROUTE, reason)
        setup = prepare_flight(loaded, weather, plan, aircraft)
        with TemporaryDirectory(prefix=scratch_name(flight), dir=self.scratch) as scratch:
            path = Path(scratch) / "flight.mcap"
            fly(setup, McapRecorder(path), _unheard)
            tracking = track(recordings.open(path))
            row = maker.flown(tracking, judge(tracking, limits) if limits else [], path)
            if self.keep.may_keep(row):
                keep_recording(path, self.keep.path(self.folder, flight.run))
        return row


def scratch_name(flight: Flight) -> str:
    """What the folder's name begins with in which a flight is recorded."""
    return f"galeway-{flight.run}-"


def _unheard(_: float) -> None:
    """Nobody watches."""


def keep_recording(made: Path, kept: Path) -> None:
    """Move a recording to its place, where it stays whatever happens to the machine."""
    partial = kept.with_suffix(f".partial-{os.getpid()}")
    shutil.move(made, partial)  # maybe from another disk
    sync(partial)
    partial.replace(kept)
    sync(kept.parent)
