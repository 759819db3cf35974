"""The place to land on that a companion computer reports (LANDING_TARGET).

Each firmware decides which forms of the message it takes (`ardupilot/precision_landing.py`,
`px4/precision_landing.py`), and how it lands on the place.
"""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, NamedTuple

from mavstack.dialects import common
from mavstack.services.addressing import message_ids
from mavstack.services.service import Service
from mavstack.sim.motion.obstacles import turned

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.sim.autopilot.maneuvers import Point
    from mavstack.sim.vehicle import SimulatedVehicle
    from mavstack.wire import Packet


class LandingAim(NamedTuple):
    """The place on which a landing vehicle descends.

    Attributes:
        point: Metres north, east, down.
        descends: False if the vehicle stays at a height until it is nearer.
        keeps_height: True if that is its present height; False: the height of the point.
    """

    point: Point
    descends: bool
    keeps_height: bool = True


class LandingTarget(Service):
    """Keeps the last report.

    Args:
        vehicle: The vehicle.
        read: Returns the place of a message in local metres; None if the firmware does not take it.
    """

    handles = message_ids(common.LandingTarget)

    def __init__(
        self, vehicle: SimulatedVehicle, read: Callable[[common.LandingTarget], Point | None]
    ) -> None:
        super().__init__(vehicle.address)
        self._read = read
        #: The position of the target in local metres; None before the first report.
        self.place: Point | None = None
        #: The time of the last report.
        self.received_at = -inf

    def receive(self, packet: Packet, now: float) -> bool:
        match packet.message:
            case common.LandingTarget() as message if (place := self._read(message)) is not None:
                self.place, self.received_at = place, now
        return False


def from_body(vehicle: SimulatedVehicle, seen: Point) -> Point:
    """Return a place in the axes of the body (forward, right, down) in local metres."""
    here = vehicle.body.estimate
    north, east, down = turned(seen, here.roll, here.pitch, here.yaw)
    return here.north + north, here.east + east, here.down + down
