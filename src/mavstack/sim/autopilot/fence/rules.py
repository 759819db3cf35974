"""What distinguishes one firmware's fences from the other's: their limits, and what is done and said."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from enum import IntFlag
from math import inf
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.autopilot import Autopilot
    from mavstack.sim.autopilot.fence.watch import FenceWatch


class Breach(IntFlag):
    """What of a fence is broken, by the bits that ArduPilot's parameters use."""

    NONE = 0
    HIGH = 1
    RADIUS = 2
    SHAPES = 4
    LOW = 8


@dataclass(frozen=True, slots=True)
class FenceLimits:
    """What counts just now; metres above home and from home."""

    watched: Breach = Breach.NONE
    highest: float = inf
    lowest: float = -inf
    radius: float = inf
    union: bool = False
    #: Nearer to a line than this is beyond it.
    margin: float = 0.0


class FenceRules(ABC):
    """One firmware's fences on one vehicle."""

    def __init__(self, autopilot: Autopilot) -> None:
        self.autopilot = autopilot
        self.vehicle = autopilot.vehicle

    @abstractmethod
    def limits(self, watch: FenceWatch) -> FenceLimits:
        """What counts just now."""

    @abstractmethod
    def breached(self, watch: FenceWatch, new: Breach) -> None:
        """A limit was just broken: say so and act."""

    def worsened(self, watch: FenceWatch) -> None:  # noqa: B027 (not every firmware has something to say)
        """The vehicle goes farther beyond, for all that was done."""

    def cleared(self, watch: FenceWatch) -> None:  # noqa: B027 (not every firmware has something to say)
        """All is well again: say so."""

    def replaced(self, watch: FenceWatch) -> None:  # noqa: B027 (not every firmware has something to say)
        """There is another fence: say so."""

    @abstractmethod
    def problems(self, watch: FenceWatch) -> Iterator[str]:
        """Why the vehicle may not be armed where it stands."""

    def number(self, name: str, default: float = 0.0) -> float:
        """A parameter; `default` if it is none, or no number."""
        value = float(self.vehicle.parameters.get(name, default))
        return value if abs(value) < inf else default
