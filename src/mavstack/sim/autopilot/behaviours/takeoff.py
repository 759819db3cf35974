"""Takeoff: vertical, or as a wing with power and a raised nose."""

from __future__ import annotations

from math import radians
from typing import TYPE_CHECKING

from mavstack.sim.autopilot.behaviour import Behaviour
from mavstack.sim.autopilot.behaviours.steps import transition
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot


#: Pitch in radians of a wing's takeoff, and the height in metres up to which the wing keeps its course.
_PITCH = radians(13)
_STRAIGHT = 15.0
#: Altitude error in metres and vertical speed in m/s at which a takeoff is complete.
_REACHED, _SLOW = 0.5, 0.15
_WING_REACHED = 3.0


class Takeoff(Behaviour):
    """Climb by `altitude` metres, or to `down` in local metres, and stay there.

    With `forward` a VTOL continues in forward flight. Vehicles that cannot fly hold their position.
    """

    def __init__(
        self,
        autopilot: SimulatedAutopilot,
        altitude: float | None = None,
        *,
        down: float | None = None,
        yaw: float | None = None,
        forward: bool = False,
    ) -> None:
        super().__init__(autopilot)
        self.altitude = altitude
        self._down = down
        self._yaw = yaw
        self._forward = forward

    def fly(self) -> Iterator[None]:
        """Run until the altitude is reached."""
        kind = self.autopilot.vehicle.vehicle_type
        if not kind.flies:
            self.autopilot.maneuvers.hold()
            return
        self.taking_off = True
        if kind is VehicleType.PLANE:
            yield from self._run_and_climb(self._target())
        else:
            yield from self._rise(self._target())
        self.taking_off = False

    def _target(self) -> float:
        """Return the target in local metres; never below the current altitude."""
        autopilot = self.autopilot
        here = autopilot.maneuvers.place[2]
        ground = here if autopilot.landed else autopilot.home_position[2]
        altitude = autopilot.flight_parameters.takeoff_altitude if self.altitude is None else self.altitude
        return min(here, ground - altitude if self._down is None else self._down)

    def _rise(self, down: float) -> Iterator[None]:
        autopilot = self.autopilot
        north, east, _ = autopilot.maneuvers.place
        yield from transition(autopilot, forward=False)
        yaw = autopilot.body.estimate.yaw if self._yaw is None else self._yaw
        autopilot.maneuvers.go_to((north, east, down), yaw=yaw)
        while autopilot.landed or not self._is_up(down):
            yield
        if self._forward:
            yield from transition(autopilot, forward=True)
            autopilot.maneuvers.hold((north, east, down))

    def _is_up(self, down: float) -> bool:
        """Return whether the vehicle is at the target and no longer climbing."""
        here = self.autopilot.body.estimate
        return abs(here.down - down) <= _REACHED and abs(here.velocity_down) <= _SLOW

    def _run_and_climb(self, down: float) -> Iterator[None]:
        """Roll, raise the nose, and climb with level wings; turns begin at a safe height."""
        autopilot, body = self.autopilot, self.autopilot.body
        north, east, ground = autopilot.maneuvers.place
        course = body.estimate.yaw
        if autopilot.landed:
            body.hold_attitude(0.0, 0.0, course, 1.0)
            while body.on_ground and body.airspeed < body.limits.airspeed_min:
                yield
            body.hold_attitude(0.0, _PITCH, course, 1.0)
            straight = max(down, ground - _STRAIGHT)
            while autopilot.maneuvers.place[2] > straight:
                yield
        autopilot.maneuvers.fly_on(course, down=down)
        while autopilot.maneuvers.place[2] > down + _WING_REACHED:
            yield
        autopilot.maneuvers.hold((north, east, down))
