"""A gimbal of a remote component: `component.gimbal`, `vehicle.gimbal`.

    await gimbal.take_control()
    await gimbal.point(pitch=-45, yaw=30)

A gimbal manager accepts setpoints only of the components in control. Angles are in degrees: pitch above the
horizon, yaw to the right of the vehicle's nose, or of north with `yaw_lock`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.node.api_object import ReadOnly
from mavstack.node.control import ControlStream
from mavstack.services.arguments import check_numbers
from mavstack.services.command import Command, CommandOperation
from mavstack.services.gimbal import (
    GimbalInformation,
    GimbalMonitor,
    GimbalSetpoint,
    GimbalStatus,
    GimbalStreamer,
    PointGimbal,
    TakeControl,
    release_control,
)
from mavstack.services.message_request import RequestMessage

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.node.clients import ComponentClients
    from mavstack.services import Address, Operation
    from mavstack.services.gimbal import GimbalAttitude, GimbalValue

Result = TypeVar("Result")
AnyMessage = TypeVar("AnyMessage", bound="Message")
_CMD = common.MavCmd


class Gimbal(ReadOnly):
    """A gimbal, through its gimbal manager (gimbal protocol v2)."""

    device_id: int

    def __init__(self, clients: ComponentClients, device_id: int = 0) -> None:
        self._clients = clients
        #: The device id of the gimbal (1 to 6), or its component id; 0: all gimbals of the manager.
        self.device_id = device_id
        self._monitor = clients.get(GimbalMonitor)

    @property
    def address(self) -> Address:
        """The component that manages the gimbal: its system and component id."""
        return self._clients.address

    # Reports that were received

    @property
    def information(self) -> GimbalInformation | None:
        """The ranges and abilities; None until received (`get_information` requests them)."""
        return self._monitor.information(self.device_id)

    @property
    def status(self) -> GimbalStatus | None:
        """The components in control; None until received."""
        return self._monitor.status(self.device_id)

    @property
    def attitude(self) -> GimbalAttitude | None:
        """The last attitude, in degrees; None until received."""
        return self._monitor.attitude(self.device_id)

    # Requests

    async def get_information(self, *, timeout: float | None = None) -> GimbalInformation:
        """Request the ranges and abilities (GIMBAL_MANAGER_INFORMATION).

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The information, of the first gimbal for the device id 0.

        Raises:
            CommandDenied: The component manages no such gimbal.
            MessageTimeout: The component does not answer.
        """
        return GimbalInformation.read(await self._request(common.GimbalManagerInformation, timeout))

    async def get_status(self, *, timeout: float | None = None) -> GimbalStatus:
        """Request the components in control (GIMBAL_MANAGER_STATUS).

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The status, of the first gimbal for the device id 0.

        Raises:
            CommandDenied: The component manages no such gimbal.
            MessageTimeout: The component does not answer.
        """
        return GimbalStatus.read(await self._request(common.GimbalManagerStatus, timeout))

    # Control

    async def take_control(
        self, *, secondary: bool = False, force: bool = False, timeout: float | None = None
    ) -> None:
        """Take control of the gimbal (MAV_CMD_DO_GIMBAL_MANAGER_CONFIGURE).

        Args:
            secondary: Take secondary control, and leave primary control as it is.
            force: Take control from another component.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            RemoteDenied: Another component is in control, and `force` is not set.
            CommandDenied: The manager refused, or manages no such gimbal.
            CommandTimeout: The manager does not answer.
        """
        local = self._clients.host.address
        operation = TakeControl(local, self.device_id, secondary=secondary, force=force, timeout=timeout)
        await self._run(operation)

    async def release_control(self, *, timeout: float | None = None) -> None:
        """Give up control of the gimbal, for other components.

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            CommandDenied: The manager refused, or manages no such gimbal.
            CommandTimeout: The manager does not answer.
        """
        await self._run(CommandOperation(release_control(self.device_id), timeout=timeout))

    # Pointing

    async def point(
        self,
        pitch: float | None = None,
        yaw: float | None = None,
        *,
        pitch_rate: float | None = None,
        yaw_rate: float | None = None,
        yaw_lock: bool = False,
        wait: bool = True,
        timeout: float | None = None,
    ) -> GimbalAttitude | None:
        """Point the gimbal (MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW).

        Args:
            pitch: Degrees above the horizon, -90 straight down; None leaves it.
            yaw: Degrees to the right of the nose, or of north with `yaw_lock`; None leaves it.
            pitch_rate: Degrees per second; None: the gimbal's own.
            yaw_rate: Degrees per second; None: the gimbal's own.
            yaw_lock: Keep the direction when the vehicle turns.
            wait: Wait until the gimbal points there.
            timeout: Seconds for the whole call; None: until retries are exhausted or the gimbal stops.

        Returns:
            The attitude; None if the gimbal does not report it and `wait` is False.

        Raises:
            InvalidArgumentError: No angle is given, or one is out of range.
            CommandDenied: The manager refused: this component is not in control, or there is no such gimbal.
            CommandTimeout: The manager does not answer.
            ActionTimeout: The gimbal does not reach the angles, or does not report its attitude.
        """
        if pitch is None and yaw is None:
            raise InvalidArgumentError("pointing a gimbal needs a pitch or a yaw; `turn` takes rates")
        setpoint = GimbalSetpoint(pitch, yaw, pitch_rate=pitch_rate, yaw_rate=yaw_rate, yaw_lock=yaw_lock)
        return await self._point(setpoint, wait, timeout)

    async def turn(
        self,
        pitch_rate: float = 0.0,
        yaw_rate: float = 0.0,
        *,
        yaw_lock: bool = False,
        timeout: float | None = None,
    ) -> None:
        """Turn the gimbal at constant rates (MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW); 0 stops it.

        Args:
            pitch_rate: Degrees per second, positive up.
            yaw_rate: Degrees per second, positive to the right.
            yaw_lock: Keep the direction when the vehicle turns.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            CommandDenied: The manager refused: this component is not in control, or there is no such gimbal.
            CommandTimeout: The manager does not answer.
        """
        setpoint = GimbalSetpoint(pitch_rate=pitch_rate, yaw_rate=yaw_rate, yaw_lock=yaw_lock)
        await self._point(setpoint, False, timeout)

    async def center(self, *, wait: bool = True, timeout: float | None = None) -> GimbalAttitude | None:
        """Point the gimbal to its neutral position, mostly ahead and level.

        Args:
            wait: Wait until the gimbal is there.
            timeout: Seconds for the whole call; None: until retries are exhausted or the gimbal stops.

        Returns:
            The attitude; None if the gimbal does not report it and `wait` is False.

        Raises:
            CommandDenied: The manager refused.
            CommandTimeout: The manager does not answer.
            ActionTimeout: The gimbal does not report that it is there.
        """
        return await self._point(GimbalSetpoint(neutral=True), wait, timeout)

    async def retract(self, *, wait: bool = True, timeout: float | None = None) -> GimbalAttitude | None:
        """Retract the gimbal to its safe position.

        Args:
            wait: Wait until the gimbal is there.
            timeout: Seconds for the whole call; None: until retries are exhausted or the gimbal stops.

        Returns:
            The attitude; None if the gimbal does not report it and `wait` is False.

        Raises:
            CommandDenied: The manager refused.
            CommandTimeout: The manager does not answer.
            ActionTimeout: The gimbal does not report that it is there.
        """
        return await self._point(GimbalSetpoint(retract=True), wait, timeout)

    async def set_roi(
        self, latitude: float, longitude: float, altitude: float = 0.0, *, timeout: float | None = None
    ) -> None:
        """Keep a location in view (MAV_CMD_DO_SET_ROI_LOCATION).

        Args:
            latitude: Degrees.
            longitude: Degrees.
            altitude: Metres above home.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            InvalidArgumentError: A value is not finite, or no location on the Earth.
            CommandDenied: The manager refused.
            CommandTimeout: The manager does not answer.
        """
        check_numbers(latitude=latitude, longitude=longitude, altitude=altitude)
        if abs(latitude) > 90 or abs(longitude) > 180:
            raise InvalidArgumentError(f"{latitude}, {longitude} is no location: degrees, to 90 and 180")
        command = Command(
            _CMD.DO_SET_ROI_LOCATION,
            self.device_id,
            param5=latitude,
            param6=longitude,
            param7=altitude,
            frame=common.MavFrame.GLOBAL_RELATIVE_ALT,
        )
        await self._run(CommandOperation(command, timeout=timeout))

    async def set_roi_system(self, system: int, *, timeout: float | None = None) -> None:
        """Keep another vehicle in view (MAV_CMD_DO_SET_ROI_SYSID).

        Args:
            system: The system id of the other vehicle, whose positions the manager receives.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            CommandDenied: The manager refused.
            CommandTimeout: The manager does not answer.
        """
        command = Command(_CMD.DO_SET_ROI_SYSID, system, self.device_id)
        await self._run(CommandOperation(command, timeout=timeout))

    async def clear_roi(self, *, timeout: float | None = None) -> None:
        """Keep nothing in view any more (MAV_CMD_DO_SET_ROI_NONE).

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            CommandDenied: The manager refused.
            CommandTimeout: The manager does not answer.
        """
        command = Command(_CMD.DO_SET_ROI_NONE, self.device_id)
        await self._run(CommandOperation(command, timeout=timeout))

    def control(self, rate: float = 20.0) -> ControlStream[GimbalValue]:
        """Stream setpoints or stick positions while a block runs.

        Args:
            rate: Hertz at which the last one is repeated.

        Returns:
            An async context manager with `set(value)`, for a `GimbalSetpoint` or `GimbalSticks`.
        """
        host = self._clients.host
        streamer = GimbalStreamer(host.address, self.address, rate, self.device_id)
        return ControlStream(host, streamer, streamer)

    async def _point(
        self, setpoint: GimbalSetpoint, wait: bool, timeout: float | None
    ) -> GimbalAttitude | None:
        setpoint.check()
        return await self._run(
            PointGimbal(setpoint, self.device_id, lambda: self.attitude, wait=wait, timeout=timeout)
        )

    async def _request(self, message: type[AnyMessage], timeout: float | None) -> AnyMessage:
        number = self.device_id
        answer: AnyMessage = await self._run(
            RequestMessage(
                message,
                (float(number),),
                match=lambda report: number in (0, report.gimbal_device_id),
                timeout=timeout,
            )
        )
        return answer

    async def _run(self, operation: Operation[Result]) -> Result:
        return await self._clients.host.run_operation(self._clients.command, operation)

    def __repr__(self) -> str:
        device = f" device {self.device_id}" if self.device_id else ""
        return f"<Gimbal {self.address}{device}>"
