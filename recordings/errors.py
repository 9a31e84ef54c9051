"""What can be wrong with a recording or with limits."""


class RecordingError(ValueError):
    """Base of all errors of this package; the message names the value, the limit and the remedy."""


class BadRecordingError(RecordingError):
    """A file that is not a recording of ours, or from which nothing can be read."""


class BadLimitError(RecordingError):
    """A limit that cannot be understood."""


class BadComparisonError(RecordingError):
    """Two recordings that cannot be compared."""
