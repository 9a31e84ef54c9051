"""What can be wrong with a simulation's input."""


class SimError(ValueError):
    """Base of all errors of this package; the message names the value, the limit and the remedy."""


class WeatherError(SimError):
    """Weather that cannot be read, or that makes no sense."""


class ScenarioError(SimError):
    """A scenario that cannot be read, or that makes no sense."""


class HazardError(SimError):
    """What is hazardous besides the wind cannot be told: a file of it is missing, or makes no sense."""


class CampaignError(SimError):
    """A campaign that cannot be begun as it is asked for, or not go on."""
