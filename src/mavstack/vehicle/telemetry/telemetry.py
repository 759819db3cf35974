"""The telemetry of one vehicle: the latest packet of each message from each component of its system.

The core keeps the packets as received (`mavstack._core.Intake`), and they are decoded when a value is read:
messages that no program reads cost nothing in Python. A value belongs to the autopilot unless a component is
named: a camera or a gimbal may send an ATTITUDE of its own.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar, overload

from mavstack.dialects import Message, common
from mavstack.errors import CommandDenied, MavstackError, MessageTimeout
from mavstack.node.api_object import LoopBound
from mavstack.node.host import host_of
from mavstack.services.version import AutopilotVersion
from mavstack.vehicle.firmware import firmware_class
from mavstack.vehicle.telemetry.rates import Rates
from mavstack.vehicle.telemetry.status_texts import StatusTexts

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.node import Node, RemoteComponent
    from mavstack.node.dispatch import Listener
    from mavstack.vehicle.firmware import Firmware
    from mavstack.wire import Packet

AnyMessage = TypeVar("AnyMessage", bound=Message)
Second = TypeVar("Second", bound=Message)
Third = TypeVar("Third", bound=Message)

#: The number of ports of RC_CHANNELS_RAW that are stored; each has 8 channels.
MAX_RC_PORTS = 4
#: A coarse message counts only if the finer message is older by more than this, in seconds.
FINE_LIFETIME = 10.0
#: Components that are batteries; the autopilot's report of a battery is preferred.
_BATTERIES = (common.MavComponent.BATTERY, common.MavComponent.BATTERY2)


class Telemetry(LoopBound):
    """The messages of one vehicle's system, and the rates requested from its autopilot."""

    def __init__(self, node: Node, component: RemoteComponent) -> None:
        self.node = node
        #: The autopilot.
        self.component = component
        #: The message rates that are requested from the autopilot.
        self.rates = Rates(node, component, self.age)
        #: The status texts of the whole system.
        self.status_texts = StatusTexts(node.address, self.now)
        #: The time when the vehicle last reported that it is ready to arm, in Unix seconds.
        self.ready_at: float | None = None
        #: The time since which the vehicle reports without a break that it is ready to arm, in Unix seconds;
        #: None: it does not report it.
        self.ready_since: float | None = None
        #: The time of the last reboot, in Unix seconds; the health is not read from messages before it.
        self.rebooted_at = 0.0
        #: True if HOME_POSITION was requested and the vehicle had none.
        self.home_refused = False
        self._intake = host_of(node).intake
        self._batteries: dict[tuple[int, int], common.BatteryStatus] = {}
        self._rc_ports: dict[int, common.RcChannelsRaw] = {}
        self._distances: dict[int, tuple[common.DistanceSensor, float]] = {}
        self._system = system = component.address.system
        self._intake.follow(system)
        self._listeners: tuple[Listener, ...] = (
            node.add_packet_listener(common.Statustext, self.status_texts.receive, system=system),
            node.add_packet_listener(common.BatteryStatus, self._store_battery, system=system),
            node.add_packet_listener(common.RcChannelsRaw, self._store_rc_port, system=system),
            node.add_packet_listener(common.DistanceSensor, self._store_distance, system=system),
            node.add_packet_listener(common.SysStatus, self._receive_status, system=system),
        )
        _ = component.modes.current  # the first access starts to follow the mode

    @property
    def autopilot(self) -> int | None:
        """The MAV_AUTOPILOT of the heartbeat."""
        info = self.component.info
        return None if info is None else info.autopilot

    @property
    def firmware(self) -> type[Firmware]:
        """The class that tells how the firmware reports its state."""
        info = self.component.info
        return firmware_class(None) if info is None else firmware_class(info.autopilot, info.identifier)

    @property
    def version(self) -> AutopilotVersion | None:
        """The AUTOPILOT_VERSION; None before it was received."""
        message = self.latest(common.AutopilotVersion)
        return None if message is None else AutopilotVersion.read(message)

    def forget(self) -> None:
        """Forget the messages: they may be those of another vehicle with the same system id."""
        self._intake.clear(self._system)
        self._batteries.clear()
        self._distances.clear()

    # The latest messages

    def latest(self, message: type[AnyMessage], component: int | None = None) -> AnyMessage | None:
        """Return the last message of a class, from the autopilot unless a component is named."""
        stored = self._intake.latest(self._source(component), message.__mavlink_row__[0])
        found = None if stored is None else stored[0].message
        return found if isinstance(found, message) else None

    def latest_with_time(self, message: type[AnyMessage]) -> tuple[AnyMessage, float] | None:
        """Return the last message of a class from the autopilot, and when it was received in Unix seconds."""
        stored = self._intake.latest(self.component.address, message.__mavlink_row__[0])
        if stored is None:
            return None
        packet, received_at = stored
        found = packet.message
        return (found, received_at) if isinstance(found, message) else None

    def reader(self, message: type[Message]) -> Callable[[], tuple[Packet, float] | None]:
        """Return a function that returns the autopilot's latest packet of a message, and when it arrived.

        For programs that read the same message of hundreds of vehicles again and again.
        """
        return partial(self._intake.latest, self.component.address, message.__mavlink_row__[0])

    def received_at(self, message: type[Message], component: int | None = None) -> float | None:
        """Return the time when the last message of a class was received, in Unix seconds."""
        return self._intake.received_at(self._source(component), message.__mavlink_row__[0])

    def age(self, message: type[Message], component: int | None = None) -> float | None:
        """Return the seconds since the last message of a class was received."""
        received_at = self.received_at(message, component)
        return None if received_at is None else self.now() - received_at

    def now(self) -> float:
        """Return the node's time; after the node was closed, the time of the last message."""
        return self.node.now() if self.node.is_open else self._intake.newest_time(self._system) or 0.0

    @overload
    def newest(self, first: type[AnyMessage], second: type[Second], /) -> AnyMessage | Second | None: ...
    @overload
    def newest(
        self, first: type[AnyMessage], second: type[Second], third: type[Third], /
    ) -> AnyMessage | Second | Third | None: ...
    def newest(self, *messages: type[Any]) -> Any:
        """Return the message of these classes that was received last."""
        times = [(time, message) for message in messages if (time := self.received_at(message)) is not None]
        return self.latest(max(times, key=lambda each: each[0])[1]) if times else None

    @overload
    def finest(self, first: type[AnyMessage], coarse: type[Second], /) -> AnyMessage | Second | None: ...
    @overload
    def finest(
        self, first: type[AnyMessage], second: type[Second], coarse: type[Third], /
    ) -> AnyMessage | Second | Third | None: ...
    def finest(self, *messages: type[Any]) -> Any:
        """Return the newest message of these classes, the last one only if the others are much older."""
        *fine, coarse = messages
        times = [time for message in fine if (time := self.received_at(message)) is not None]
        coarse_at = self.received_at(coarse)
        if times and (coarse_at is None or max(times) >= coarse_at - FINE_LIFETIME):
            return self.latest(max(fine, key=lambda message: self.received_at(message) or 0.0))
        return self.latest(coarse)

    def battery_messages(self) -> dict[int, common.BatteryStatus]:
        """Return the last BATTERY_STATUS of each battery, by its id."""
        found: dict[int, common.BatteryStatus] = {}
        for source in (*_BATTERIES, self.component.address.component):
            found |= {each.id: each for (sender, _), each in self._batteries.items() if sender == source}
        return found

    def rc_ports(self) -> dict[int, common.RcChannelsRaw]:
        """Return the last RC_CHANNELS_RAW of each port; port 0 holds the first eight channels."""
        return dict(self._rc_ports)

    # Requests

    async def ensure(self, message: type[Message], rate: float) -> bool:
        """Keep a message at `rate` hertz or more permanently; return False if refused or not answered."""
        return await self.rates.ensure(message, rate)

    async def request_home(self) -> None:
        """Request HOME_POSITION, unless it was received."""
        if self.latest(common.HomePosition) is None:
            try:
                await self.component.request_message(common.HomePosition)
            except (CommandDenied, MessageTimeout):
                self.home_refused = True
            except MavstackError:
                return  # the node was closed, or the vehicle does not answer
            else:
                self.home_refused = False

    async def close(self) -> None:
        """Unregister all listeners, and request nothing more."""
        for listener in self._listeners:
            listener.close()
        if self._listeners:
            self._intake.unfollow(self._system)
        self._listeners = ()
        await self.rates.close()

    # Received packets

    def _store_battery(self, packet: Packet) -> None:
        own = self.component.address.component
        if packet.component == own or packet.component in _BATTERIES:
            self._batteries[packet.component, packet.message.id] = packet.message

    def _store_distance(self, packet: Packet) -> None:
        message = packet.message
        is_own = packet.component == self.component.address.component
        if is_own and isinstance(message, common.DistanceSensor):
            self._distances[message.id] = message, self.now()

    def distance_sensors(self, max_age: float) -> dict[int, common.DistanceSensor]:
        """Return the last message of each rangefinder that is not older than some seconds, by its id."""
        now = self.now()
        return {number: message for number, (message, at) in self._distances.items() if now - at <= max_age}

    def _store_rc_port(self, packet: Packet) -> None:
        port = packet.message.port
        if packet.component == self.component.address.component and port < MAX_RC_PORTS:
            self._rc_ports[port] = packet.message

    def _receive_status(self, packet: Packet) -> None:
        if packet.component == self.component.address.component:
            health = packet.message.onboard_control_sensors_health
            ready = bool(health & common.MavSysStatusSensor.PREARM_CHECK)
            now = self.node.now()
            self.ready_at = now if ready else self.ready_at
            self.ready_since = (self.ready_since or now) if ready else None

    def _source(self, component: int | None) -> tuple[int, int]:
        return self.component.address if component is None else (self._system, int(component))
