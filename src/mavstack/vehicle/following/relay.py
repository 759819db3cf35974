"""The leader's motion, sent on to its followers: FOLLOW_TARGET and GLOBAL_POSITION_INT.

Followers on other radios do not receive the leader, and no firmware sends FOLLOW_TARGET by itself, so this
program sends both with its own system id, as ground stations do. The heading in them is the leader's course
over ground, which turns at a limited rate: a vehicle in wind points elsewhere than it moves. Times are the
leader's, since followers extrapolate by them and need a clock that advances evenly.
"""

from __future__ import annotations

from math import cos, radians, sin
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.dialects import common
from mavstack.swarm.leader import LeaderFrame

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.dialects import Message
    from mavstack.geodesy import LocalFrame
    from mavstack.swarm.arrays import Points

#: The largest turning rate of the course, in degrees per second.
TURN_RATE: Final = 45.0
#: `est_capabilities` of FOLLOW_TARGET: position, velocity, attitude.
_CAPABILITIES: Final = 1 | 2 | 8
_UNKNOWN_HEADING: Final = 65_535


class LeaderMotion:
    """Follows the leader's positions, and makes the messages about them.

    Args:
        frame: A local frame near the leader, with its origin at height 0 above the sea.
    """

    def __init__(self, frame: LocalFrame) -> None:
        self._frame = frame
        self._leader: LeaderFrame | None = None
        self._last: common.GlobalPositionInt | None = None
        self._sent_at: int | None = None

    @property
    def course(self) -> float:
        """The course in degrees; the heading before the leader moves."""
        return 0.0 if self._leader is None else self._leader.course

    def update(self, message: common.GlobalPositionInt, now: float) -> None:
        """Take a position of the leader.

        Args:
            message: The position.
            now: Seconds.
        """
        north, east, down = self._frame.to_local(message.lat / 1e7, message.lon / 1e7, message.alt / 1e3)
        if self._leader is None:
            heading = 0.0 if message.hdg == _UNKNOWN_HEADING else message.hdg / 100.0
            self._leader = LeaderFrame(heading, TURN_RATE)
        velocity = np.array((message.vx, message.vy, -message.vz)) / 100.0
        self._leader.update(np.array((north, east, -down)), velocity, now)
        self._last = message

    def slot(self, offset: tuple[float, float, float], now: float) -> Points:
        """Return the place of a follower in metres north, east, up of the frame."""
        if self._leader is None:
            return np.full(3, np.nan)
        places, _ = self._leader.slots(np.array([offset]), now)
        found: Points = places[0]
        return found

    def messages(self, now: float) -> Iterator[Message]:
        """Yield the messages about a position that was not sent yet.

        Args:
            now: Seconds.
        """
        last = self._last
        if last is None or last.time_boot_ms == self._sent_at:
            return
        self._sent_at = last.time_boot_ms
        self.slot((0.0, 0.0, 0.0), now)  # called to turn the course up to the present time
        half = radians(self.course) / 2.0
        yield common.FollowTarget(
            timestamp=last.time_boot_ms,
            est_capabilities=_CAPABILITIES,
            lat=last.lat,
            lon=last.lon,
            alt=last.alt / 1e3,
            vel=(last.vx / 100.0, last.vy / 100.0, last.vz / 100.0),
            attitude_q=(cos(half), 0.0, 0.0, sin(half)),
        )
        yield last.replace(hdg=round(self.course * 100.0) % 36_000)
