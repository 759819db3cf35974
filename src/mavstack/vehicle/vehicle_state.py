"""The state of a vehicle: its identity, its reports, and the positions that actions start from.

Actions, firmware classes and missions work on this part of a vehicle; `Vehicle` adds the calls that use them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import CommandDenied, MessageTimeout
from mavstack.node.read_only import ReadOnly
from mavstack.node.subscription import DEFAULT_QUEUE
from mavstack.services.events import LogLevel
from mavstack.vehicle.firmware import firmware_of
from mavstack.vehicle.health import Health, health_of
from mavstack.vehicle.payloads import VehiclePayloads
from mavstack.vehicle.status_text_capture import with_status_texts
from mavstack.vehicle.telemetry import Telemetry, TelemetryStreams
from mavstack.vehicle.vehicle_type import QUADPLANE_PARAMETER, VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from mavstack.links import Channel
    from mavstack.node import Node, RemoteComponent
    from mavstack.node.events import EventListener, EventStream
    from mavstack.node.ftp import Ftp
    from mavstack.node.logs import Logs
    from mavstack.node.modes import Modes
    from mavstack.node.params import Params
    from mavstack.node.shell import Shell
    from mavstack.node.terrain import Terrain
    from mavstack.services import Address
    from mavstack.services.events import DecodedEvent
    from mavstack.services.heartbeat import ComponentInfo, Conflict
    from mavstack.services.version import AutopilotVersion
    from mavstack.vehicle.telemetry.values import HomePosition, Position

#: The time without a position after which a call fails that has no timeout of its own, in seconds.
POSITION_TIMEOUT = 10.0


class VehicleState(VehiclePayloads, TelemetryStreams, ReadOnly):
    """The identity, telemetry and health of one vehicle."""

    _constructed = frozenset({"connection", "component", "telemetry"})

    def __init__(self, connection: Node, component: RemoteComponent) -> None:
        #: The connection through which the vehicle is reached.
        self.connection = connection
        #: The vehicle's autopilot, with every MAVLink service.
        self.component = component
        #: The messages that were received; the properties read them.
        self.telemetry = Telemetry(connection, component)

    # Identity

    @property
    def address(self) -> Address:
        """The address of the autopilot: system id and component id."""
        return self.component.address

    @property
    def system(self) -> int:
        """The system id."""
        return self.address.system

    @property
    def alive(self) -> bool:
        """True if heartbeats of the autopilot arrive."""
        info = self.component.info
        return info is not None and info.alive

    @property
    def components(self) -> Mapping[int, ComponentInfo]:
        """The other components of the system by component id, such as cameras and gimbals."""
        infos = self.connection.components.values()
        own = (info for info in infos if info.address.system == self.system and info.address != self.address)
        return {info.address.component: info for info in own}

    @property
    def info(self) -> ComponentInfo | None:
        """The autopilot's last heartbeat: type, firmware, mode; `version` is that of its software."""
        return self.component.info

    @property
    def has_id_conflict(self) -> bool:
        """True if another vehicle uses the same system id; see `SystemIdConflict`."""
        return self.connection.has_address_conflict(self.address)

    @property
    def id_conflict(self) -> Conflict | None:
        """The vehicles that use the same system id, and what tells them apart; None: only this one does."""
        return self.connection.id_conflict(self.system)

    @property
    def chosen_sender(self) -> str | None:
        """The name of the channel that `choose_sender` chose; None: none was chosen."""
        return self.connection.chosen_sender(self.system)

    def choose_sender(self, channel: Channel | str | None) -> None:
        """Choose the vehicle to work with, where several use this system id.

        Its packets count only on that channel, and packets for it go over that channel alone, until another
        choice or until the channel closes. Values that were received before are forgotten.

        Args:
            channel: The channel, its name, or its remote address, such as "192.168.1.20:14550"; None: take
                the choice back.

        Raises:
            InvalidArgumentError: No open channel is named so, or the vehicles share the channel.
        """
        before = self.chosen_sender
        self.connection.choose_sender(self.system, channel)
        if self.chosen_sender != before:
            self.telemetry.forget()

    @property
    def autopilot(self) -> int:
        """The MAV_AUTOPILOT of the heartbeat."""
        info = self.component.info
        return common.MavAutopilot.GENERIC if info is None else info.autopilot

    @property
    def identifier(self) -> str:
        """The identifier of a firmware that speaks MSP, "BTFL" or "INAV"; empty for all others."""
        info = self.component.info
        return "" if info is None else info.identifier

    @property
    def vehicle_type(self) -> VehicleType:
        """The way the vehicle moves; `mav_type` is the MAV_TYPE of its heartbeat."""
        info = self.component.info
        found = VehicleType.OTHER if info is None else VehicleType.of(info.type)
        # A quadplane may call itself a plane; its EXTENDED_SYS_STATE has a VTOL state, or a parameter tells.
        if found is VehicleType.PLANE and (self.vtol_state or self._is_enabled_quadplane):
            return VehicleType.VTOL
        return found

    @property
    def _is_enabled_quadplane(self) -> bool:
        enabled = self.params.cached.get(QUADPLANE_PARAMETER)
        return enabled is not None and enabled.value > 0

    @property
    def health(self) -> Health:
        """The readiness to arm, and the problems and warnings that the vehicle reports."""
        return health_of(self, self.telemetry)

    @property
    def heading(self) -> float | None:
        """The direction in which the vehicle points, 0 to 360 degrees (GLOBAL_POSITION_INT or ATTITUDE)."""
        position, attitude = self.position, self.attitude
        if position is not None and position.heading is not None:
            return position.heading
        return None if attitude is None else attitude.heading

    @property
    def ground_speed(self) -> float | None:
        """The horizontal speed over ground, in m/s (LOCAL_POSITION_NED, GLOBAL_POSITION_INT or VFR_HUD)."""
        velocity, hud = self.velocity, self.vfr_hud
        if velocity is not None:
            return velocity.ground_speed
        return None if hud is None else hud.ground_speed

    @property
    def climb_rate(self) -> float | None:
        """The vertical speed, in m/s, positive up (LOCAL_POSITION_NED, GLOBAL_POSITION_INT or VFR_HUD)."""
        velocity, hud = self.velocity, self.vfr_hud
        if velocity is not None:
            return -velocity.down
        return None if hud is None else hud.climb

    @property
    def version(self) -> AutopilotVersion | None:
        """The software and hardware versions; None before `get_version` (AUTOPILOT_VERSION)."""
        return self.telemetry.version

    # Services

    @property
    def modes(self) -> Modes:
        """The flight modes."""
        return self.component.modes

    @property
    def params(self) -> Params:
        """The parameters."""
        return self.component.params

    @property
    def ftp(self) -> Ftp:
        """The files on the vehicle (MAVLink FTP); raises `ActionUnsupported` if its firmware has none."""
        firmware_of(self).check_supported("ftp")
        return self.component.ftp

    @property
    def logs(self) -> Logs:
        """The logs on the vehicle; raises `ActionUnsupported` if its firmware has none."""
        firmware_of(self).check_supported("logs")
        return self.component.logs

    @property
    def terrain(self) -> Terrain:
        """The terrain that the vehicle has from ground stations; `serve_terrain` of a node sends it.

        Raises `ActionUnsupported` if its firmware uses none.
        """
        firmware_of(self).check_supported("terrain")
        return self.component.terrain

    def events(
        self,
        *,
        severity: int = LogLevel.DEBUG,
        component: int | None = None,
        queue: int = DEFAULT_QUEUE,
    ) -> EventStream:
        """Subscribe to the vehicle's events (EVENT): notices that arrive in order and each once.

        PX4 has them for arming, refusals, modes, failsafes and checks; ArduPilot has none. Missing events are
        requested again. Their words are in the vehicle's metadata, which is downloaded once.

        Args:
            severity: The least severe level to deliver, a MAV_SEVERITY or `LogLevel`; `LogLevel.DISABLED`:
                every event, also those that are for programs only.
            component: The component id of the sender; None: the autopilot.
            queue: Events that are queued while the program does not read; then the oldest is dropped.

        Returns:
            An async iterator of the events: severity, name, message with its arguments, arguments by name.

        Raises:
            InvalidTypeError: The severity is not a number.
            InvalidArgumentError: The severity is not from 0 to 9.
        """
        return self._component(component).events(severity=severity, queue=queue)

    def add_event_listener(
        self,
        callback: Callable[[DecodedEvent], object],
        *,
        severity: int = LogLevel.DEBUG,
        component: int | None = None,
    ) -> EventListener:
        """Call a function with each event of the vehicle (EVENT); see `events`.

        Args:
            callback: The function. It must return quickly, since it runs in the event loop.
            severity: The least severe level to deliver, as for `events`.
            component: The component id of the sender; None: the autopilot.

        Returns:
            The listener; its `close()` ends the calls.

        Raises:
            InvalidTypeError: The severity is not a number.
            InvalidArgumentError: The severity is not from 0 to 9.
        """
        return self._component(component).add_event_listener(callback, severity=severity)

    def _component(self, component: int | None) -> RemoteComponent:
        return self.component if component is None else self.connection.component(self.system, component)

    def shell(self) -> Shell:
        """Return a context manager during which the firmware's shell is open (SERIAL_CONTROL).

        Returns:
            The shell.

        Raises:
            ActionUnsupported: The firmware has none.
        """
        firmware_of(self).check_supported("shell")
        return self.component.shell()

    # Positions, requested or waited for if they are not known

    def rc_pulse(self, channel: int) -> int | None:
        """Return the pulse of a radio control channel.

        Args:
            channel: The number of the channel, from 1.

        Returns:
            Microseconds, or None if the channel is unused or was not received (RC_CHANNELS).
        """
        rc = self.rc
        return rc.channels[channel - 1] if rc is not None and channel <= len(rc.channels) else None

    async def get_home(self, *, timeout: float | None = None) -> HomePosition:
        """Return the home position; request it if it was not received (HOME_POSITION).

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            The position in degrees and metres above mean sea level.

        Raises:
            CommandDenied: The vehicle refused the request.
            MessageTimeout: The vehicle did not answer, or has no home yet.
        """
        if self.home is None:
            request = self.component.request_message(common.HomePosition, timeout=timeout)
            await with_status_texts(self, request)
        home = self.home
        if home is None:
            raise MessageTimeout("reading the home position of", str(self.address), answer="it has none yet")
        return home

    async def get_home_altitude(self, *, timeout: float | None = None) -> float:
        """Return the altitude of home, which follows from the position if home itself is not known.

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Returns:
            Metres above mean sea level.

        Raises:
            CommandDenied: The vehicle refused the request for its home, and its position is not known.
            MessageTimeout: The vehicle did not answer, and its position is not known.
        """
        try:
            return (await self.get_home(timeout=timeout)).altitude
        except (CommandDenied, MessageTimeout):
            position = self.position
            if position is None or position.altitude is None or position.relative_altitude is None:
                raise
            return position.altitude - position.relative_altitude

    async def get_position(self, *, timeout: float | None = None) -> Position:
        """Return the position; wait for it if it was not received (GLOBAL_POSITION_INT).

        Args:
            timeout: Seconds for the whole call; None: until no position has arrived for a while.

        Returns:
            The position in degrees and metres.

        Raises:
            MessageTimeout: No position arrived in time, or the vehicle does not know it.
            CommandDenied: The vehicle refused to send its position.
            RemoteCancelled: The connection was closed.
        """
        if self.position is None:
            seconds = POSITION_TIMEOUT if timeout is None else timeout
            await self.wait_for_message(common.GlobalPositionInt, timeout=seconds)
        position = self.position
        if position is None:
            raise MessageTimeout("reading the position of", str(self.address), answer="it does not know it")
        return position

    async def get_relative_altitude(self, *, timeout: float | None = None) -> float:
        """Return the altitude above home; wait for it if it was not received (GLOBAL_POSITION_INT).

        Args:
            timeout: Seconds for the whole call; None: until no position has arrived for a while.

        Returns:
            Metres above home.

        Raises:
            MessageTimeout: No position arrived in time, or the vehicle does not know its altitude.
            CommandDenied: The vehicle refused to send its position.
            RemoteCancelled: The connection was closed.
        """
        altitude = (await self.get_position(timeout=timeout)).relative_altitude
        if altitude is None:
            raise MessageTimeout("reading the altitude of", str(self.address), answer="it does not know it")
        return altitude

    def __repr__(self) -> str:
        return f"<Vehicle {self.address}>"
