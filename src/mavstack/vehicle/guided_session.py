"""Flying by setpoints: the guided mode of ArduPilot, the offboard mode of PX4.

    async with vehicle.guided() as guided:
        guided.velocity(north=2)
        await asyncio.sleep(5)

The last setpoint is streamed for as long as the block lasts, since PX4 leaves offboard mode half a second
after the stream ends and ArduPilot stops after three. The stream starts before the mode is entered, as PX4
requires. At the end of the block the vehicle is commanded to hold before the stream ends. If the
vehicle leaves the mode meanwhile, by a failsafe or a pilot, the next setpoint raises `ActionInterrupted`, and
no hold is sent, so that the pilot keeps control. If no heartbeat arrives, the next setpoint raises
`ContactLost`; after the connection was closed, `RemoteCancelled`. When an error or a cancellation ends the
block, the hold is tried for a few seconds only.

A plane cannot stop, and ignores some setpoints without a word: ArduPlane all but attitudes, PX4 on its wing
velocities. Such a setpoint raises `ActionUnsupported` before it is sent, and before the mode changes.
"""

from __future__ import annotations

import asyncio
from contextlib import suppress
from math import radians
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import ActionInterrupted, ActionUnsupported, ContactLost, RemoteCancelled, RemoteError
from mavstack.node.api_object import ReadOnly
from mavstack.rotation import from_euler
from mavstack.services.arguments import check_numbers
from mavstack.services.setpoints import AttitudeSetpoint, GlobalSetpoint, LocalSetpoint
from mavstack.vehicle.actions.preconditions import check_preconditions
from mavstack.vehicle.deadline import deadline
from mavstack.vehicle.firmware import firmware_of
from mavstack.vehicle.status_text_capture import StatusTextCapture, with_status_texts

if TYPE_CHECKING:
    from types import TracebackType
    from typing import Self

    from mavstack.services.setpoints import Setpoint
    from mavstack.vehicle.vehicle import Vehicle

#: The time for which setpoints are streamed before the mode is entered, in seconds.
STREAM_LEAD_TIME: Final = 0.6
#: Timeout in seconds of holding the position if the block ends with an error.
HOLD_TIMEOUT: Final = 5.0
#: The setpoint that makes the vehicle stay where it is.
STANDING_STILL: Final = LocalSetpoint(velocity=(0.0, 0.0, 0.0))
_OPERATION: Final = "following setpoints with"


