"""What can be wrong with an aircraft or a path for it."""


class AircraftError(ValueError):
    """Base of all errors of this package; the message names the value, the limit and the remedy."""


class ModelError(AircraftError):
    """A model that JSBSim cannot load, trim or that lacks a property."""


class PathError(AircraftError):
    """Waypoints that no flyable path can be laid through."""
