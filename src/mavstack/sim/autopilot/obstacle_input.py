"""Obstacles that a companion computer reports (OBSTACLE_DISTANCE), beside those that the vehicle senses.

Each sector with a distance is a small obstacle at that place for a second.
"""

from __future__ import annotations

from math import cos, inf, radians, sin
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.services.addressing import message_ids
from mavstack.services.service import Service
from mavstack.sim.motion.obstacles import Cylinder

if TYPE_CHECKING:
    from mavstack.sim.vehicle import SimulatedVehicle
    from mavstack.wire import Packet

#: Seconds after which a report of obstacles is discarded.
MAX_AGE: Final = 1.0
_CENTIMETRES: Final = 100.0


class ObstacleInput(Service):
    """Keeps the obstacles of the last report."""

    handles = message_ids(common.ObstacleDistance)

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        super().__init__(vehicle.address)
        self._body = vehicle.body
        self._cylinders: list[Cylinder] = []
        self._at = float("-inf")

    def receive(self, packet: Packet, now: float) -> bool:
        match packet.message:
            case common.ObstacleDistance() as report:
                self._cylinders = list(self._read(report))
                self._at = now
        return False

    def clearance_along(self, now: float, course: float, margin: float) -> float:
        """Return the metres on a course (radians) until the body is `margin` from a reported obstacle."""
        if now - self._at > MAX_AGE:
            return inf
        truth, way = self._body.truth, (cos(course), sin(course))
        here = truth.north, truth.east, truth.down
        return min((each.clearance_along(here, way, margin) for each in self._cylinders), default=inf)

    def _read(self, report: common.ObstacleDistance) -> list[Cylinder]:
        width = radians(report.increment_f or report.increment)
        truth = self._body.truth
        first = radians(report.angle_offset)
        first += truth.yaw if report.frame == common.MavFrame.BODY_FRD else 0.0
        found = []
        for number, distance in enumerate(report.distances):
            if report.min_distance <= distance <= report.max_distance:
                metres, bearing = distance / _CENTIMETRES, first + number * width
                radius = max(metres * sin(width / 2), 0.05)
                away = metres + radius
                found.append(
                    Cylinder(
                        truth.north + away * cos(bearing), truth.east + away * sin(bearing), radius, -inf
                    )
                )
        return found
