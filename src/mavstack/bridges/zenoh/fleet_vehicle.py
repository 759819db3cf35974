"""One vehicle on Zenoh: its packets, messages, states, commands and its liveliness token.

Nothing is converted without a subscriber, except the snapshots, which late subscribers get. Samples are put
with `DROP`, which never blocks: a slow network loses samples, and the vehicle is not delayed.
"""

from __future__ import annotations

import logging
import time
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.calls import CALLS, VehicleCalls
from mavstack.bridges.core.plain_json import json_bytes, parse_object
from mavstack.bridges.core.services.context import ServiceContext
from mavstack.bridges.core.snapshots import GROUPS
from mavstack.bridges.zenoh.frame_batch import samples_of
from mavstack.bridges.zenoh.frame_guard import FrameGuard
from mavstack.bridges.zenoh.keys import VehicleKeys, command_of
from mavstack.bridges.zenoh.message_publisher import MessagePublishers
from mavstack.bridges.zenoh.request_log import MAX_ID, RequestLog
from mavstack.errors import InvalidArgumentError, InvalidStateError
from mavstack.security.roles import Role

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine

    from mavstack.bridges.zenoh.bus import Bus
    from mavstack.node.dispatch import Listener
    from mavstack.vehicle import Vehicle
    from mavstack.wire import Packet

logger = logging.getLogger("mavstack.bridges")
_JSON: Final = "application/json"


