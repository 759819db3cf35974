"""Coming down without knowing where: PX4's Descend, which replaces what needs a position that is lost."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.sim.autopilot.behaviour import Behaviour
from mavstack.sim.autopilot.behaviours.steps import ClimbControl, transition

if TYPE_CHECKING:
    from collections.abc import Iterator

#: A wing glides in a gentle bank, so that it stays in the neighbourhood.
_BANK, _NOSE_DOWN = 0.26, -0.05


class Descend(Behaviour):
    """Level, down at landing speed, until it is on the ground."""

    landing = True

    def fly(self) -> Iterator[None]:
        """Until it is down."""
        autopilot = self.autopilot
        if not autopilot.vehicle.type.flies:
            yield from self._drift()
        if autopilot.maneuvers.circles and autopilot.vehicle.type.flies:
            yield from self._glide()
        climb = ClimbControl(autopilot)
        while not autopilot.landed:
            thrust = climb.thrust(-autopilot.flight_parameters.land_speed)
            autopilot.body.hold_attitude(0.0, 0.0, None, thrust, yaw_rate=0.0)
            yield
        autopilot.body.idle()
        while True:
            yield

    def _drift(self) -> Iterator[None]:
        """What need not come down only stops its motors."""
        self.autopilot.body.idle()
        while True:
            yield

    def _glide(self) -> Iterator[None]:
        """What has no motors to hover on comes down gliding; a VTOL hovers first."""
        yield from transition(self.autopilot, forward=False)
        while self.autopilot.maneuvers.circles and not self.autopilot.landed:
            self.autopilot.body.hold_attitude(_BANK, _NOSE_DOWN, None, 0.0, yaw_rate=0.0)
            yield


class Nothing(Behaviour):
    """Motors off: the flight was terminated."""

    def fly(self) -> Iterator[None]:
        """For ever."""
        self.autopilot.body.stop()
        while True:
            yield
