"""Flying to what others say: commands and setpoints through `autopilot.guided`.

Guided    follows both; so ArduPilot's GUIDED
Hold      stays where it is until a command says where else; so PX4's Hold, which DO_REPOSITION moves
Offboard  follows setpoints while their stream lives; when it starves, the firmware says what follows
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.sim.autopilot.behaviour import Behaviour
from mavstack.sim.autopilot.behaviours.guided_commands import GuidedCommand
from mavstack.sim.autopilot.behaviours.steps import become
from mavstack.sim.autopilot.behaviours.takeoff import Takeoff

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.control import RunningBehaviour
    from mavstack.sim.autopilot.interfaces import Autopilot

_ENDED = object()


class Guided(Behaviour):
    """Fly after the newest aim; without one, stay. On the ground only a take-off is followed."""

    takes_setpoints = True

    def __init__(self, autopilot: Autopilot, *, forward: bool | None = None) -> None:
        super().__init__(autopilot)
        self._forward = forward
        autopilot.guided.clear()

    def fly(self) -> Iterator[None]:
        """For ever."""
        guided = self.autopilot.guided
        if not self.autopilot.landed:
            yield from become(self.autopilot, self._forward)
        while True:
            aim = guided.aim
            if aim is None or self._must_stay(aim):
                yield from self._rest(aim)
            else:
                yield from self._follow(aim)

    def _must_stay(self, aim: RunningBehaviour) -> bool:
        """Whether it is on the ground, and this would not have it leave it."""
        autopilot = self.autopilot
        if not (autopilot.landed and autopilot.vehicle.type.flies) or isinstance(aim, Takeoff):
            return False
        return not self._may_lift_off(aim)

    def _may_lift_off(self, aim: RunningBehaviour) -> bool:
        return False

    def _rest(self, aim: RunningBehaviour | None) -> Iterator[None]:
        """Stay until there is another aim."""
        autopilot = self.autopilot
        if autopilot.landed and autopilot.vehicle.type.flies:
            autopilot.body.idle()
            while autopilot.landed and autopilot.guided.aim is aim:
                yield
        elif autopilot.guided.aim is aim:
            yield from become(autopilot, None)
            autopilot.maneuvers.hold()
            forward = autopilot.body.flies_forward
            while autopilot.guided.aim is aim and not self._touched_down():
                if autopilot.body.flies_forward != forward:
                    return
                yield

    def _touched_down(self) -> bool:
        return self.autopilot.landed and self.autopilot.vehicle.type.flies

    def _follow(self, aim: RunningBehaviour) -> Iterator[None]:
        """Until there is another aim, or the vehicle came down."""
        guided, body = self.autopilot.guided, self.autopilot.body
        if not isinstance(aim, Takeoff):
            yield from become(self.autopilot, self._forward)
        script, forward = aim.fly(), body.flies_forward
        flying = True
        while guided.aim is aim:
            if not flying and body.flies_forward != forward:
                script, flying = aim.fly(), True
            forward = body.flies_forward
            flying = flying and next(script, _ENDED) is not _ENDED
            self.taking_off, self.landing = aim.taking_off, aim.landing
            yield
            if guided.aim is aim and self._must_stay(aim) and not aim.taking_off:
                break
        self.taking_off = self.landing = False


class Hold(Guided):
    """Stay, or go where a command says."""

    takes_setpoints = False


class Offboard(Guided):
    """Fly after the stream of setpoints."""

    def __init__(self, autopilot: Autopilot) -> None:
        super().__init__(autopilot)
        autopilot.guided.follow_stream()

    def fly(self) -> Iterator[None]:
        """While the stream lives."""
        script = super().fly()
        while self.autopilot.guided.stream_alive:
            next(script)
            yield
        self.autopilot.maneuvers.hold()
        yield  # it is over before another mode begins
        self.autopilot.profile.setpoints_lost(self.autopilot)
        while True:
            yield

    def _may_lift_off(self, aim: RunningBehaviour) -> bool:
        return isinstance(aim, GuidedCommand) and aim.lifts_off
