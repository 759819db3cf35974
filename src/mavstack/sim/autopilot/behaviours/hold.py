"""Behaviours that stay: at a point, on a circle around it, or at rest on the ground."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.sim.autopilot.behaviour import Behaviour
from mavstack.sim.autopilot.behaviours.steps import idle_on_ground, transition

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot


class Brake(Behaviour):
    """Stop and stay, ignoring commands; a wing circles."""

    def __init__(self, autopilot: SimulatedAutopilot, *, forward: bool | None = None) -> None:
        super().__init__(autopilot)
        self._forward = forward

    def fly(self) -> Iterator[None]:
        """Run until the mode is left."""
        while True:
            yield from idle_on_ground(self.autopilot)
            yield from transition(self.autopilot, self._forward)
            self.autopilot.maneuvers.hold()
            while not (self.autopilot.landed and self.autopilot.vehicle.vehicle_type.flies):
                yield


class Stop(Behaviour):
    """Stop the motors: a rover or a boat rolls out."""

    def fly(self) -> Iterator[None]:
        """Run until the mode is left."""
        self.autopilot.body.idle()
        while True:
            yield
