"""The vehicles of a swarm as arrays: their positions are read and their setpoints are sent in one step.

The frame is metres north, east and up of an origin on the ground. Heights are sent above mean sea level, as
they are received: each vehicle has its own home, and PX4 (1.17) adds the difference between its home and
its local origin with the wrong sign to heights above home.

Positions are read from the latest GLOBAL_POSITION_INT, extrapolated with the velocity. A setpoint is a place
with a velocity (SET_POSITION_TARGET_GLOBAL_INT), and with an acceleration if the firmware adds it to its own,
or a velocity alone (SET_POSITION_TARGET_LOCAL_NED) where the place is NaN. A member that gets no new
setpoint, since its positions are late, gets its last one again, since PX4 leaves its mode half a second after
the last setpoint; but without a velocity, so that the member stops.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.dialects import common
from mavstack.node.host import host_of
from mavstack.services.setpoints.batch import SetpointBatch
from mavstack.swarm.frame import to_global, to_local

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Any, Self

    import numpy.typing as npt

    from mavstack.geodesy import LocalFrame
    from mavstack.services.setpoints.batch import SetpointMessage
    from mavstack.swarm.arrays import Points
    from mavstack.vehicle.swarm.member import Member

#: The lowest height of a member in metres above home.
LOWEST_SLOT: Final = 2.0
#: Seconds for which a vehicle keeps its velocity after the last setpoint (ArduPilot's GUID_TIMEOUT; 1 s on
#: PX4).
_KEEPS_VELOCITY: Final = 3.0
#: Seconds for which a position is extrapolated with the velocity.
_EXTRAPOLATION: Final = 1.0
#: Each member is checked once in this number of steps: modes and heartbeats are reported once a second.
_CHECK_STEPS: Final = 5
_MASK: Final = common.PositionTargetTypemask
_NO_YAW: Final = int(_MASK.YAW_IGNORE | _MASK.YAW_RATE_IGNORE)
_NO_ACCELERATION: Final = _NO_YAW | int(_MASK.AX_IGNORE | _MASK.AY_IGNORE | _MASK.AZ_IGNORE)
_VELOCITY: Final = _NO_ACCELERATION | int(_MASK.X_IGNORE | _MASK.Y_IGNORE | _MASK.Z_IGNORE)
_GLOBAL: Final = int(common.MavFrame.GLOBAL_INT)
_LOCAL: Final = int(common.MavFrame.LOCAL_NED)
#: The axes of the wire are north, east, down.
_NED: Final = (1.0, 1.0, -1.0)
_STEADY: Final = (0.0, 0.0, 0.0)
#: The values of a vehicle whose position is not known.
_UNKNOWN: Final = (-np.inf, np.nan, np.nan, np.nan, np.nan, 0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Readings:
    """States of vehicles at one time.

    Attributes:
        positions: Metres north, east, up; an array of shape (n, 3), NaN if unknown.
        velocities: North, east, up in m/s.
        ages: Seconds since each position was received; infinite if none was.
        heights: Metres of each vehicle above its home; NaN if unknown.
    """

    positions: Points
    velocities: Points
    ages: Points
    heights: Points

    def take(self, indices: npt.NDArray[np.integer] | slice) -> Self:
        """Return the states of some of the vehicles."""
        return type(self)(*(getattr(self, name)[indices] for name in self.__slots__))


@dataclass(frozen=True, slots=True)
class Setpoints:
    """Setpoints of vehicles, arrays of shape (n, 3), north, east, up.

    Attributes:
        places: Metres; NaN: the velocity alone.
        velocities: m/s.
        accelerations: m/s².
    """

    places: Points
    velocities: Points
    accelerations: Points


class Fleet:
    """The members of a swarm, and how they are reached.

    Args:
        members: The members, the leader first.
        frame: The frame of the swarm.
    """

    def __init__(self, members: Sequence[Member], frame: LocalFrame) -> None:
        self.members = tuple(members)
        self._frame = frame
        self._host = host_of(members[0].vehicle.connection)
        self._batch = SetpointBatch(self._host.address)
        self._begin: float | None = None
        self._step = 0
        #: The last setpoint of each member.
        self._last: dict[Member, SetpointMessage] = {}

    def now(self) -> float:
        """Return the time in seconds."""
        return self._host.now()

    def read(self, others: Sequence[Member] = ()) -> Readings:
        """Return the states of the members, and of other vehicles after them."""
        return read_states((*self.members, *others), self._frame, self.now())

    def check(self) -> None:
        """Let members that do not follow setpoints any more keep an error; a part of them at each call."""
        for member in self.members[self._step % _CHECK_STEPS :: _CHECK_STEPS]:
            member.check()
        self._step += 1

    def send(self, members: Sequence[Member], setpoints: Setpoints, heights: Points) -> None:
        """Send setpoints to members, and the last one without its motion to others that follow.

        Args:
            members: The members with new setpoints.
            setpoints: Their setpoints.
            heights: Metres of each above its home; NaN if unknown.
        """
        for member in self._last.keys() - set(members):
            self._last[member] = _standing(self._last[member])
        messages = self._messages(members, setpoints, heights)
        for member, message in zip(members, messages, strict=True):
            if member not in self._last:
                member.take_over()
            self._last[member] = message
        self._batch.set((message, each.address) for each, message in self._last.items() if each.is_following)
        self._host.wake(self._batch)

    def open(self) -> None:
        """Begin to send setpoints."""
        self._host.serve(self._batch)

    def close(self) -> None:
        """Send no more setpoints; the sessions of the members send them again."""
        self._host.remove(self._batch)

    def _messages(
        self, members: Sequence[Member], setpoints: Setpoints, heights: Points
    ) -> list[SetpointMessage]:
        now = self.now()
        self._begin = now if self._begin is None else self._begin
        milliseconds = round((now - self._begin) * 1000.0) & 0xFFFFFFFF
        motion = setpoints.velocities.copy()
        motion[:, 2] = np.maximum(motion[:, 2], _lowest_speeds(heights))
        places = to_global(self._frame, setpoints.places)
        known = np.isfinite(places).all(axis=1)
        degrees = np.rint(np.nan_to_num(places[:, :2]) * 1e7).astype(np.int64)
        columns = (known, *degrees.T, places[:, 2], *(motion * _NED).T, *(setpoints.accelerations * _NED).T)
        rows = zip(*(column.tolist() for column in columns), strict=True)
        return [_message(member, row, milliseconds) for member, row in zip(members, rows, strict=True)]


def read_states(members: Sequence[Member], frame: LocalFrame, now: float) -> Readings:
    """Return the states of vehicles, extrapolated to the present time.

    Args:
        members: The vehicles.
        frame: The frame of the swarm.
        now: Seconds.
    """
    rows = np.fromiter(chain.from_iterable(map(_row, members)), float, 8 * len(members)).reshape(-1, 8)
    ages = np.maximum(now - rows[:, 0], 0.0)
    velocities = rows[:, 5:8] / (100.0, 100.0, -100.0)
    places = rows[:, 1:4] / (1e7, 1e7, 1e3)
    heights = rows[:, 4] / 1e3
    positions = to_local(frame, places) + np.minimum(ages, _EXTRAPOLATION)[:, None] * velocities
    return Readings(positions, velocities, ages, heights)


def _row(member: Member) -> tuple[float, ...]:
    found = member.read_position()
    if found is None:
        return _UNKNOWN
    packet, received_at = found
    message = packet.message
    if not isinstance(message, common.GlobalPositionInt):
        return _UNKNOWN
    return (
        received_at,
        message.lat,
        message.lon,
        message.alt,
        message.relative_alt,
        message.vx,
        message.vy,
        message.vz,
    )


def _message(member: Member, row: Sequence[Any], milliseconds: int) -> SetpointMessage:
    known, latitude, longitude, altitude, north, east, down, *acceleration = row
    target = member.address
    if not known:
        return common.SetPositionTargetLocalNed(
            time_boot_ms=milliseconds,
            target_system=target.system,
            target_component=target.component,
            coordinate_frame=_LOCAL,
            type_mask=_VELOCITY,
            vx=north,
            vy=east,
            vz=down,
        )
    forward, right, under = acceleration if member.follows_acceleration else _STEADY
    return common.SetPositionTargetGlobalInt(
        time_boot_ms=milliseconds,
        target_system=target.system,
        target_component=target.component,
        coordinate_frame=_GLOBAL,
        type_mask=_NO_YAW if member.follows_acceleration else _NO_ACCELERATION,
        lat_int=latitude,
        lon_int=longitude,
        alt=altitude,
        vx=north,
        vy=east,
        vz=down,
        afx=forward,
        afy=right,
        afz=under,
    )


def _standing(message: SetpointMessage) -> SetpointMessage:
    """Return a setpoint without its motion: stay at the place, or stop."""
    return message.replace(vx=0.0, vy=0.0, vz=0.0, afx=0.0, afy=0.0, afz=0.0)


def _lowest_speeds(heights: Points) -> Points:
    """Return the vertical speeds at which vehicles whose program ends now do not reach the ground."""
    lowest: Points = np.minimum(LOWEST_SLOT - heights, 0.0) / _KEEPS_VELOCITY
    return np.where(np.isnan(lowest), -np.inf, lowest)
