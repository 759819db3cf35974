"""Staying where it is: at a point, on a circle around it, or at rest on the ground."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.sim.autopilot.behaviour import Behaviour
from mavstack.sim.autopilot.behaviours.steps import become, stay_landed

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.interfaces import Autopilot


class Brake(Behaviour):
    """Stop and stay, whatever anybody wants; a wing circles."""

    def __init__(self, autopilot: Autopilot, *, forward: bool | None = None) -> None:
        super().__init__(autopilot)
        self._forward = forward

    def fly(self) -> Iterator[None]:
        """For ever."""
        while True:
            yield from stay_landed(self.autopilot)
            yield from become(self.autopilot, self._forward)
            self.autopilot.maneuvers.hold()
            while not (self.autopilot.landed and self.autopilot.vehicle.type.flies):
                yield


class Stop(Behaviour):
    """Motors at rest: a rover or a boat rolls out and is then wherever it is."""

    def fly(self) -> Iterator[None]:
        """For ever."""
        self.autopilot.body.idle()
        while True:
            yield
