"""The leader's motion, sent on to its followers: FOLLOW_TARGET and GLOBAL_POSITION_INT.

Followers on other radios do not receive the leader, and no firmware sends FOLLOW_TARGET by itself, so this
program sends both with its own system id, as ground stations do. The heading in them is the leader's course
over ground, which turns at a limited rate: a vehicle in wind points elsewhere than it moves. Places and times
are the leader's, advanced to the time of sending: followers extrapolate from there, by a clock that has to
advance evenly.

ArduPilot takes the leader's velocity, though in a turn a slot moves across by its offset r times the turning
rate ω. Its error is then the cross product of ω and r, divided by the gain k of its position (FOLL_POS_P). A
heading that is ahead by ω / k moves the slot by just that, which cancels this error for followers at any
offset by one message to all. The lag of the course is added to it. Only a large gain makes the angle small
enough for this.

The direction of a slow vehicle's velocity is noisy: 0.04 m/s across 1.5 m/s are 1.5 degrees, by which a slot
10 m behind it moves by 0.3 m. Vehicles that steer turn their heading with their course, and a heading is
known much better over some seconds. The course of such a leader turns with its heading, and the velocity
corrects it slowly, which takes out crab angles and errors of the compass.
"""

from __future__ import annotations

from math import cos, radians, remainder, sin
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.dialects import common
from mavstack.swarm.leader import COURSE_TIME, LeaderFrame

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
#: Time constant in seconds of the measured turning rate.
_RATE_TIME: Final = 1.0
#: Time constant in seconds with which the velocity corrects the course of a leader that steers.
_STEERED_COURSE_TIME: Final = 8.0
#: The largest angle in degrees by which a heading is ahead of the course.
_MAX_AHEAD: Final = 45.0


class LeaderMotion:
    """Follows the leader's positions, and makes the messages about them.

    Args:
        frame: A local frame near the leader, with its origin at height 0 above the sea.
        gain: The gain in 1/s by which all followers correct their positions; None: headings are the course.
        steers: True for a leader that turns its heading with its course, as rovers and boats do.
    """

    def __init__(self, frame: LocalFrame, gain: float | None = None, *, steers: bool = False) -> None:
        self._frame, self._steers = frame, steers
        self._heading: float | None = None
        #: Seconds of turning by which headings are ahead of the course.
        lag = 0.0 if steers else COURSE_TIME
        self._ahead = 0.0 if gain is None else 1.0 / gain + lag
        #: Degrees per second, smoothed.
        self._turning = 0.0
        self._measured_course = 0.0
        self._leader: LeaderFrame | None = None
        self._last: common.GlobalPositionInt | None = None
        self._received_at = 0.0
        self._measured_at: int | None = None

    @property
    def course(self) -> float:
        """The course in degrees; the heading before the leader moves."""
        return 0.0 if self._leader is None else self._leader.course

    def update(self, message: common.GlobalPositionInt, now: float) -> None:
        """Take a position of the leader.

        Args:
            message: The position.
            now: Seconds, when it was received.
        """
        north, east, down = self._frame.to_local(message.lat / 1e7, message.lon / 1e7, message.alt / 1e3)
        if self._leader is None:
            heading = 0.0 if message.hdg == _UNKNOWN_HEADING else message.hdg / 100.0
            course_time = _STEERED_COURSE_TIME if self._steers else COURSE_TIME
            self._leader = LeaderFrame(heading, TURN_RATE, course_time)
        if self._steers:
            self._turn_with_heading(self._leader, message.hdg)
        velocity = np.array((message.vx, message.vy, -message.vz)) / 100.0
        self._leader.update(np.array((north, east, -down)), velocity, now)
        self._last, self._received_at = message, now

    def _turn_with_heading(self, leader: LeaderFrame, hdg: int) -> None:
        """Turn the course by the change of the heading, which is in hundredths of a degree."""
        before, self._heading = self._heading, None if hdg == _UNKNOWN_HEADING else hdg / 100.0
        if before is not None and self._heading is not None:
            leader.turn(remainder(self._heading - before, 360.0))

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
        if last is None or last.time_boot_ms == self._measured_at:
            return
        north, east, up = self.slot(
            (0.0, 0.0, 0.0), now
        ).tolist()  # turns the course to the present time, too
        self._measure_turning(last.time_boot_ms)
        latitude, longitude, altitude = self._frame.to_global(north, east, -up)
        sent_at = last.time_boot_ms + round((now - self._received_at) * 1000.0)
        lat, lon = round(latitude * 1e7), round(longitude * 1e7)
        heading = self.course + min(max(self._ahead * self._turning, -_MAX_AHEAD), _MAX_AHEAD)
        half = radians(heading) / 2.0
        yield common.FollowTarget(
            timestamp=sent_at,
            est_capabilities=_CAPABILITIES,
            lat=lat,
            lon=lon,
            alt=altitude,
            vel=(last.vx / 100.0, last.vy / 100.0, last.vz / 100.0),
            attitude_q=(cos(half), 0.0, 0.0, sin(half)),
        )
        climbed = round(altitude * 1e3) - last.alt
        yield last.replace(
            time_boot_ms=sent_at & 0xFFFF_FFFF,
            lat=lat,
            lon=lon,
            alt=last.alt + climbed,
            relative_alt=last.relative_alt + climbed,
            hdg=round(heading * 100.0) % 36_000,
        )

    def _measure_turning(self, measured_at: int) -> None:
        """Compare the course with the one before.

        Args:
            measured_at: The time of the position in milliseconds, by the leader's clock.
        """
        if self._measured_at is not None:
            step = (measured_at - self._measured_at) / 1000.0
            rate = remainder(self.course - self._measured_course, 360.0) / step
            self._turning += (rate - self._turning) * min(1.0, max(step, 0.0) / _RATE_TIME)
        self._measured_at, self._measured_course = measured_at, self.course
