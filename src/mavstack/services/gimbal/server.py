"""The server of the gimbal manager protocol (guide: gimbal protocol v2).

    server = GimbalManagerServer(local, [GimbalMotion()])
    server.answer(commands, messages)       the command server and the message server of the component

It answers discovery, keeps who is in control, publishes GIMBAL_MANAGER_STATUS and, for gimbals without a
component of their own, GIMBAL_DEVICE_ATTITUDE_STATUS, and hands accepted setpoints to the device. Setpoints
of components that are not in control are not accepted: a command is answered DENIED, a message is ignored. A
region of interest is turned into angles here, from the positions that the vehicle broadcasts.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from math import isnan
from typing import TYPE_CHECKING, Protocol

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.addressing import Address, message_ids
from mavstack.services.gimbal.aim import Positions, RegionOfInterest, SystemOfInterest, direction_to
from mavstack.services.gimbal.control import GimbalControl
from mavstack.services.gimbal.reports import ALL_DEVICES, MAX_ATTACHED_DEVICE, GimbalStatus
from mavstack.services.gimbal.setpoint import GimbalSetpoint, GimbalSticks
from mavstack.services.service import Event, Service

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from mavstack.dialects import Message
    from mavstack.services.command import CommandRequest, CommandServer
    from mavstack.services.gimbal.aim import VehiclePose
    from mavstack.services.gimbal.reports import GimbalAttitude, GimbalInformation
    from mavstack.services.gimbal.setpoint import GimbalValue
    from mavstack.services.message_request import MessageServer
    from mavstack.wire import Packet

#: Seconds between two status messages (guide: 5 Hz).
STATUS_INTERVAL = 0.2
#: Seconds between two attitude messages (guide: 10 Hz).
ATTITUDE_INTERVAL = 0.1
#: Seconds between two corrections of a gimbal that keeps a region of interest in view.
AIM_INTERVAL = 0.1

_CMD, _RESULT = common.MavCmd, common.MavResult


class GimbalDevice(Protocol):
    """A gimbal as the server drives it; `GimbalMotion` is an implementation, for simulation and for tests."""

    @property
    def information(self) -> GimbalInformation:
        """The abilities of the gimbal."""

    def apply(self, value: GimbalValue, now: float, /) -> None:
        """Follow a setpoint, or stick positions, from now on."""

    def advance(self, now: float, vehicle_heading: float | None, /) -> GimbalAttitude:
        """Return the present attitude; the heading is in degrees from north, None if unknown."""


@dataclass(frozen=True, slots=True)
class GimbalSet(Event):
    """A component set a gimbal: a setpoint, stick positions, or a region of interest (None: no longer)."""

    device_id: int
    value: GimbalValue | RegionOfInterest | SystemOfInterest | None
    source: Address


@dataclass(frozen=True, slots=True)
class GimbalControlChanged(Event):
    """The components in control of a gimbal changed."""

    status: GimbalStatus


class _Managed:
    """One gimbal of the server."""

    def __init__(self, device: GimbalDevice) -> None:
        self.device = device
        self.control = GimbalControl()
        self.interest: RegionOfInterest | SystemOfInterest | None = None
        self.flags = 0

    @property
    def device_id(self) -> int:
        return self.device.information.device_id

    @property
    def status(self) -> GimbalStatus:
        return GimbalStatus(self.device_id, self.control.primary, self.control.secondary, self.flags)


class GimbalManagerServer(Service):
    """The gimbal managers of one component.

    Args:
        local: The component.
        devices: The gimbals, with different device ids.
        booted_at: When the component started, Unix seconds, for `time_boot_ms`; None: with its first message.
        pose: Returns the vehicle's pose at a time, None if unknown; None: the messages of the vehicle tell.
        open_control: Accept setpoints of components that are not in control, as ArduPilot does.

    Raises:
        InvalidArgumentError: There is no gimbal, or two have one device id.
    """

    handles = message_ids(
        common.GimbalManagerSetPitchyaw,
        common.GimbalManagerSetAttitude,
        common.GimbalManagerSetManualControl,
        common.CommandLong,  # the command server executes commands; this service sends its events afterwards
        common.CommandInt,
        common.GlobalPositionInt,
        common.Attitude,
    )

    def __init__(
        self,
        local: Address,
        devices: Sequence[GimbalDevice],
        *,
        booted_at: float | None = None,
        pose: Callable[[float], VehiclePose | None] | None = None,
        open_control: bool = False,
    ) -> None:
        super().__init__(local)
        self._gimbals = {device.information.device_id: _Managed(device) for device in devices}
        if not devices or len(self._gimbals) < len(devices) or ALL_DEVICES in self._gimbals:
            raise InvalidArgumentError("a gimbal manager needs gimbals with different device ids from 1")
        self._booted_at = booted_at
        self._pose = pose
        self._open_control = open_control
        self._positions = Positions(local.system)
        self._aim_due: float | None = None

    def answer(
        self, commands: CommandServer, messages: MessageServer, *, roi: bool = True, now: float = 0.0
    ) -> None:
        """Answer the commands and requests of the protocol by the component's servers.

        Args:
            commands: The command server of the component.
            messages: The message server of the component.
            roi: Answer the DO_SET_ROI commands too; False on an autopilot that has its own handlers.
            now: When the streams begin, Unix seconds.
        """
        messages.provide_instances(common.GimbalManagerInformation, self._informations)
        messages.provide_instances(common.GimbalDeviceInformation, self._device_informations)
        all_statuses = partial(self._selected_statuses, ALL_DEVICES)
        messages.provide(common.GimbalManagerStatus, all_statuses, interval=STATUS_INTERVAL, now=now)
        messages.provide_instances(common.GimbalManagerStatus, self._selected_statuses)
        if any(device_id <= MAX_ATTACHED_DEVICE for device_id in self._gimbals):
            messages.provide(
                common.GimbalDeviceAttitudeStatus, self._attitudes, interval=ATTITUDE_INTERVAL, now=now
            )
        commands.support(_CMD.DO_GIMBAL_MANAGER_CONFIGURE, self._configure)
        commands.support(_CMD.DO_GIMBAL_MANAGER_PITCHYAW, self._pitch_yaw)
        if roi:
            commands.support(_CMD.DO_SET_ROI_LOCATION, self._roi_location)
            commands.support(_CMD.DO_SET_ROI_SYSID, self._roi_system)
            commands.support(_CMD.DO_SET_ROI_NONE, self._roi_none)

    def status(self, device_id: int) -> GimbalStatus:
        """Return who controls a gimbal."""
        return self._gimbals[device_id].status

    def take(self, device_id: int, value: GimbalValue, now: float) -> None:
        """Set a gimbal on behalf of the component itself, as an autopilot does in a mission."""
        self._apply(self._gimbals[device_id], value, self.local, now)

    # Methods of a service

    def receive(self, packet: Packet, now: float) -> bool | None:
        source = Address(packet.system, packet.component)
        match packet.message:
            case common.GimbalManagerSetPitchyaw() | common.GimbalManagerSetAttitude() as message:
                self._set(message.gimbal_device_id, GimbalSetpoint.from_message(message), source, now)
            case common.GimbalManagerSetManualControl() as message:
                self._set(message.gimbal_device_id, GimbalSticks.from_message(message), source, now)
            case common.GlobalPositionInt() | common.Attitude():
                self._positions.receive(packet)
                return False
        return None

    def next_timeout(self) -> float | None:
        return self._aim_due

    def handle_timeout(self, now: float) -> None:
        if self._aim_due is None or now < self._aim_due:
            return
        aiming = [gimbal for gimbal in self._gimbals.values() if gimbal.interest is not None]
        for gimbal in aiming:
            self._aim(gimbal, now)
        self._aim_due = now + AIM_INTERVAL if aiming else None

    # Commands

    def _selected(self, device_id: float) -> list[_Managed]:
        """Return the gimbals that a device id stands for; 0 for all."""
        if device_id == ALL_DEVICES or isnan(device_id):
            return list(self._gimbals.values())
        return [gimbal for number, gimbal in self._gimbals.items() if number == device_id]

    def _configure(self, request: CommandRequest) -> common.MavResult:
        selected = self._selected(request.command.param7)
        for gimbal in selected:
            before = gimbal.status
            if not gimbal.control.configure(request.command, request.source):
                return _RESULT.DENIED
            if gimbal.status != before:
                self.emit(GimbalControlChanged(gimbal.status))
                self.send(gimbal.status.to_message(self._milliseconds(request.received_at)))
        return _RESULT.ACCEPTED if selected else _RESULT.DENIED

    def _pitch_yaw(self, request: CommandRequest) -> common.MavResult:
        setpoint = GimbalSetpoint.from_command(request.command)
        try:
            setpoint.check()
        except InvalidArgumentError:
            return _RESULT.DENIED
        return self._command(request.command.param7, setpoint, request)

    def _roi_location(self, request: CommandRequest) -> common.MavResult:
        region = RegionOfInterest.of_command(request.command)
        if region is None:
            return _RESULT.DENIED
        return self._look(request.command.param1, region, request)

    def _roi_system(self, request: CommandRequest) -> common.MavResult:
        system = request.command.param1
        if not 1 <= system <= 255 or system == self.local.system:
            return _RESULT.DENIED
        return self._look(request.command.param2, SystemOfInterest(int(system)), request)

    def _roi_none(self, request: CommandRequest) -> common.MavResult:
        return self._look(request.command.param1, None, request)

    def _command(self, device_id: float, value: GimbalValue, request: CommandRequest) -> common.MavResult:
        gimbals = self._controlled(device_id, request.source)
        for gimbal in gimbals:
            self._apply(gimbal, value, request.source, request.received_at)
        return _RESULT.ACCEPTED if gimbals else _RESULT.DENIED

    def _look(
        self, device_id: float, interest: RegionOfInterest | SystemOfInterest | None, request: CommandRequest
    ) -> common.MavResult:
        gimbals, now = self._controlled(device_id, request.source), request.received_at
        for gimbal in gimbals:
            gimbal.interest = interest
            if interest is None:
                gimbal.device.apply(GimbalSetpoint(neutral=True), now)
            self.emit(GimbalSet(gimbal.device_id, interest, request.source))
        if gimbals:
            follows = interest.system if isinstance(interest, SystemOfInterest) else None
            self._positions.follow(follows)
            self._aim_due = now if interest is not None else self._aim_due
        return _RESULT.ACCEPTED if gimbals else _RESULT.DENIED

    def _controlled(self, device_id: float, source: Address) -> list[_Managed]:
        """Return the selected gimbals that a component controls."""
        own = source == self.local or self._open_control
        return [gimbal for gimbal in self._selected(device_id) if own or gimbal.control.accepts(source)]

    # Setpoints

    def _set(self, device_id: int, value: GimbalValue, source: Address, now: float) -> None:
        for gimbal in self._controlled(device_id, source):
            self._apply(gimbal, value, source, now)

    def _apply(self, gimbal: _Managed, value: GimbalValue, source: Address, now: float) -> None:
        gimbal.interest = None
        gimbal.flags = value.manager_flags if isinstance(value, GimbalSetpoint) else 0
        gimbal.device.advance(now, self._heading(now))
        gimbal.device.apply(value, now)
        self.emit(GimbalSet(gimbal.device_id, value, source))

    def _aim(self, gimbal: _Managed, now: float) -> None:
        pose, interest = self._pose_at(now), gimbal.interest
        if isinstance(interest, SystemOfInterest):
            other = self._positions.of(interest.system)
            interest = (
                None
                if other is None
                else RegionOfInterest(other.latitude, other.longitude, other.altitude, relative=False)
            )
        if pose is None or interest is None:
            return
        pitch, yaw = direction_to(pose, interest)
        gimbal.device.advance(now, self._heading(now))
        gimbal.device.apply(GimbalSetpoint(pitch=pitch, yaw=yaw, yaw_lock=True), now)

    def _pose_at(self, now: float) -> VehiclePose | None:
        return self._positions.own if self._pose is None else self._pose(now)

    def _heading(self, now: float) -> float | None:
        if self._pose is None:
            return self._positions.heading
        pose = self._pose(now)
        return None if pose is None else pose.heading

    # Messages

    def _milliseconds(self, now: float) -> int:
        if self._booted_at is None:
            self._booted_at = now
        return max(round((now - self._booted_at) * 1e3), 0) & 0xFFFFFFFF

    def _informations(self, which: float, now: float) -> list[Message]:
        milliseconds = self._milliseconds(now)
        return [gimbal.device.information.to_message(milliseconds) for gimbal in self._selected(which)]

    def _device_informations(self, which: float, now: float) -> list[Message]:
        milliseconds = self._milliseconds(now)
        return [
            gimbal.device.information.to_device_message(milliseconds)
            for gimbal in self._selected(which)
            if gimbal.device_id <= MAX_ATTACHED_DEVICE
        ]

    def _selected_statuses(self, which: float, now: float) -> list[Message]:
        milliseconds = self._milliseconds(now)
        return [gimbal.status.to_message(milliseconds) for gimbal in self._selected(which)]

    def _attitudes(self, now: float) -> list[Message]:
        milliseconds, heading = self._milliseconds(now), self._heading(now)
        return [
            gimbal.device.advance(now, heading).to_message(milliseconds, gimbal.device_id)
            for gimbal in self._gimbals.values()
            if gimbal.device_id <= MAX_ATTACHED_DEVICE
        ]
