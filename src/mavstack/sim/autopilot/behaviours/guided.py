"""Behaviours that follow commands and setpoints through `autopilot.guided`.

Guided    follows both, as ArduPilot's GUIDED
Hold      stays until a command gives another position, as PX4's Hold with DO_REPOSITION
Offboard  follows setpoints while their stream lasts; then the firmware profile decides
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.sim.autopilot.behaviour import Behaviour
from mavstack.sim.autopilot.behaviours.guided_commands import GuidedCommand
from mavstack.sim.autopilot.behaviours.steps import transition
from mavstack.sim.autopilot.behaviours.takeoff import Takeoff

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot


_ENDED = object()


class Guided(Behaviour):
    """Follow the active guided command; without one, stay. On the ground only a takeoff is followed."""

    takes_setpoints = True

    def __init__(self, autopilot: SimulatedAutopilot, *, forward: bool | None = None) -> None:
        super().__init__(autopilot)
        self._forward = forward
        autopilot.guided.clear()

    def fly(self) -> Iterator[None]:
        """Run until the mode is left."""
        guided = self.autopilot.guided
        if not self.autopilot.landed:
            yield from transition(self.autopilot, self._forward)
        while True:
            command = guided.command
            if command is None or self._must_stay(command):
                yield from self._rest(command)
            else:
                yield from self._follow(command)

    def _must_stay(self, command: Behaviour) -> bool:
        """Return whether the vehicle is on the ground and the command is no takeoff."""
        autopilot = self.autopilot
        if not (autopilot.landed and autopilot.vehicle.vehicle_type.flies) or isinstance(command, Takeoff):
            return False
        return not self._may_lift_off(command)

    def _may_lift_off(self, command: Behaviour) -> bool:
        return False

    def _rest(self, command: Behaviour | None) -> Iterator[None]:
        """Stay until there is another command."""
        autopilot = self.autopilot
        if autopilot.landed and autopilot.vehicle.vehicle_type.flies:
            autopilot.body.idle()
            while autopilot.landed and autopilot.guided.command is command:
                yield
        elif autopilot.guided.command is command:
            yield from transition(autopilot, None)
            autopilot.maneuvers.hold()
            forward = autopilot.body.flies_forward
            while autopilot.guided.command is command and not self._touched_down():
                if autopilot.body.flies_forward != forward:
                    return
                yield

    def _touched_down(self) -> bool:
        return self.autopilot.landed and self.autopilot.vehicle.vehicle_type.flies

    def _follow(self, command: Behaviour) -> Iterator[None]:
        """Run a command until there is another one, or the vehicle has come down."""
        guided, body = self.autopilot.guided, self.autopilot.body
        if not isinstance(command, Takeoff):
            yield from transition(self.autopilot, self._forward)
        script, forward = command.fly(), body.flies_forward
        flying = True
        while guided.command is command:
            if not flying and body.flies_forward != forward:
                script, flying = command.fly(), True
            forward = body.flies_forward
            flying = flying and next(script, _ENDED) is not _ENDED
            self.taking_off, self.landing = command.taking_off, command.landing
            yield
            if guided.command is command and self._must_stay(command) and not command.taking_off:
                break
        self.taking_off = self.landing = False


class Hold(Guided):
    """Stay, or go where a command says."""

    takes_setpoints = False


class Offboard(Guided):
    """Follow the stream of setpoints."""

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        super().__init__(autopilot)
        autopilot.guided.follow_stream()

    def fly(self) -> Iterator[None]:
        """Run while the stream lasts."""
        script = super().fly()
        while self.autopilot.guided.stream_alive:
            next(script)
            yield
        self.autopilot.maneuvers.hold()
        yield  # the stop takes effect in this tick; another mode begins in the next tick
        self.autopilot.profile.setpoints_lost(self.autopilot)
        while True:
            yield

    def _may_lift_off(self, command: Behaviour) -> bool:
        return isinstance(command, GuidedCommand) and command.lifts_off
