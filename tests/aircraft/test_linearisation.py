"""The aerosonde's modes of motion: the published ones, the textbook's formulas, the specification.

JSBSim linearises the trimmed aircraft numerically. It is held against three sources apart:

- the authors' own linear model of the same aircraft at 25 m/s (Beard & McLain, *Small Unmanned Aircraft*,
  project files, `model_coef.py`; air of 1.2682 kg/m3, gravity 9.81 m/s2), for which our departures from their
  coefficients are undone;
- the closed forms of the book's tables 5.1 and 5.2, with our coefficients;
- level 1 of MIL-F-8785C for class I aircraft in flight phase category B (climb, cruise, loiter).
"""

from __future__ import annotations

import math
import shutil
from pathlib import Path
from typing import NamedTuple

import jsbsim
import numpy as np
import pytest
from numpy.typing import ArrayLike

import aircraft.description as module
from aircraft.jsbsim_aircraft import JsbsimAircraft
from aircraft.turbulence import Turbulence

AIRSPEEDS_MPS = (20.0, 25.0, 30.0, 38.0)
LONGITUDINAL, LATERAL = ("Vt", "Alpha", "Q", "Theta"), ("Beta", "P", "R", "Phi")
GRAVITY_MPS2 = 9.81

# states u, w, q, theta and v, p, r, phi
PUBLISHED_LONGITUDINAL = [
    [-0.206751, 0.501088, -1.222177, -9.795068],
    [-0.561011, -4.463973, 24.370933, -0.540322],
    [0.200319, -3.992960, -5.294738, 0.0],
    [0.0, 0.0, 0.999974, 0.0],
]
PUBLISHED_LATERAL = [
    [-0.776773, 1.252151, -24.968623, 9.797524],
    [-3.866719, -22.628851, 10.905041, 0.0],
    [0.783077, -0.115092, -1.227655, 0.0],
    [0.0, 1.0, 0.050149, 0.0],
]
PUBLISHED_DENSITY_KGPM3 = 1.2682
OUR_DEPARTURES = {  # what multiplies a rate in aerosonde.xml, and in the authors' files
    "0.14 </value> <property> aero/yaw-rate-norm": "0.25 </value> <property> aero/yaw-rate-norm",
    "-0.069 </value> <property> aero/roll-rate-norm": "0.069 </value> <property> aero/roll-rate-norm",
}


class Modes(NamedTuple):
    """Eigenvalues [1/s]; of a pair, the one above the real axis."""

    short_period: complex
    phugoid: complex
    roll: float
    dutch_roll: complex
    spiral: float


def damping(mode: complex) -> float:
    return -mode.real / abs(mode)


def modes_of(longitudinal: ArrayLike, lateral: ArrayLike) -> Modes:
    phugoid, short_period = sorted((m for m in np.linalg.eigvals(longitudinal) if m.imag > 0.0), key=abs)
    eigenvalues = np.linalg.eigvals(lateral)
    (dutch_roll,) = (m for m in eigenvalues if m.imag > 0.0)
    roll, spiral = sorted(float(m.real) for m in eigenvalues if m.imag == 0.0)
    return Modes(complex(short_period), complex(phugoid), roll, complex(dutch_roll), spiral)


def trimmed(airspeed_mps: float, altitude_m: float = 1000.0, warmer_k: float = 0.0) -> JsbsimAircraft:
    """Open loop: the autopilot is not engaged."""
    aircraft = JsbsimAircraft("aerosonde", turbulence=Turbulence(), seed=1)
    aircraft._fdm["atmosphere/delta-T"] = 1.8 * warmer_k
    aircraft._engage_autopilot = lambda: None  # type: ignore[method-assign]
    aircraft.start(
        lat_rad=0.45,
        lon_rad=-1.45,
        altitude_m=altitude_m,
        heading_rad=1.0,
        airspeed_mps=airspeed_mps,
        time_s=0.0,
    )
    return aircraft


def linearised(aircraft: JsbsimAircraft) -> Modes:
    linear = jsbsim.FGLinearization(aircraft._fdm)
    system = np.asarray(linear.system_matrix)
    longitudinal, lateral = (
        system[np.ix_(rows, rows)]
        for rows in ([linear.x_names.index(name) for name in names] for names in (LONGITUDINAL, LATERAL))
    )
    return modes_of(longitudinal, lateral)


@pytest.fixture(scope="module")
def modes() -> dict[float, Modes]:
    return {airspeed_mps: linearised(trimmed(airspeed_mps)) for airspeed_mps in AIRSPEEDS_MPS}


# the published linear model


def test_the_published_modes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    models = tmp_path / "models"
    shutil.copytree(module.BUILT_IN, models)
    xml = models / "aerosonde" / "aerosonde.xml"
    text = xml.read_text()
    for ours, theirs in OUR_DEPARTURES.items():
        assert text.count(ours) == 1
        text = text.replace(ours, theirs)
    xml.write_text(text)
    monkeypatch.setattr(module, "BUILT_IN", models)

    aircraft = trimmed(25.0, altitude_m=100.0, warmer_k=-12.7)
    density_kgpm3 = aircraft._fdm["atmosphere/rho-slugs_ft3"] * 515.379
    assert density_kgpm3 == pytest.approx(PUBLISHED_DENSITY_KGPM3, rel=0.002)
    ours, published = linearised(aircraft), modes_of(PUBLISHED_LONGITUDINAL, PUBLISHED_LATERAL)
    assert abs(ours.short_period - published.short_period) < 0.02 * abs(published.short_period)
    assert ours.roll == pytest.approx(published.roll, rel=0.02)
    assert abs(ours.dutch_roll - published.dutch_roll) < 0.02 * abs(published.dutch_roll)
    assert ours.spiral == pytest.approx(published.spiral, abs=0.01)
    assert abs(ours.phugoid) == pytest.approx(abs(published.phugoid), rel=0.05)
    # its damping is the propeller's, whose thrust falls less with airspeed on our engine than on their motor
    assert 0.1 < damping(ours.phugoid) < damping(published.phugoid)


