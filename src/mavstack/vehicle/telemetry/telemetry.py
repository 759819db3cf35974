"""What was heard of a vehicle: the latest packet of each kind from each component of its system.

Packets are kept as they came and decoded when somebody asks, so that what nobody reads costs no more than its
place in a dictionary. A value belongs to the autopilot unless a component is named: a camera or a gimbal may
send an ATTITUDE of its own.
"""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any, TypeVar, overload

from mavstack.dialects import Message, common
from mavstack.errors import CommandDenied, MavstackError, MessageTimeout, RemoteCancelled
from mavstack.services.message_request.interval import name_of
from mavstack.vehicle.telemetry.rates import Rates
from mavstack.vehicle.telemetry.status_texts import StatusTexts
from mavstack.vehicle.telemetry.stream import Stream

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.node import Node, RemoteComponent
    from mavstack.node.dispatch import Listening
    from mavstack.vehicle.telemetry.rates import RateRequest
    from mavstack.wire import Packet

AnyMessage = TypeVar("AnyMessage", bound=Message)
Second = TypeVar("Second", bound=Message)
Third = TypeVar("Third", bound=Message)

#: So many kinds of messages are kept, of all components together; beyond it those heard longest ago go.
MOST_KINDS = 2048
#: A coarse message counts when the finer one is so much older, in seconds.
FRESH = 10.0
#: Components that are batteries and tell of themselves; what the autopilot tells goes first.
_BATTERIES = (common.MavComponent.BATTERY, common.MavComponent.BATTERY2)
_COMPONENT = 24  # a message id has so many bits; above them stands the component


