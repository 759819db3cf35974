"""A member of a swarm: one vehicle in the common frame of all.

The frame is metres north, east and up of an origin on the ground. Each vehicle measures its height above
its own home, so heights are converted by the difference of both references above mean sea level.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.dialects import common
from mavstack.errors import ContactLost, RemoteError
from mavstack.services.setpoints import GlobalSetpoint, LocalSetpoint

if TYPE_CHECKING:
    from mavstack.geodesy import LocalFrame
    from mavstack.swarm.arrays import Points
    from mavstack.vehicle.guided_session import GuidedSession
    from mavstack.vehicle.vehicle import Vehicle

    #: A position and a velocity, in metres and m/s north, east, up.
    State = tuple[Points, Points]

#: The lowest height of a member in metres above home.
LOWEST_SLOT: Final = 2.0
#: Seconds for which a vehicle keeps its velocity after the last setpoint (ArduPilot's GUID_TIMEOUT; 1 s on
#: PX4).
_KEEPS_VELOCITY: Final = 3.0
#: Rate of positions and of setpoints, in hertz.
RATE: Final = 10.0
#: Seconds for which a position is extrapolated with the velocity.
_EXTRAPOLATION: Final = 1.0
#: Seconds in which a vehicle that seems lost must send a heartbeat.
_HEARTBEAT_TIMEOUT: Final = 3.0


class Member:
    """A vehicle in the frame of its swarm.

    Args:
        vehicle: The vehicle.
        frame: The frame of the swarm.
    """

    def __init__(self, vehicle: Vehicle, frame: LocalFrame) -> None:
        self.vehicle = vehicle
        self.error: RemoteError | None = None
        self._frame = frame
        self._session: GuidedSession | None = None

    @property
    def age(self) -> float:
        """Seconds since the last position was received; infinite before the first one."""
        age = self.vehicle.age(common.GlobalPositionInt)
        return math.inf if age is None else age

    @property
    def is_following(self) -> bool:
        """True while the vehicle follows setpoints."""
        return self._session is not None and self.error is None

    def state(self) -> State:
        """Return position and velocity now, metres and m/s north, east, up; NaN if unknown."""
        message = self.vehicle.latest(common.GlobalPositionInt)
        if message is None:
            return np.full(3, math.nan), np.zeros(3)
        north, east, down = self._frame.to_local(message.lat / 1e7, message.lon / 1e7, message.alt / 1e3)
        velocity = np.array((message.vx, message.vy, -message.vz)) / 100.0
        return np.array((north, east, -down)) + min(self.age, _EXTRAPOLATION) * velocity, velocity

    async def enter(self) -> None:
        """Let the vehicle follow setpoints, from where it is.

        Raises:
            ActionRefused: The vehicle is not armed.
            ActionUnsupported: It does not follow such setpoints.
            CommandDenied: It refused.
            RemoteTimeout: It did not answer.
        """
        session = self.vehicle.guided(RATE)
        try:
            await session.__aenter__()
        except ContactLost:  # contact is lost, or the program was blocked: a heartbeat shows which
            await self.vehicle.wait_for_message(common.Heartbeat, timeout=_HEARTBEAT_TIMEOUT)
            session = self.vehicle.guided(RATE)
            await session.__aenter__()
        self._session = session

    async def leave(self) -> None:
        """Let the vehicle hold where it is, and send no more setpoints."""
        session, self._session = self._session, None
        if session is not None:
            await session.__aexit__(type(self.error) if self.error else None, self.error, None)

    def follow(self, place: Points, velocity: Points) -> None:
        """Send a setpoint; a vehicle that does not follow any more keeps its `error`.

        A vehicle whose heartbeats are late is not given up: its last setpoint is streamed on, and it gets new
        ones as soon as it is received again. A program that a busy machine held up for some seconds finds all
        vehicles late at once.

        Args:
            place: Metres north, east, up; NaN: the velocity alone.
            velocity: North, east, up in m/s.
        """
        if self._session is None or self.error is not None:
            return
        try:
            self._session.set(self._setpoint(place, velocity))
        except ContactLost:
            return
        except RemoteError as error:
            self.error = error

    def _setpoint(self, place: Points, velocity: Points) -> GlobalSetpoint | LocalSetpoint:
        message = self.vehicle.latest(common.GlobalPositionInt)
        north_speed, east_speed, up_speed = (float(each) for each in velocity)
        if message is not None:
            up_speed = max(up_speed, _lowest_speed(message.relative_alt / 1e3))
        motion = (north_speed, east_speed, 0.0 - up_speed)
        if np.isnan(place).any():
            return LocalSetpoint(velocity=motion)
        north, east, up = (float(each) for each in place)
        latitude, longitude, altitude = self._frame.to_global(north, east, -up)
        home = 0.0 if message is None else (message.alt - message.relative_alt) / 1e3
        return GlobalSetpoint(latitude, longitude, altitude - home, velocity=motion)


def _lowest_speed(height: float) -> float:
    """Return the vertical speed at which a vehicle whose program ends now does not reach the ground."""
    return min(LOWEST_SLOT - height, 0.0) / _KEEPS_VELOCITY
