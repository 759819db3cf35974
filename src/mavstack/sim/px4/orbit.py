"""PX4's Orbit mode: around the circle of the last DO_ORBIT."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.sim.autopilot.behaviours import Circle, Orbit
from mavstack.sim.autopilot.commands import number, whole

if TYPE_CHECKING:
    from mavstack.services.command import Command
    from mavstack.sim.autopilot.behaviour import Behaviour
    from mavstack.sim.autopilot.interfaces import Autopilot
    from mavstack.sim.autopilot.maneuvers import Point

_YAW = common.OrbitYawBehaviour
_SMALLEST: Final = 1.0
_FASTEST: Final = 10.0


@dataclass(frozen=True, slots=True)
class WantedOrbit:
    """A circle: radius > 0 is clockwise."""

    centre: Point
    radius: float
    speed: float | None
    yaw_behaviour: int

    @classmethod
    def read(cls, autopilot: Autopilot, command: Command, centre: Point) -> WantedOrbit:
        """What DO_ORBIT asks for; what is left out is as usual."""
        radius, speed = command.param1, abs(number(command.param2))
        if not isfinite(radius) or abs(radius) < _SMALLEST:
            radius = autopilot.flight_parameters.circle_radius
        yaw = whole(command.param3)
        if yaw not in set(_YAW):
            yaw = int(autopilot.vehicle.parameters.get("MC_ORBIT_YAW_MOD", 0))
        return cls(centre, radius, min(speed, _FASTEST) or None, yaw or 0)


def orbit_behaviour(autopilot: Autopilot, wanted: WantedOrbit | None) -> Behaviour:
    """The mode's behaviour; without a command it circles a point ahead."""
    if wanted is None:
        return Circle(autopilot)
    return Orbit(
        autopilot, wanted.centre, wanted.radius, speed=wanted.speed, yaw_behaviour=wanted.yaw_behaviour
    )
