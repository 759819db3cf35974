"""Flying by setpoints: guided mode in ArduPilot, offboard mode in PX4.

    async with vehicle.guided() as guidance:
        guidance.velocity(north=2)
        await asyncio.sleep(5)

The newest setpoint is streamed for as long as the block lasts, since PX4 leaves offboard mode half a second
after the stream ends and ArduPilot stops after three. The stream begins before the mode is entered, as PX4
wants it. On leaving the block the vehicle is told to hold, before the stream ends. If it leaves the mode
meanwhile, by a failsafe or a pilot, the next setpoint raises `ActionInterrupted`, and nobody argues with the
pilot by holding. If it falls silent, the next setpoint raises `ContactLost`; if the connection was closed,
`RemoteCancelled`. When an error or a cancellation ends the block, holding is tried for a few seconds only.
"""

from __future__ import annotations

import asyncio
from math import cos, radians, sin
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import ActionInterrupted, ContactLost, RemoteCancelled, RemoteError
from mavstack.services.setpoints import AttitudeSetpoint, GlobalSetpoint, LocalSetpoint
from mavstack.vehicle.status_text_capture import StatusTextCapture, with_status_texts

if TYPE_CHECKING:
    from types import TracebackType
    from typing import Self

    from mavstack.services.setpoints import Setpoint
    from mavstack.vehicle.vehicle import Vehicle

#: How long to stream before the mode is asked for, in seconds.
BEFOREHAND: Final = 0.6
#: How long to try to hold when the block ends with an error, in seconds.
HOLD_LIMIT: Final = 5.0
STANDING_STILL: Final = LocalSetpoint(velocity=(0.0, 0.0, 0.0))


class GuidedSession:
    """A vehicle that follows setpoints while a block lasts; made by `Vehicle.guided`."""

    def __init__(self, vehicle: Vehicle, rate: float, first: Setpoint) -> None:
        self._vehicle = vehicle
        self._stream = vehicle.component.setpoints(rate)
        self._listener: StatusTextCapture | None = None
        self._first = first
        self._entered = False

    @property
    def interrupted(self) -> bool:
        """Whether the vehicle has left the mode in which it follows."""
        mode, modes = self._vehicle.mode, self._vehicle.firmware.modes_of("guided")
        return self._entered and modes is not None and mode is not None and mode.lower() not in modes

    def check(self) -> None:
        """Raise what tells why, if the vehicle follows no longer."""
        if not self._vehicle.connection.is_open:
            raise self._ended(RemoteCancelled, "the connection was closed")
        if not self._vehicle.alive:
            raise self._ended(ContactLost, "it fell silent")
        if self.interrupted:
            raise self._ended(ActionInterrupted, f"it changed to {self._vehicle.mode}")

    def set(self, setpoint: Setpoint) -> None:
        """Follow any setpoint, such as one that leaves axes to the vehicle."""
        self.check()
        self._stream.set(setpoint)

    def velocity(
        self, north: float = 0.0, east: float = 0.0, down: float = 0.0, *, yaw: float | None = None
    ) -> None:
        """Fly with a velocity in m/s; yaw in degrees."""
        self.set(LocalSetpoint(velocity=(north, east, down), yaw=_radians(yaw)))

    def body_velocity(
        self, forward: float = 0.0, right: float = 0.0, down: float = 0.0, *, yaw_rate: float = 0.0
    ) -> None:
        """Fly with a velocity in m/s as seen from the vehicle; yaw rate in degrees a second."""
        self.set(
            LocalSetpoint(
                velocity=(forward, right, down), yaw_rate=radians(yaw_rate), frame=common.MavFrame.BODY_NED
            )
        )

    def position(self, north: float, east: float, down: float, *, yaw: float | None = None) -> None:
        """Go to a place in metres from the vehicle's origin; yaw in degrees."""
        self.set(LocalSetpoint(position=(north, east, down), yaw=_radians(yaw)))

    def goto(self, latitude: float, longitude: float, altitude: float, *, yaw: float | None = None) -> None:
        """Go to a place in degrees and metres above home."""
        self.set(GlobalSetpoint(latitude, longitude, altitude, yaw=_radians(yaw)))

    def attitude(self, roll: float, pitch: float, yaw: float, thrust: float) -> None:
        """RateRequest an attitude in degrees, with a thrust from 0 to 1."""
        self.set(AttitudeSetpoint(quaternion(radians(roll), radians(pitch), radians(yaw)), thrust=thrust))

    async def __aenter__(self) -> Self:
        await self._stream.__aenter__()
        self._listener = StatusTextCapture(self._vehicle)
        try:
            self._stream.set(self._first)
            await asyncio.sleep(BEFOREHAND)
            self.check()
            await with_status_texts(self._vehicle, self._vehicle.firmware.guide())
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
        self._stream.set(STANDING_STILL)
        try:
            async with asyncio.timeout(HOLD_LIMIT if quietly else None):
                await with_status_texts(self._vehicle, self._vehicle.firmware.hold())
        except (RemoteError, TimeoutError):
            if not quietly:  # else the error that ended the block is what is told
                raise

    def _ended(self, kind: type[RemoteError], how: str) -> RemoteError:
        error = kind("following setpoints", str(self._vehicle.address), answer=how)
        error.status_texts = () if self._listener is None else self._listener.warnings
        return error

    async def _leave(self) -> None:
        if self._listener is not None:
            self._listener.close()
        await self._stream.__aexit__(None, None, None)


def quaternion(roll: float, pitch: float, yaw: float) -> tuple[float, float, float, float]:
    """The rotation of these angles in radians, as w, x, y, z."""
    cr, sr, cp, sp, cy, sy = (turned(angle / 2) for angle in (roll, pitch, yaw) for turned in (cos, sin))
    return (
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    )


def _radians(degrees: float | None) -> float | None:
    return None if degrees is None else radians(degrees)