class Telemetry:
    """What is heard of one vehicle; `vehicle.telemetry`."""

    def __init__(self, component: RemoteComponent) -> None:
        self.node: Node = component.node
        #: Its autopilot.
        self.component = component
        #: The rates that it was asked for.
        self.rates = Rates(component, self.age)
        #: What it told people.
        self.status_texts = StatusTexts(self.node.address, self.now)
        #: When it last said that it is ready to arm.
        self.ready_at: float | None = None
        #: Whether it was asked for its home and had none to tell.
        self.home_refused = False
        self._set: dict[int, RateRequest] = {}
        self._latest: dict[int, tuple[Packet, float]] = {}
        self._batteries: dict[tuple[int, int], common.BatteryStatus] = {}
        system = component.address.system
        self._listening: tuple[Listening, ...] = (
            self.node.add_packet_listener(None, self._keep, system=system),
            self.node.add_packet_listener(common.Statustext, self.status_texts.hear, system=system),
            self.node.add_packet_listener(common.BatteryStatus, self._hear_battery, system=system),
            self.node.add_packet_listener(common.SysStatus, self._hear_status, system=system),
        )
        _ = component.modes.monitor  # follows the mode from now on

    @property
    def autopilot(self) -> int | None:
        """The MAV_AUTOPILOT of its heartbeat."""
        info = self.component.info
        return None if info is None else info.autopilot

    # What was heard last

    def latest(self, kind: type[AnyMessage], component: int | None = None) -> AnyMessage | None:
        """The last message of a kind, of the autopilot unless a component is named."""
        kept = self._latest.get(self._key(kind, component))
        message = None if kept is None else kept[0].message
        return message if isinstance(message, kind) else None

    def heard_at(self, kind: type[Message], component: int | None = None) -> float | None:
        """When it was heard, in the node's time."""
        kept = self._latest.get(self._key(kind, component))
        return None if kept is None else kept[1]

    def age(self, kind: type[Message], component: int | None = None) -> float | None:
        """How long ago it was heard, in seconds."""
        heard_at = self.heard_at(kind, component)
        return None if heard_at is None else self.now() - heard_at

    def now(self) -> float:
        """The node's time, or what it was when the node was closed."""
        return (
            self.node.now()
            if self.node.is_open
            else max((time for _, time in self._latest.values()), default=0.0)
        )

    @overload
    def newest(self, first: type[AnyMessage], second: type[Second], /) -> AnyMessage | Second | None: ...
    @overload
    def newest(
        self, first: type[AnyMessage], second: type[Second], third: type[Third], /
    ) -> AnyMessage | Second | Third | None: ...
    def newest(self, *kinds: type[Any]) -> Any:
        """That message of these kinds which was heard last."""
        times = [(heard_at, kind) for kind in kinds if (heard_at := self.heard_at(kind)) is not None]
        return self.latest(max(times, key=lambda each: each[0])[1]) if times else None

    @overload
    def finer(self, first: type[AnyMessage], coarse: type[Second], /) -> AnyMessage | Second | None: ...
    @overload
    def finer(
        self, first: type[AnyMessage], second: type[Second], coarse: type[Third], /
    ) -> AnyMessage | Second | Third | None: ...
    def finer(self, *kinds: type[Any]) -> Any:
        """The newest of these kinds, but the last kind only if the others are much older."""
        *fine, coarse = kinds
        heard = [time for kind in fine if (time := self.heard_at(kind)) is not None]
        coarse_at = self.heard_at(coarse)
        if heard and (coarse_at is None or max(heard) >= coarse_at - FRESH):
            return self.latest(max(fine, key=lambda kind: self.heard_at(kind) or 0.0))
        return self.latest(coarse)

    def battery_messages(self) -> dict[int, common.BatteryStatus]:
        """The last BATTERY_STATUS of each battery, by its id."""
        told: dict[int, common.BatteryStatus] = {}
        for source in (*_BATTERIES, self.component.address.component):
            told |= {each.id: each for (sender, _), each in self._batteries.items() if sender == source}
        return told

    # What comes from now on

    def stream(
        self, *kinds: type[AnyMessage], rate: float | None = None, queue: int = 1000
    ) -> Stream[AnyMessage]:
        """The autopilot's messages of these classes, as they come; see `Stream`."""
        return Stream(self, kinds, rate, queue)

    async def wait_for_message(self, kind: type[AnyMessage], *, timeout: float = 10.0) -> AnyMessage:
        """The next message of a kind; raises `MessageTimeout`, or `CommandDenied` if the vehicle has none."""
        what, whom = name_of(kind), str(self.component.address)
        async with self.stream(kind) as messages:
            try:
                async with asyncio.timeout(timeout):
                    return await anext(messages)
            except TimeoutError:
                raise MessageTimeout(what, whom, answer=f"none came in {timeout:g} s") from None
            except StopAsyncIteration:
                raise RemoteCancelled(what, whom, answer="the connection was closed") from None

    def add_listener(
        self, kind: type[AnyMessage], callback: Callable[[AnyMessage], object], component: int | None = None
    ) -> Listening:
        """Call a function with each message of a kind, at once; what it raises goes to the loop's handler."""
        system, autopilot = self.component.address
        name = name_of(kind)

        def hear(packet: Packet) -> None:
            try:
                callback(packet.message)
            except Exception as error:  # noqa: BLE001 (a defect of the program must not deafen the link)
                told = {"message": f"the callback for {name} failed", "exception": error}
                asyncio.get_running_loop().call_exception_handler(told)

        source = autopilot if component is None else component
        return self.node.add_packet_listener(kind, hear, system=system, component=source)

    async def ensure(self, kind: type[Message], rate: float) -> bool:
        """Have a message come at least about so often for good; False if the vehicle refused or is silent."""
        return await self.rates.ensure(kind, rate)

    async def set_message_rate(self, kind: type[Message], rate: float | None) -> None:
        """Have a message come so many times a second for good, or no longer; raises what `Rates.ask` does."""
        number = self._key(kind, 0)
        before = self._set.pop(number, None)
        if rate is not None:
            self._set[number] = self.rates.hold(kind, rate)
        if before is not None:
            self.rates.release(before)
        await self.rates.ask(kind)

    async def ask_for_home(self) -> None:
        """Ask for HOME_POSITION, unless it was heard."""
        if self.latest(common.HomePosition) is None:
            try:
                await self.component.request_message(common.HomePosition)
            except (CommandDenied, MessageTimeout):
                self.home_refused = True
            except MavstackError:
                return  # closed, or nobody there
            else:
                self.home_refused = False

    async def close(self) -> None:
        """Hear and ask nothing more."""
        for listening in self._listening:
            listening.close()
        await self.rates.close()

    # Each packet, as it comes

    def _keep(self, packet: Packet) -> None:
        latest = self._latest
        latest[packet.component << _COMPONENT | packet.message_id] = packet, self.node.now()
        if len(latest) > MOST_KINDS:
            self._forget_old()

    def _forget_old(self) -> None:
        by_age = sorted(self._latest.items(), key=lambda item: item[1][1], reverse=True)
        self._latest = dict(by_age[: MOST_KINDS // 2])

    def _hear_battery(self, packet: Packet) -> None:
        own = self.component.address.component
        if packet.component == own or packet.component in _BATTERIES:
            self._batteries[packet.component, packet.message.id] = packet.message

    def _hear_status(self, packet: Packet) -> None:
        if packet.component == self.component.address.component:
            health = packet.message.onboard_control_sensors_health
            if health & common.MavSysStatusSensor.PREARM_CHECK:
                self.ready_at = self.node.now()

    def _key(self, kind: type[Message], component: int | None) -> int:
        source = self.component.address.component if component is None else component
        return int(source << _COMPONENT | kind.__mavlink_row__[0])
