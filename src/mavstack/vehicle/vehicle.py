"""A vehicle: what it tells, and what it can be asked to do.

Everything here goes through its autopilot, the component that flies it; `component` is that one with every
service of MAVLink, for what is not here, and `firmware` is what knows how its firmware wants things asked.

An action that takes a while waits until it is done, unless `wait=False`, and then raises `ActionTimeout` if
the vehicle gets no further, `ActionInterrupted` if it does something else, `ContactLost` if it falls silent.
One that is refused raises `CommandDenied` with what the vehicle said about it. Altitudes are in metres above
home, angles in degrees.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.mission import PlanType
from mavstack.vehicle.actions import arming, flying, home
from mavstack.vehicle.firmware import Firmware, firmware_of
from mavstack.vehicle.firmware.firmware import Place
from mavstack.vehicle.guided_session import STANDING_STILL, GuidedSession
from mavstack.vehicle.health import Health, health_of, wait_until_ready
from mavstack.vehicle.mission import Mission, VehiclePlan
from mavstack.vehicle.status_text_capture import with_status_texts
from mavstack.vehicle.telemetry import Telemetry, TelemetryProperties
from mavstack.vehicle.vehicle_type import VehicleType

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.node import RemoteComponent
    from mavstack.node.ftp import Ftp
    from mavstack.node.logs import Logs
    from mavstack.node.modes import Modes
    from mavstack.node.params import Params
    from mavstack.node.shell import Shell
    from mavstack.services import Address
    from mavstack.services.heartbeat import ComponentInfo
    from mavstack.services.setpoints import Setpoint
    from mavstack.vehicle.connection import Connection


class Vehicle(TelemetryProperties):
    """One vehicle; made by `Connection.vehicle` and `Connection.vehicles`."""

    def __init__(self, connection: Connection, component: RemoteComponent) -> None:
        self.connection = connection
        #: Its autopilot, with every service of MAVLink.
        self.component = component
        #: What was heard of it; `TelemetryProperties` shows it.
        self.telemetry = Telemetry(component)

    # What it is

    @property
    def address(self) -> Address:
        """The address of its autopilot."""
        return self.component.address

    @property
    def system(self) -> int:
        """Its system id."""
        return self.address.system

    @property
    def alive(self) -> bool:
        """Whether it was heard lately."""
        info = self.component.info
        return info is not None and info.alive

    @property
    def components(self) -> Mapping[int, ComponentInfo]:
        """The other components of its system that were heard, by their component ids: cameras, gimbals …"""
        infos = self.connection.components.values()
        own = (info for info in infos if info.address.system == self.system and info.address != self.address)
        return {info.address.component: info for info in own}

    @property
    def has_id_conflict(self) -> bool:
        """Whether another vehicle uses its system id as well; see `SystemIdConflict`."""
        return self.connection.discovery.clash_of(self.address)

    @property
    def autopilot(self) -> int:
        """Its MAV_AUTOPILOT."""
        info = self.component.info
        return common.MavAutopilot.GENERIC if info is None else info.autopilot

    @property
    def vehicle_type(self) -> VehicleType:
        """How it moves."""
        info = self.component.info
        found = VehicleType.OTHER if info is None else VehicleType.of(info.type)
        # A quadplane of ArduPilot's calls itself a plane unless it is told otherwise.
        hovers = found is VehicleType.PLANE and self.vtol_state
        return VehicleType.VTOL if hovers else found

    @property
    def firmware(self) -> Firmware:
        """How its firmware wants to be asked."""
        return firmware_of(self)

    @property
    def health(self) -> Health:
        """Whether it says that it is ready to arm, and what is wrong with it, as far as it was heard."""
        return health_of(self.telemetry)

    async def wait_until_ready(self, *, timeout: float = 60.0) -> Health:
        """Wait until it is ready to arm; raises `HealthTimeout`, whose text holds the reasons."""
        return await wait_until_ready(self, timeout)

    # Arming and modes

    async def arm(self, *, force: bool = False) -> None:
        """Let the motors run; `force` skips the firmware's checks as far as it lets itself be told."""
        await arming.set_armed(self, armed=True, force=force)

    async def disarm(self, *, force: bool = False) -> None:
        """Stop the motors; with `force` in the air, too."""
        await arming.set_armed(self, armed=False, force=force)

    async def set_mode(self, mode: str | int) -> None:
        """Enter a mode of its firmware's, by name or number; `modes` tells which there are."""
        await with_status_texts(self, self.component.modes.set(mode))

    @property
    def modes(self) -> Modes:
        """Its modes."""
        return self.component.modes

    # Flying

    async def takeoff(
        self, altitude: float = 10.0, *, wait: bool = True, timeout: float | None = None
    ) -> None:
        """Take off to an altitude, and stay there."""
        await flying.takeoff(self, altitude, wait=wait, limit=timeout)

    async def land(self, *, wait: bool = True, timeout: float | None = None) -> None:
        """Land where it is; a plane of ArduPilot's lands where its mission says."""
        await flying.land(self, wait=wait, limit=timeout)

    async def rtl(self, *, wait: bool = True, timeout: float | None = None) -> None:
        """Return home, and land there if that is what it does."""
        await flying.rtl(self, wait=wait, limit=timeout)

    async def hold(self) -> None:
        """Stay where it is; a wing circles."""
        await flying.hold(self)

    async def goto(
        self,
        latitude: float,
        longitude: float,
        altitude: float | None = None,
        *,
        yaw: float | None = None,
        radius: float | None = None,
        wait: bool = True,
        timeout: float | None = None,
    ) -> None:
        """Go to a place, at the altitude that it has if none is given; a wing circles it with the radius."""
        place = Place(latitude, longitude, altitude)
        await flying.goto(self, place, yaw=yaw, radius=radius, wait=wait, limit=timeout)

    async def move(
        self,
        north: float = 0.0,
        east: float = 0.0,
        up: float = 0.0,
        *,
        wait: bool = True,
        timeout: float | None = None,
    ) -> None:
        """Go so many metres from where it is."""
        place = await flying.place_from_here(self, north, east, up)
        await flying.goto(self, place, yaw=None, radius=None, wait=wait, limit=timeout)

    async def orbit(
        self,
        latitude: float,
        longitude: float,
        altitude: float | None = None,
        *,
        radius: float = 20.0,
        speed: float | None = None,
        wait: bool = True,
        timeout: float | None = None,
    ) -> None:
        """Circle a place, counter-clockwise if the radius is negative; done when it is on the circle."""
        place = Place(latitude, longitude, altitude)
        await flying.orbit(self, place, radius=radius, speed=speed, wait=wait, limit=timeout)

    async def set_speed(self, speed: float, kind: int = common.SpeedType.GROUNDSPEED) -> None:
        """Fly with so many m/s, over ground unless another SPEED_TYPE is named."""
        asked = self.component.command(common.MavCmd.DO_CHANGE_SPEED, kind, speed, -1)
        await with_status_texts(self, asked)

    async def set_yaw(self, heading: float, *, wait: bool = True, timeout: float | None = None) -> None:
        """Turn to a heading."""
        await flying.turn(self, heading, wait=wait, limit=timeout)

    def guided(self, rate: float = 20.0, first: Setpoint = STANDING_STILL) -> GuidedSession:
        """Let it follow setpoints while a block lasts; `first` is the one that it begins with."""
        return GuidedSession(self, rate, first)

    # Home, and reboots

    async def set_home(
        self, latitude: float | None = None, longitude: float | None = None, altitude: float | None = None
    ) -> None:
        """Make a place home, or the place where it is; this altitude is in metres above mean sea level."""
        await home.set_home(self, latitude, longitude, altitude)

    async def reboot(self, *, wait: bool = True) -> None:
        """Reboot the autopilot, and wait until it is back."""
        await arming.reboot(self, wait=wait)

    # Its services

    @property
    def params(self) -> Params:
        """Its parameters."""
        return self.component.params

    @cached_property
    def mission(self) -> Mission:
        """What it is to fly."""
        return Mission(self)

    @cached_property
    def fence(self) -> VehiclePlan:
        """Where it must stay."""
        return VehiclePlan(self, PlanType.FENCE)

    @cached_property
    def rally(self) -> VehiclePlan:
        """Where it may land when it returns."""
        return VehiclePlan(self, PlanType.RALLY)

    @property
    def ftp(self) -> Ftp:
        """The files on it."""
        return self.component.ftp

    @property
    def logs(self) -> Logs:
        """The logs on it."""
        return self.component.logs

    def shell(self) -> Shell:
        """Open its shell while a block lasts."""
        return self.component.shell()

    def __repr__(self) -> str:
        return f"<Vehicle {self.address}>"
