"""The limits of a fence, and which of them are broken."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntFlag
from math import inf


class Breach(IntFlag):
    """The broken limits of a fence, as the bits of ArduPilot's parameters."""

    NONE = 0
    HIGH = 1
    RADIUS = 2
    SHAPES = 4
    LOW = 8


@dataclass(frozen=True, slots=True)
class FenceLimits:
    """The limits in force: metres above home and from home."""

    watched: Breach = Breach.NONE
    highest: float = inf
    lowest: float = -inf
    radius: float = inf
    #: True if it is enough to be inside one of the inclusion shapes.
    union: bool = False
    #: A distance to an edge below this, in metres, counts as a breach.
    margin: float = 0.0
