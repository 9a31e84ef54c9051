"""Whether the tanks hold what a plan takes."""

from __future__ import annotations

from aircraft.description import AircraftFolder
from aircraft.envelope import Condition
from aircraft.trim_stand import TrimStand
from planner.plans import Plan


def short_of_fuel(plan: Plan, aircraft: AircraftFolder, cruise_mps: float, altitude_m: float) -> str | None:
    """What a user has to know of a plan that takes more fuel than there is; None if the tanks suffice.

    A plan that does not say what it burns is taken to be flown at cruise, level and with full tanks, of which
    it burns a little less when they are half empty. Nothing is said where no such flight can be trimmed.

    Args:
        plan: which may have no route.
        aircraft: with the fuel it starts with.
        cruise_mps: true airspeed.
        altitude_m: of the flight.
    """
    stand = TrimStand(aircraft)
    trimmed = stand(Condition(cruise_mps, altitude_m))
    if not plan.waypoints or trimmed is None or trimmed.fuel_flow_kgps <= 0.0:
        return None
    burned_kg = plan.outcome.fuel_kg
    if burned_kg is None:
        burned_kg = trimmed.fuel_flow_kgps * plan.duration_s
    if burned_kg <= stand.fuel_kg:
        return None
    lasting_s = plan.duration_s * stand.fuel_kg / burned_kg
    return (
        f"the way to {plan.goal} takes {_h_mm(plan.duration_s)} h and about {_kg(burned_kg)} of fuel; "
        f"{aircraft.name} holds {_kg(stand.fuel_kg)}, enough for {_h_mm(lasting_s)} h; choose a nearer "
        "goal, a plan with less waiting, or an aircraft with larger tanks"
    )


def _kg(mass_kg: float) -> str:
    return f"{mass_kg:.1f} kg" if mass_kg >= 1.0 else f"{mass_kg:.2g} kg"


def _h_mm(time_s: float) -> str:
    minutes = int(time_s // 60.0)
    return f"{minutes // 60}:{minutes % 60:02d}"
