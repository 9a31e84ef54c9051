"""What can be wrong with a simulation's input."""


class SimError(ValueError):
    """Base of all errors of this package; the message names the value, the limit and the remedy."""


class WeatherError(SimError):
    """Weather that cannot be read, or that makes no sense."""


class ScenarioError(SimError):
    """A scenario that cannot be read, or that makes no sense."""