class FleetVehicle:
    """The endpoints of one vehicle.

    Args:
        vehicle: The vehicle.
        keys: Its keys.
        bus: The session, and the queues into the event loop.
        role: The role of the bus: which packets and commands are passed to the vehicle.
        batch_pending: Called with this vehicle when packets begin to wait for `flush`.
    """

    def __init__(
        self,
        vehicle: Vehicle,
        keys: VehicleKeys,
        bus: Bus,
        role: Role,
        batch_pending: Callable[[FleetVehicle], None],
    ) -> None:
        self.vehicle = vehicle
        self.keys = keys
        #: The other gateways that serve a vehicle with this name.
        self.rivals: set[str] = set()
        #: The filter of packets for the vehicle, with its counters.
        self.guard = FrameGuard(vehicle.system, role, vehicle.connection.dialect)
        #: True if there is a subscriber to a state.
        self.is_watched = False
        #: The requests that were carried out.
        self.requests = RequestLog()
        self._bus = bus
        self._role = role
        self._waiting: list[bytes] = []
        self._batch_pending = batch_pending
        self._calls = VehicleCalls(vehicle, role, ServiceContext(_ignore))
        self._messages = MessagePublishers(bus, keys)
        #: The groups as they were read last, and as they were published.
        self._read: dict[str, Any] = {}
        self._states: dict[str, bytes] = {}
        self._state_publishers: dict[str, Any] = {}
        self._frames: Any = None
        self._listeners: dict[str, Listener] = {}
        self._token: Any = None
        self._kept: list[Any] = []  # a declaration ends when its object is deleted

    def open(self) -> None:
        """Declare the endpoints."""
        bus, keys = self._bus, self.keys
        self._frames = bus.publisher(keys.frames_out, self._set_frames)
        wanted = bus.publisher(keys.messages, self._set_messages)
        watched = bus.publisher(keys.state("*"), self._set_watched)
        self._kept += [wanted, watched, bus.queryable(keys.state("*"), self._answer_state)]
        self._kept.append(bus.queryable(keys.commands, self._answer_command))
        for group in GROUPS:
            self._state_publishers[group] = bus.latched_publisher(keys.state(group))
        if self._role > Role.OBSERVE:
            self._kept.append(bus.subscriber(keys.frames_in, self._receive_frames))
        self.set_connected(connected=True)

    async def close(self) -> None:
        """Withdraw the endpoints."""
        for listener in self._listeners.values():
            listener.close()
        self._listeners.clear()
        self._messages.close()
        await self.requests.close()
        declared = (self._token, self._frames, *self._kept, *self._state_publishers.values())
        for each in declared:
            if each is not None:
                self._bus.undeclare(each)
        self._kept.clear()
        self._state_publishers.clear()
        self._token = self._frames = None

    def set_connected(self, *, connected: bool) -> None:
        """Show by the token whether heartbeats of the vehicle arrive."""
        if connected and self._token is None:
            self._token = self._bus.token(self.keys.alive(self._bus.gateway))
        elif not connected and self._token is not None:
            self._bus.undeclare(self._token)
            self._token = None
        self.publish_states()

    # From the vehicle

    def publish_states(self) -> None:
        """Publish the groups of the state that have changed."""
        for group, publisher in self._state_publishers.items():
            state = GROUPS[group](self.vehicle)
            if state is None or state == self._read.get(group):
                continue
            self._read[group] = state
            data = json_bytes(state)
            if data != self._states.get(group):
                self._states[group] = data
                publisher.put(data, encoding=_JSON)

    def flush(self) -> None:
        """Put the packets that wait."""
        packets, self._waiting = self._waiting, []
        if self._frames is not None:
            for sample in samples_of(packets):
                self._frames.put(sample)

    def _set_frames(self, matching: bool) -> None:
        self._listen("frames", self._on_packet if matching else None)

    def _set_messages(self, matching: bool) -> None:
        self._listen("messages", self._messages.publish if matching else None)

    def _set_watched(self, matching: bool) -> None:
        self.is_watched = matching
        if matching:
            self.publish_states()

    def _listen(self, name: str, receive: Callable[[Packet], None] | None) -> None:
        if (listener := self._listeners.pop(name, None)) is not None:
            listener.close()
        if receive is not None:
            node, system = self.vehicle.connection, self.vehicle.system
            self._listeners[name] = node.add_packet_listener(None, receive, system=system)

    def _on_packet(self, packet: Packet) -> None:
        # Each packet of a fleet comes here: no calls.
        if not self._waiting:
            self._batch_pending(self)
        self._waiting.append(packet.raw)

    # To the vehicle

    def _receive_frames(self, sample: Any) -> None:
        if self.rivals:
            self.guard.refused["two gateways serve the vehicle"] += 1
            return
        stamp = sample.timestamp
        source, seconds = ("", None) if stamp is None else (str(stamp.get_id()), stamp.get_time().timestamp())
        for packet in self.guard.accept(bytes(sample.payload), source, seconds, time.time()):
            with suppress(InvalidStateError):  # raised while the connection closes
                self.vehicle.connection.forward(packet, self.vehicle.address)

    async def _answer_state(self, query: Any) -> None:
        self.publish_states()
        for group, data in self._states.items():
            key = self.keys.state(group)
            if query.key_expr.intersects(self._bus.zenoh.KeyExpr(key)):
                query.reply(key, data, encoding=_JSON)

    async def _answer_command(self, query: Any) -> None:
        name = command_of(str(query.key_expr))
        if not name:
            return  # a query with a wildcard must not run a command
        if name not in CALLS:
            query.reply_err(json_bytes({"ok": False, "reason": f"there is no command {name!r:.60}"}))
            return
        parameters = dict(query.parameters)
        payload = b"" if query.payload is None else bytes(query.payload)

        def work() -> Coroutine[Any, Any, bytes]:
            return self._carry_out(name, payload, parameters.get("expires", ""))

        identity = parameters.get("id", "")[:MAX_ID]
        answer = await self.requests.answer(identity and f"{name} {identity}", work)
        query.reply(self.keys.command(name), answer, encoding=_JSON)

    async def _carry_out(self, name: str, payload: bytes, expires: str) -> bytes:
        try:
            if self.rivals and CALLS[name].role > Role.OBSERVE:
                others = ", ".join(sorted(self.rivals))
                raise InvalidStateError(
                    f"{name} of vehicle {self.keys.name} failed: the gateway {others} serves a vehicle of "
                    "this name too; give them names with --name"
                )
            _check_time(name, expires)
            request = parse_object(payload)
        except (InvalidArgumentError, InvalidStateError) as error:
            return json_bytes({"ok": False, "reason": str(error)})
        return json_bytes(await self._calls.call(name, request))


def _check_time(name: str, expires: str) -> None:
    """Raise InvalidStateError if a request arrives later than its sender allows."""
    try:
        late = time.time() - float(expires) if expires else 0.0
    except ValueError:
        raise InvalidArgumentError(f"expires must be Unix time in seconds, got {expires!r:.40}") from None
    if not late <= 0.0:
        raise InvalidStateError(f"{name} failed: the request arrived {late:.1f} s after it expired")


def _ignore(name: str, values: object) -> None:
    """Services publish plans as topics, which this bus does not have."""