class GuidedSession(ReadOnly):
    """A block during which a vehicle follows setpoints; made by `Vehicle.guided`.

    Every setpoint raises `ActionUnsupported` if the vehicle ignores setpoints of its type, and
    `ActionInterrupted`, `ContactLost` or `RemoteCancelled` if it does not follow any more, and
    `SetpointError` for numbers that are not finite.
    """

    def __init__(self, vehicle: Vehicle, rate: float, first: Setpoint, timeout: float | None) -> None:
        self._vehicle = vehicle
        self._stream = vehicle.component.setpoints(rate)
        self._texts: StatusTextCapture | None = None
        self._first = first
        self._timeout = timeout
        self._entered = False

    @property
    def interrupted(self) -> bool:
        """True if the vehicle has left the mode in which it follows setpoints."""
        # Of the class: a controller asks for each of hundreds of vehicles.
        mode, modes = self._vehicle.mode, self._vehicle.telemetry.firmware.modes_of("guided")
        return self._entered and modes is not None and mode is not None and mode.lower() not in modes

    def check(self) -> None:
        """Raise an error if the vehicle does not follow setpoints any more.

        Raises:
            ActionInterrupted: The vehicle left the mode.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
            SystemIdConflictError: Several vehicles use its system id, and none was chosen.
        """
        if not self._vehicle.connection.is_open:
            raise self._error(RemoteCancelled, "the connection was closed")
        if not self._vehicle.alive:
            raise self._error(ContactLost, "it fell silent")
        if self.interrupted:
            raise self._error(ActionInterrupted, f"it changed to {self._vehicle.mode}")
        self._vehicle.connection.refuse_conflict(self._vehicle.system, _OPERATION)

    def set(self, setpoint: Setpoint) -> None:
        """Follow a setpoint of any type, with NED axes as on the wire.

        Args:
            setpoint: A `LocalSetpoint`, `GlobalSetpoint` or `AttitudeSetpoint`; axes that it leaves out are
                left to the vehicle.

        Raises:
            ActionUnsupported: The vehicle ignores setpoints of this type; it was not sent.
            ActionInterrupted: The vehicle left the mode.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
        """
        firmware = firmware_of(self._vehicle)
        firmware.check_setpoint(setpoint)
        self.check()
        self._stream.set(firmware.adapt_setpoint(setpoint))

    def stop_stream(self) -> None:
        """Stop repeating the last setpoint, since the caller sends setpoints by other means.

        The next setpoint, and the end of the block, start the stream again.
        """
        self._stream.stop()

    def velocity(
        self, north: float = 0.0, east: float = 0.0, up: float = 0.0, *, yaw: float | None = None
    ) -> None:
        """Fly with a velocity (SET_POSITION_TARGET_LOCAL_NED).

        Args:
            north: Metres per second to the north.
            east: Metres per second to the east.
            up: Metres per second upwards.
            yaw: Heading in degrees; None leaves it to the vehicle.

        Raises:
            ActionInterrupted: The vehicle left the mode.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
        """
        check_numbers(finite=False, north=north, east=east, up=up, yaw=yaw)
        self.set(LocalSetpoint(velocity=(north, east, _down(up)), yaw=_radians(yaw)))

    def body_velocity(
        self, forward: float = 0.0, right: float = 0.0, up: float = 0.0, *, yaw_rate: float = 0.0
    ) -> None:
        """Fly with a velocity in the axes of the body (SET_POSITION_TARGET_LOCAL_NED in BODY_NED).

        Args:
            forward: Metres per second forwards.
            right: Metres per second to the right.
            up: Metres per second upwards.
            yaw_rate: Degrees per second, positive clockwise.

        Raises:
            ActionInterrupted: The vehicle left the mode.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
        """
        check_numbers(finite=False, forward=forward, right=right, up=up, yaw_rate=yaw_rate)
        velocity = (forward, right, _down(up))
        frame = common.MavFrame.BODY_NED
        self.set(LocalSetpoint(velocity=velocity, yaw_rate=radians(yaw_rate), frame=frame))

    def position(self, north: float, east: float, up: float, *, yaw: float | None = None) -> None:
        """Go to a position in the local frame (SET_POSITION_TARGET_LOCAL_NED).

        Args:
            north: Metres north of the origin of the vehicle's local frame.
            east: Metres east of it.
            up: Metres above it.
            yaw: Heading in degrees; None leaves it to the vehicle.

        Raises:
            ActionInterrupted: The vehicle left the mode.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
        """
        check_numbers(finite=False, north=north, east=east, up=up, yaw=yaw)
        self.set(LocalSetpoint(position=(north, east, _down(up)), yaw=_radians(yaw)))

    def goto(self, latitude: float, longitude: float, altitude: float, *, yaw: float | None = None) -> None:
        """Go to a global position (SET_POSITION_TARGET_GLOBAL_INT).

        Args:
            latitude: Degrees.
            longitude: Degrees.
            altitude: Metres above home.
            yaw: Heading in degrees; None leaves it to the vehicle.

        Raises:
            ActionInterrupted: The vehicle left the mode.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
        """
        check_numbers(finite=False, latitude=latitude, longitude=longitude, altitude=altitude, yaw=yaw)
        self.set(GlobalSetpoint(latitude, longitude, altitude, yaw=_radians(yaw)))

    def attitude(self, roll: float, pitch: float, yaw: float, thrust: float) -> None:
        """Hold an attitude (SET_ATTITUDE_TARGET).

        Args:
            roll: Degrees, positive to the right.
            pitch: Degrees, positive nose up.
            yaw: Heading in degrees.
            thrust: 0 to 1.

        Raises:
            ActionInterrupted: The vehicle left the mode.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
        """
        check_numbers(finite=False, roll=roll, pitch=pitch, yaw=yaw, thrust=thrust)
        self.set(AttitudeSetpoint(from_euler(radians(roll), radians(pitch), radians(yaw)), thrust=thrust))

    async def __aenter__(self) -> Self:
        check_preconditions(self._vehicle, "guided", _OPERATION)
        firmware_of(self._vehicle).check_setpoint(self._first)
        await self._stream.__aenter__()
        self._texts = StatusTextCapture(self._vehicle)
        try:
            self._stream.set(firmware_of(self._vehicle).adapt_setpoint(self._first))
            async with deadline(self._timeout, _OPERATION, self._vehicle.address):
                await asyncio.sleep(STREAM_LEAD_TIME)
                self.check()
                await with_status_texts(self._vehicle, firmware_of(self._vehicle).guide())
        except BaseException:
            await self._leave()
            raise
        self._entered = True
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            if self._vehicle.connection.is_open and not self.interrupted:
                await self._hold(quietly=error is not None)
        finally:
            await self._leave()

    async def _hold(self, *, quietly: bool) -> None:
        with suppress(ActionUnsupported):  # a vehicle on a wing follows its last setpoint until it circles
            firmware_of(self._vehicle).check_setpoint(STANDING_STILL)
            self._stream.set(STANDING_STILL)
        try:
            async with asyncio.timeout(HOLD_TIMEOUT if quietly else None):
                await with_status_texts(self._vehicle, firmware_of(self._vehicle).hold())
        except (RemoteError, TimeoutError):
            if not quietly:  # if the block ended with an error, that error is raised
                raise

    def _error(self, kind: type[RemoteError], answer: str) -> RemoteError:
        error = kind(_OPERATION, str(self._vehicle.address), answer=answer)
        error.status_texts = () if self._texts is None else self._texts.warnings
        return error

    async def _leave(self) -> None:
        if self._texts is not None:
            self._texts.close()
        await self._stream.__aexit__(None, None, None)


def guided(
    vehicle: Vehicle, rate: float = 20.0, first: Setpoint = STANDING_STILL, *, timeout: float | None = None
) -> GuidedSession:
    """Return a context manager during which the vehicle follows setpoints.

    Args:
        rate: The rate at which the last setpoint is sent, in hertz.
        first: The setpoint at the start; the default stays where the vehicle is, which a wing cannot do:
            it needs another one, such as an `AttitudeSetpoint`.
        timeout: Seconds to enter the mode; None: until retries are exhausted.

    Returns:
        The session. Entering it raises `ActionRefused` if the vehicle is not armed, and `CommandDenied`,
        `CommandTimeout`, `ModeTimeout`, `ActionTimeout` or `ActionUnsupported` if it does not enter the
        mode; the last one, before anything is sent, also if it ignores setpoints of the type of `first`.
    """
    return GuidedSession(vehicle, rate, first, timeout)


def _down(up: float) -> float:
    """Return the component along the down axis; 0 stays 0, not -0."""
    return 0.0 - up


def _radians(degrees: float | None) -> float | None:
    return None if degrees is None else radians(degrees)
