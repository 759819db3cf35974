"""The differences between the fences of the firmwares: limits, reactions and status texts."""

from __future__ import annotations

from abc import ABC, abstractmethod
from math import inf
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.control import FenceControl
    from mavstack.sim.autopilot.fence_limits import Breach, FenceLimits
    from mavstack.sim.autopilot.interfaces import Autopilot


class FenceRules(ABC):
    """The fence rules of one firmware on one vehicle."""

    def __init__(self, autopilot: Autopilot) -> None:
        self.autopilot = autopilot
        self.vehicle = autopilot.vehicle

    @abstractmethod
    def limits(self, watch: FenceControl) -> FenceLimits:
        """Return the limits in force."""

    @abstractmethod
    def breached(self, watch: FenceControl, new: Breach) -> None:
        """React to a new breach, and send its text."""

    def worsened(self, watch: FenceControl) -> None:  # noqa: B027 (not every firmware has something to say)
        """React to a vehicle that flies further beyond the fence."""

    def cleared(self, watch: FenceControl) -> None:  # noqa: B027 (not every firmware has something to say)
        """Send the text of a cleared breach."""

    def replaced(self, watch: FenceControl) -> None:  # noqa: B027 (not every firmware has something to say)
        """React to a new fence plan."""

    @abstractmethod
    def problems(self, watch: FenceControl) -> Iterator[str]:
        """Yield why the vehicle may not be armed where it is."""

    def number(self, name: str, default: float = 0.0) -> float:
        """Return a parameter; `default` if it is missing or not finite."""
        value = float(self.vehicle.parameters.get(name, default))
        return value if abs(value) < inf else default
