"""The differences between the fences of the firmwares: limits, reactions and status texts."""

from __future__ import annotations

from abc import ABC, abstractmethod
from math import inf
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.fence import FenceWatch
    from mavstack.sim.autopilot.fence_limits import Breach, FenceLimits


class FenceRules(ABC):
    """The fence rules of one firmware on one vehicle."""

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        self.autopilot = autopilot
        self.vehicle = autopilot.vehicle

    @abstractmethod
    def limits(self, watch: FenceWatch) -> FenceLimits:
        """Return the limits in force."""

    @abstractmethod
    def breached(self, watch: FenceWatch, new: Breach) -> None:
        """React to a new breach, and send its text."""

    def worsened(self, watch: FenceWatch) -> None:  # noqa: B027 (not every firmware has something to say)
        """React to a vehicle that flies further beyond the fence."""

    def cleared(self, watch: FenceWatch) -> None:  # noqa: B027 (not every firmware has something to say)
        """Send the text of a cleared breach."""

    def replaced(self, watch: FenceWatch) -> None:  # noqa: B027 (not every firmware has something to say)
        """React to a new fence plan."""

    @abstractmethod
    def problems(self, watch: FenceWatch) -> Iterator[str]:
        """Yield why the vehicle may not be armed where it is."""

    def number(self, name: str, default: float = 0.0) -> float:
        """Return a parameter; `default` if it is missing or not finite."""
        value = float(self.vehicle.parameters.get(name, default))
        return value if abs(value) < inf else default
