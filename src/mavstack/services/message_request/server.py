"""The message server: streams of messages at rates that clients can change, and single messages on request.

A producer makes a message when it is due, so that its content is current. Streams have the priority of
telemetry: on a full link a message waits until there is room, is made then, and missed ones are skipped. The
most overdue message goes first, so that all messages are thinned alike. A message that is made of values from
elsewhere is streamed by `trigger`: when a new value is there, and not more often than at its interval.

The commands are answered through the component's `CommandServer`; this service handles their ids only so that
the engine collects its messages after them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from heapq import heapify, heapreplace
from math import inf, isfinite, isnan
from typing import TYPE_CHECKING, TypeAlias

from mavstack.dialects import Message, common
from mavstack.services.addressing import BROADCAST, Address, message_ids
from mavstack.services.message_request.interval import MAX_INTERVAL, message_id_of, stream_groups
from mavstack.services.message_request.legacy_requests import legacy_request
from mavstack.services.service import HasRoom, Outgoing, Priority, Service, always_room

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from mavstack.services.command import CommandRequest, CommandServer
    from mavstack.wire import Packet

#: The result of a producer: one message, several messages (of all instances, such as gimbals), or None if
#: there is no message.
Made: TypeAlias = Message | Sequence[Message] | None
#: Makes a message for a time in Unix seconds.
Producer: TypeAlias = Callable[[float], Made]
#: Makes the message of an index or id (param 2 of a request) for a time in Unix seconds. For the index 0 it
#: makes the messages of all instances, where the definition of the message says so.
InstanceProducer: TypeAlias = Callable[[float, float], Made]

#: The shortest interval of a message, whatever is requested, in microseconds.
MIN_INTERVAL = 1_000
#: Seconds after which a stream tries again because the link had no room.
RETRY = 0.5

#: The fraction of an interval by which a triggered message may come early, because values do not arrive
#: exactly in time.
_EARLY = 0.25

_REQUESTER, _BROADCAST = 1, 2
_INTERVAL_ID = next(iter(message_ids(common.MessageInterval)))


@dataclass(slots=True)
class _Stream:
    """A message's producer and its interval in microseconds, -1 if off."""

    produce: Producer
    default: int
    interval: int
    #: Time of the next message; infinite if none is due.
    due: float
    triggered: bool = False
    #: Time of the next transmission of each message that the program triggers.
    slot: float = 0.0

    def set_interval(self, microseconds: int, now: float) -> None:
        self.interval = microseconds
        self.due = now if microseconds > 0 and not self.triggered else inf
        self.slot = now

    def trigger(self, now: float) -> bool:
        """Make a triggered stream due; returns False if it is off, or was sent too recently."""
        if self.interval <= 0 or now < self.slot - _EARLY * self.interval / 1e6 or self.due < inf:
            return False
        self.due = now
        return True

    def sent(self, now: float) -> float:
        """Record that the message was sent; returns when it is due again."""
        seconds = self.interval / 1e6
        if self.triggered:
            # The slots keep their interval, so that early and late values do not change the rate in the long
            # run.
            self.slot = self.slot + seconds if now < self.slot + seconds else now + seconds
            self.due = inf
            return inf
        due = self.due + seconds
        self.due = due = due if due > now else now + seconds
        return due


