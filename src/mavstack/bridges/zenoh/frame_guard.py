"""Packets from Zenoh for one vehicle: which of them are passed on. Without input and output.

A packet passes if the role of the bridge allows its message, if it is for this vehicle or for all, and if it
is fresh: one that steers at most half a second late, any other at most two. Each refusal is counted.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Final

from mavstack.bridges.core.freshness import Freshness
from mavstack.dialects import common
from mavstack.security.roles import Role, RoleFilter
from mavstack.services import message_ids, target_of
from mavstack.wire import Parser

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from mavstack._core import HasCoreDialect
    from mavstack.wire import Packet

#: Maximum delay in seconds of a packet that steers the vehicle.
MAX_STEERING_AGE: Final = 0.5
#: Maximum delay in seconds of any other packet.
MAX_AGE: Final = 2.0
#: Messages that steer the vehicle or replace a sensor: it is safer to drop an old one than to forward it.
STEERING: Final = message_ids(
    common.SetPositionTargetLocalNed,
    common.SetPositionTargetGlobalInt,
    common.SetAttitudeTarget,
    common.SetActuatorControlTarget,
    common.ManualControl,
    common.RcChannelsOverride,
    common.FollowTarget,
    common.LandingTarget,
    common.VisionPositionEstimate,
    common.VisionSpeedEstimate,
    common.GlobalVisionPositionEstimate,
    common.ViconPositionEstimate,
    common.AttPosMocap,
    common.Odometry,
    common.GpsInput,
    common.ObstacleDistance,
)


class FrameGuard:
    """The packets for one vehicle.

    Args:
        system: Its system id; None: any vehicle.
        role: The role of the bus.
        dialect: The dialect of the connection.
    """

    def __init__(self, system: int | None, role: Role, dialect: HasCoreDialect) -> None:
        #: Refused packets by the reason.
        self.refused: Counter[str] = Counter()
        #: The number of packets that passed.
        self.accepted = 0
        self._system = system
        self._freshness = Freshness()
        # The same parser finds and checks the packets: a second parser could find other packets in the same
        # bytes.
        self._packets: Callable[[bytes], Iterable[Packet]] = (
            Parser(dialect).feed if role is Role.ADMINISTER else RoleFilter(role).packets
        )

    def accept(self, data: bytes, source: str, stamp: float | None, now: float) -> list[Packet]:
        """Return the packets of a sample that are passed on.

        Args:
            data: The sample.
            source: The name of the clock of its time.
            stamp: Its time in seconds; None: it has none, so nothing in it may steer.
            now: The local time in seconds.
        """
        age = None if stamp is None else self._freshness.age(source, stamp, now)
        passed = [packet for packet in self._packets(data) if self._passes(packet, age)]
        self.accepted += len(passed)
        return passed

    def _passes(self, packet: Packet, age: float | None) -> bool:
        reason = self._refusal(packet, age)
        if reason:
            self.refused[reason] += 1
        return not reason

    def _refusal(self, packet: Packet, age: float | None) -> str:
        if self._system is not None:
            if packet.system == self._system:
                return "has the ids of the vehicle"
            if packet.message is not None and target_of(packet.message).system not in (0, self._system):
                return "is for another vehicle"
        steers = packet.message_id in STEERING
        if steers and (age is None or age > MAX_STEERING_AGE):
            return "steers and is late"
        return "is late" if age is not None and age > MAX_AGE else ""
