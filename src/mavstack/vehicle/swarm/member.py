"""A member of a swarm: one vehicle, and the session in which it follows setpoints."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import ContactLost, RemoteError

if TYPE_CHECKING:
    from mavstack.vehicle.guided_session import GuidedSession
    from mavstack.vehicle.vehicle import Vehicle

#: Rate of positions and of setpoints, in hertz.
RATE: Final = 10.0
#: Seconds in which a vehicle that seems lost must send a heartbeat.
_HEARTBEAT_TIMEOUT: Final = 3.0


class Member:
    """A vehicle of a swarm.

    Args:
        vehicle: The vehicle.
    """

    def __init__(self, vehicle: Vehicle) -> None:
        self.vehicle = vehicle
        #: The system id, and the address of the autopilot.
        self.system, self.address = vehicle.system, vehicle.address
        #: True if the firmware adds the acceleration of a setpoint to its own.
        self.follows_acceleration = vehicle.telemetry.firmware.FOLLOWS_ACCELERATION
        #: Returns its latest position and the time of its arrival; None if there is none.
        self.read_position = vehicle.telemetry.reader(common.GlobalPositionInt)
        #: The reason why it does not follow setpoints any more; None: it follows.
        self.error: RemoteError | None = None
        self._session: GuidedSession | None = None

    @property
    def is_following(self) -> bool:
        """True while the vehicle follows setpoints."""
        return self._session is not None and self.error is None

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

    async def leave(self, ended_by: BaseException | None) -> None:
        """Let the vehicle hold where it is, and send no more setpoints.

        Args:
            ended_by: The error that ended the flight of the swarm, which is raised instead of a refusal.
        """
        session, self._session = self._session, None
        if session is not None:
            error = self.error or ended_by
            await session.__aexit__(type(error) if error else None, error, None)

    def take_over(self) -> None:
        """End the stream of the session, since the fleet sends the setpoints."""
        if self._session is not None:
            self._session.stop_stream()

    def check(self) -> None:
        """Keep an `error` if the vehicle does not follow setpoints any more.

        A vehicle whose heartbeats are late is not given up: it stays at its last setpoint, and gets new ones
        as soon as it is received again. A program that a busy machine held up for some seconds finds all
        vehicles late at once.
        """
        if self._session is None or self.error is not None:
            return
        try:
            self._session.check()
        except ContactLost:
            return
        except RemoteError as error:
            self.error = error
