"""How rough the air is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from aircraft.errors import ModelError

# Wind at 20 ft [m/s] that goes with each probability-of-exceedance index: MIL-F-8785C calls index 3 light
# (15 kt), 4 moderate (30 kt), 6 severe (45 kt); the others lie on the line through these.
_WIND_AT_20FT_MPS = (0.0, 2.6, 5.1, 7.7, 15.4, 19.3, 23.2, 27.0)


@dataclass(frozen=True, slots=True)
class Turbulence:
    """None, or that of MIL-F-8785C with its probability-of-exceedance index, 0 (none) to 7, as severity.

    Severity 3 is light turbulence, 4 moderate, 6 severe; at 1000 m they mean gusts of 2.2, 3.2 and
    7.0 m/s (root mean square, each axis).
    """

    kind: Literal["none", "milspec"] = "none"
    severity: int = 3

    def __post_init__(self) -> None:
        if self.kind not in ("none", "milspec"):
            raise ModelError(f"there is no turbulence {self.kind!r}; use 'none' or 'milspec'")
        if self.severity not in range(len(_WIND_AT_20FT_MPS)):
            raise ModelError(
                f"turbulence severity {self.severity} is not one of 0 to 7; 3 is light, 4 moderate, 6 severe"
            )

    @property
    def wind_at_20ft_mps(self) -> float:
        """The wind near the ground that goes with this severity; it sets the turbulence below 1,000 ft."""
        return _WIND_AT_20FT_MPS[self.severity]
