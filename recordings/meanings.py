"""What each field of our messages means, and its unit: the words of `recordings.schema`."""

from __future__ import annotations

_UNITS = {"m": "m", "s": "s", "mps": "m/s", "rad": "rad", "radps": "rad/s", "kg": "kg"}
"""By the suffix of a name."""

_UNITS_OF = (
    dict.fromkeys(("aileron", "elevator", "rudder", "throttle"), "share of full travel")
    | dict.fromkeys(
        ("path_m", "north_m", "east_m", "length_m", "start_m", "waypoint_path_m"), "m in the plane"
    )
    | {"curvature": "1/m in the plane"}
)


def unit_of(name: str) -> str:
    """The unit of a field, empty where it has none."""
    return _UNITS_OF.get(name) or _UNITS.get(name.rpartition("_")[2], "")


MEANINGS = {
    "time_s": "since departure; negative in the lead-in",
    "lat_rad": "latitude, WGS84",
    "lon_rad": "longitude, WGS84",
    "altitude_m": "above the ellipsoid",
    "north_mps": "velocity over ground, north",
    "east_mps": "velocity over ground, east",
    "down_mps": "velocity over ground, down",
    "roll_rad": "bank, right wing down positive",
    "pitch_rad": "nose up positive",
    "heading_rad": "of the nose, clockwise from north",
    "roll_rate_radps": "about the body's forward axis",
    "pitch_rate_radps": "about the body's right axis",
    "yaw_rate_radps": "about the body's downward axis",
    "airspeed_mps": "true airspeed",
    "angle_of_attack_rad": "of the body's forward axis to the air",
    "sideslip_rad": "air from the right positive",
    "wind_north_mps": "steady wind, toward north",
    "wind_east_mps": "steady wind, toward east",
    "wind_down_mps": "steady wind, toward down",
    "gust_north_mps": "what turbulence adds to it, toward north",
    "gust_east_mps": "what turbulence adds to it, toward east",
    "gust_down_mps": "what turbulence adds to it, toward down",
    "aileron": "-1 to 1",
    "elevator": "-1 to 1",
    "rudder": "-1 to 1",
    "throttle": "0 to 1",
    "fuel_kg": "left in the tanks",
    "height_above_ground_m": "above the terrain",
    "path_m": "progress along the reference",
    "cross_track_m": "off the reference, right positive; as guidance knew it, like the other errors here",
    "altitude_error_m": "above the reference positive",
    "time_error_s": "late positive",
    "phase": "of the reference: 0 lead-in, 1 leg, 2 turn, 3 loiter",
    "command_roll_rad": "bank asked for, right wing down positive",
    "command_airspeed_mps": "true airspeed asked for",
    "command_altitude_m": "altitude asked for, above the ellipsoid",
    "command_climb_mps": "feed-forward of vertical speed, up positive",
    "origin_lat_rad": "latitude of the plane's origin",
    "origin_lon_rad": "longitude of the plane's origin",
    "north_m": "where each segment begins, north",
    "east_m": "where each segment begins, east",
    "course_rad": "at the beginning of each segment, clockwise from north",
    "curvature": "of each segment, right turn positive",
    "length_m": "of each segment",
    "start_m": "way along the reference to where each segment begins",
    "start_time_s": "when each segment is to begin, since departure",
    "end_time_s": "when each segment is to end, since departure",
    "start_altitude_m": "where each segment begins, above the ellipsoid",
    "end_altitude_m": "where each segment ends, above the ellipsoid",
    "scale": "metres in the plane for each true metre",
    "waypoint_path_m": "way along the reference to each waypoint that it passes, the plan's last ones",
    "issued_s": "from when on it counts, since departure",
    "reason": "why the plan changed, or why not, for people",
    "plan": "the new plan as plan.json has it, with what was flown of the old one; empty if unchanged",
    "stage": "counted from 0",
    "threshold_mps": "a cell is hazardous where the wind is above it at any time of the stage",
    "south_rad": "latitude of the centres of the southernmost row",
    "west_rad": "longitude of the centres of the westernmost column",
    "north_step_rad": "from a row to the next one north",
    "east_step_rad": "from a column to the next one east",
    "rows": "of cells",
    "columns": "of cells",
    "cells": "row by row from the south-west, a bit each, the highest first; the last byte filled up",
    "wind_every": "cells from one value of the wind to the next, north and east; 0 where none is recorded",
    "wind": "toward north, then toward east: row by row, 16-bit integers, low byte first, sixteenths of m/s",
    "closed": "like cells: those that are hazardous for another reason than the mean wind; empty if none is",
    "outcome": "such as arrived, crashed, fuel_out; incomplete in a recording that was repaired",
    "detail": "the same in words",
}