class MessageServer(Service):
    """The messages of one component: streams, their rates, and single requests."""

    handles = message_ids(common.CommandLong, common.CommandInt, common.RequestDataStream)

    def __init__(self, local: Address, commands: CommandServer) -> None:
        super().__init__(local)
        self._commands = commands
        self._streams: dict[int, _Stream] = {}
        #: The messages of each supported group of REQUEST_DATA_STREAM. Without an entry for
        #: MAV_DATA_STREAM_ALL, that group means all messages that are streamed by default. If the mapping is
        #: empty, such requests are ignored.
        self.data_streams: Mapping[int, frozenset[int]] = stream_groups()
        self._instances: dict[int, InstanceProducer] = {_INTERVAL_ID: self._message_interval}
        self._retry_at: float | None = None
        #: The streams by due time, as a heap; None if a change requires a new heap.
        self._queue: list[tuple[float, int, _Stream]] | None = None
        self._others = commands.handler_of(common.MavCmd.REQUEST_MESSAGE)
        commands.support(common.MavCmd.REQUEST_MESSAGE, self._request_message)
        commands.support(common.MavCmd.SET_MESSAGE_INTERVAL, self._set_message_interval)
        self._support_legacy(_INTERVAL_ID)

    def provide(
        self,
        message: type[Message] | int,
        producer: Producer,
        *,
        interval: float = 0.0,
        now: float = 0.0,
        triggered: bool = False,
    ) -> None:
        """Publish a message.

        Args:
            message: The message class or id.
            producer: Makes the message.
            interval: Seconds between two messages by default; 0: only on request.
            now: When the stream begins, Unix seconds.
            triggered: Stream it when `trigger` is called, and not more often than at its interval.
        """
        message_id = message_id_of(message)
        microseconds = _microseconds(interval)
        due = now if microseconds > 0 and not triggered else inf
        self._queue = None
        self._streams[message_id] = _Stream(producer, microseconds, microseconds, due, triggered)
        self._support_legacy(message_id)

    def trigger(self, message: type[Message] | int, now: float) -> None:
        """Send a triggered message as soon as there is room, unless it is off or was sent too recently."""
        if self._streams[message_id_of(message)].trigger(now):
            self._queue = None

    def set_interval(self, message: type[Message] | int, interval: float, now: float) -> None:
        """Change the default interval of a message, seconds; 0: only on request."""
        stream = self._streams[message_id_of(message)]
        stream.default = _microseconds(interval)
        self._change(stream, stream.default, now)

    def stop_streams(self, now: float) -> None:
        """Send every message on request only, until its interval is set again."""
        for stream in self._streams.values():
            stream.default = 0
            self._change(stream, 0, now)

    def provide_instances(self, message: type[Message] | int, producer: InstanceProducer) -> None:
        """Answer requests for a message of which there are several, by index or id."""
        message_id = message_id_of(message)
        self._instances[message_id] = producer
        self._support_legacy(message_id)

    def interval_of(self, message: type[Message] | int) -> int:
        """Return the interval of a message in microseconds: -1 if it is not streamed, 0 if it is unknown."""
        message_id = message_id_of(message)
        stream = self._streams.get(message_id)
        return stream.interval if stream else -1 if message_id in self._instances else 0

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.RequestDataStream() as request:
                self._request_data_stream(request, Address(packet.system, packet.component), now)

    def bulk_messages(self, now: float, has_room: HasRoom = always_room) -> Iterator[Outgoing]:
        self._retry_at = None
        queue = self._queued()
        while queue and queue[0][0] <= now:
            if not has_room(BROADCAST, Priority.STREAM):
                self._retry_at = now + RETRY
                return
            _, order, stream = queue[0]
            heapreplace(queue, (stream.sent(now), order, stream))
            for message in _each(stream.produce(now)):
                yield Outgoing(message, BROADCAST, Priority.STREAM)
            queue = self._queued()  # a new heap, if a rate has changed

    def next_timeout(self) -> float | None:
        if self._retry_at is not None:
            return self._retry_at
        queue = self._queued()
        return queue[0][0] if queue else None

    def _queued(self) -> list[tuple[float, int, _Stream]]:
        if self._queue is None:
            streams = enumerate(self._streams.values())
            self._queue = [(stream.due, order, stream) for order, stream in streams if stream.due < inf]
            heapify(self._queue)
        return self._queue

    def _support_legacy(self, message_id: int) -> None:
        legacy = legacy_request(message_id)
        if legacy is not None:

            def answer(request: CommandRequest) -> common.MavResult:
                return self._send_one(message_id, legacy.instance_in(request.command), BROADCAST, request)

            self._commands.support(legacy.command, answer)

    def _request_message(
        self, request: CommandRequest
    ) -> common.MavResult | tuple[common.MavResult, int] | None:
        message_id, response_target = request.command.param1, request.command.param7
        if self._others and message_id not in self._instances and message_id not in self._streams:
            # the handler of this command that was registered before this service
            return self._others(request)
        target = BROADCAST if response_target == _BROADCAST else request.source
        instance = request.command.param2
        # MAVSDK sends NaN for a param that it does not set.
        return self._send_one(message_id, 0.0 if isnan(instance) else instance, target, request)

    def _send_one(
        self, message_id: float, instance: float, target: Address, request: CommandRequest
    ) -> common.MavResult:
        now = request.received_at
        if message_id in self._instances:
            messages = _each(self._instances[int(message_id)](instance, now))
        elif message_id in self._streams:
            messages = _each(self._streams[int(message_id)].produce(now))
        else:
            return common.MavResult.DENIED
        for message in messages:
            self.send(message, target)
        return common.MavResult.ACCEPTED if messages else common.MavResult.FAILED

    def _set_message_interval(self, request: CommandRequest) -> common.MavResult:
        wanted = request.command.param2
        stream = self._streams.get(_whole(request.command.param1))
        if stream is None or not isfinite(wanted) or wanted < -1:
            return common.MavResult.DENIED
        self._change(stream, -1 if wanted < 0 else round(wanted) or stream.default, request.received_at)
        return common.MavResult.ACCEPTED

    def _change(self, stream: _Stream, microseconds: int, now: float) -> None:
        if microseconds > 0:
            microseconds = min(max(microseconds, MIN_INTERVAL), MAX_INTERVAL)
        if microseconds != stream.interval:
            stream.set_interval(microseconds, now)
            self._queue = None

    def _message_interval(self, instance: float, now: float) -> Message | None:
        message_id = _whole(instance)
        if not 0 <= message_id <= 0xFFFF:
            return None
        return common.MessageInterval(message_id=message_id, interval_us=self.interval_of(message_id))

    def _request_data_stream(self, request: common.RequestDataStream, source: Address, now: float) -> None:
        group, rate = int(request.req_stream_id), request.req_message_rate
        on = bool(request.start_stop) and rate > 0
        if not self.data_streams:
            return
        members = self.data_streams.get(group)
        everything = members is None and group == common.MavDataStream.ALL
        for message_id, stream in self._streams.items():
            if (everything and (stream.default > 0 or not on)) or (members and message_id in members):
                self._change(stream, round(1e6 / rate) if on else -1, now)
        self.send(common.DataStream(stream_id=group, message_rate=rate, on_off=int(on)), source)


def _each(made: Made) -> Sequence[Message]:
    """Return the messages that a producer made."""
    if made is None:
        return ()
    return (made,) if isinstance(made, Message) else made


def _microseconds(interval: float) -> int:
    """Convert an interval from seconds to microseconds: -1 for none."""
    return min(max(round(interval * 1e6), MIN_INTERVAL), MAX_INTERVAL) if interval > 0 else -1


def _whole(value: float) -> int:
    return int(value) if isfinite(value) and value == int(value) else -1
