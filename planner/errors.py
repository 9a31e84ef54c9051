"""What can be wrong with a planning problem."""


class PlannerError(ValueError):
    """Base of all errors of this package; the message names the value, the limit and the remedy."""


class OutsideGridError(PlannerError):
    """A position or a cell lies off the grid."""


class OutsideFieldError(PlannerError):
    """Wind was asked for outside the field's time, height or area."""


class BadFieldError(PlannerError):
    """Arrays that disagree in shape, or values that are not finite."""


class BadPlanError(PlannerError):
    """A plan file that cannot be read, or a plan that makes no sense."""
