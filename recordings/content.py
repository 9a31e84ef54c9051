"""What a recording's file holds before it is understood, whatever its format."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class Content:
    """What was found, by topic in the order written.

    `messages`: protobuf payloads. `types`: full name of the message type. `columns`: sampled topics that
    were stored as columns, dtype as in `FixedLayout.values`. `damage`: what ended it early or is lost of it,
    empty if nothing. `samples_before_damage`: how many samples came before a part that is lost, where the
    file goes on behind it.
    """

    messages: dict[str, list[bytes]]
    types: dict[str, str]
    metadata: dict[str, dict[str, str]]
    attachments: dict[str, bytes]
    damage: str
    columns: dict[str, NDArray[np.void]] = field(default_factory=dict)
    samples_before_damage: int | None = None