# the textbook


def textbook(aircraft: JsbsimAircraft) -> Modes:
    """Beard & McLain, tables 5.1 and 5.2, with the coefficients of aerosonde.xml and constant thrust.

    Longitudinally in stability axes, (V, V alpha, q, theta), whose modes are those of body axes.
    """
    fdm, state = aircraft._fdm, aircraft.state()
    speed_mps, alpha_rad = state.airspeed_mps, state.angle_of_attack_rad
    density_kgpm3 = fdm["atmosphere/rho-slugs_ft3"] * 515.379
    area_m2, span_m, chord_m = 0.55, 2.8956, 0.18994
    elevator_rad = math.radians(30.0) * state.elevator
    lift, slope = 0.23 + 5.61 * alpha_rad, 5.61
    drag, drag_slope = 0.043 + 0.02321 * lift**2, 2.0 * 0.02321 * lift * slope

    force = 0.5 * density_kgpm3 * speed_mps * area_m2 / (fdm["inertia/mass-slugs"] * 14.5939)  # q S / m V
    pitching = 0.5 * density_kgpm3 * speed_mps * area_m2 * chord_m / 1.135  # q S c / Jy V
    moment = 0.0135 - 2.74 * alpha_rad - 0.99 * elevator_rad
    turning_mps = speed_mps - force * 7.95 * chord_m / 2.0
    longitudinal = [
        [-2.0 * force * drag, -force * (drag_slope - lift), 0.0, -GRAVITY_MPS2],
        [-2.0 * force * lift, -force * (slope + drag), turning_mps, 0.0],
        [2.0 * pitching * moment, -2.74 * pitching, -38.21 * pitching * chord_m / 2.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
    ]

    moments = 0.5 * density_kgpm3 * speed_mps * area_m2 * span_m  # per sideslip velocity
    rate_m = span_m / 2.0
    roll_and_yaw = moments * np.array(
        [[-0.13, -0.51 * rate_m, 0.14 * rate_m], [0.073, -0.069 * rate_m, -0.095 * rate_m]]
    )
    (l_v, l_p, l_r), (n_v, n_p, n_r) = np.linalg.solve([[0.8244, -0.1204], [-0.1204, 1.759]], roll_and_yaw)
    forward_mps, down_mps = speed_mps * math.cos(alpha_rad), speed_mps * math.sin(alpha_rad)
    lateral = [
        [-0.98 * force, down_mps, -forward_mps, GRAVITY_MPS2 * math.cos(alpha_rad)],
        [l_v, l_p, l_r, 0.0],
        [n_v, n_p, n_r, 0.0],
        [0.0, 1.0, math.tan(alpha_rad), 0.0],
    ]
    return modes_of(longitudinal, lateral)


@pytest.mark.parametrize("airspeed_mps", AIRSPEEDS_MPS)
def test_the_formulas_of_the_textbook(airspeed_mps: float, modes: dict[float, Modes]) -> None:
    ours = modes[airspeed_mps]
    theirs = textbook(trimmed(airspeed_mps))
    assert abs(ours.short_period - theirs.short_period) < 0.02 * abs(theirs.short_period)
    assert ours.roll == pytest.approx(theirs.roll, rel=0.02)
    assert abs(ours.dutch_roll - theirs.dutch_roll) < 0.02 * abs(theirs.dutch_roll)
    assert ours.spiral == pytest.approx(theirs.spiral, abs=0.01)
    assert abs(ours.phugoid) == pytest.approx(abs(theirs.phugoid), rel=0.05)


# the specification


def below_level_1(modes: Modes) -> set[str]:
    """MIL-F-8785C, sections 3.2.1.2, 3.2.2.1.2 and 3.3.1.1 to 3.3.1.3: the modes that miss it."""
    dutch_roll = modes.dutch_roll
    met = {
        "short period": 0.3 < damping(modes.short_period) < 2.0,
        "phugoid": damping(modes.phugoid) > 0.04,
        "Dutch roll": damping(dutch_roll) > 0.08 and -dutch_roll.real > 0.15 and abs(dutch_roll) > 0.4,
        "roll": -1.0 / modes.roll < 1.4,
        "spiral": modes.spiral < math.log(2.0) / 20.0,  # doubles in 20 s at the soonest
    }
    return {mode for mode, good in met.items() if not good}


@pytest.mark.parametrize("airspeed_mps", AIRSPEEDS_MPS)
def test_level_1_flying_qualities(airspeed_mps: float, modes: dict[float, Modes]) -> None:
    assert below_level_1(modes[airspeed_mps]) == set()


def test_what_the_departures_are_for() -> None:
    assert below_level_1(modes_of(PUBLISHED_LONGITUDINAL, PUBLISHED_LATERAL)) == {"spiral"}
