"""What distinguishes one firmware's fences from the other's: their limits, and what is done and said."""

from __future__ import annotations

from abc import ABC, abstractmethod
from math import inf
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.control import FenceControl
    from mavstack.sim.autopilot.fence.limits import Breach, FenceLimits
    from mavstack.sim.autopilot.interfaces import Autopilot


class FenceRules(ABC):
    """One firmware's fences on one vehicle."""

    def __init__(self, autopilot: Autopilot) -> None:
        self.autopilot = autopilot
        self.vehicle = autopilot.vehicle

    @abstractmethod
    def limits(self, watch: FenceControl) -> FenceLimits:
        """What counts just now."""

    @abstractmethod
    def breached(self, watch: FenceControl, new: Breach) -> None:
        """A limit was just broken: say so and act."""

    def worsened(self, watch: FenceControl) -> None:  # noqa: B027 (not every firmware has something to say)
        """The vehicle goes farther beyond, for all that was done."""

    def cleared(self, watch: FenceControl) -> None:  # noqa: B027 (not every firmware has something to say)
        """All is well again: say so."""

    def replaced(self, watch: FenceControl) -> None:  # noqa: B027 (not every firmware has something to say)
        """There is another fence: say so."""

    @abstractmethod
    def problems(self, watch: FenceControl) -> Iterator[str]:
        """Why the vehicle may not be armed where it stands."""

    def number(self, name: str, default: float = 0.0) -> float:
        """A parameter; `default` if it is none, or no number."""
        value = float(self.vehicle.parameters.get(name, default))
        return value if abs(value) < inf else default
