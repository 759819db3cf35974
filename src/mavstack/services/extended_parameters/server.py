"""The extended parameter server (guide: extended parameter protocol).

A set is acknowledged: to all components if it was accepted, so that they know the new value, else to the
client. A handler may accept or refuse a value at once, or return None for a long change: then IN_PROGRESS is
sent, and the program ends the change with `complete`. A repetition of a running change gets IN_PROGRESS
again, one of a recently ended change the same result; a value that the parameter already has is accepted.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeAlias

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.addressing import BROADCAST, Address, message_ids
from mavstack.services.extended_parameters.value import (
    ExtendedParameter,
    ExtendedValue,
    decode,
    encode,
    field_of,
    is_known,
    usual_type,
    with_field,
)
from mavstack.services.parameters.packed import MAX_PARAMETERS
from mavstack.services.parameters.reorder_filter import ReorderFilter
from mavstack.services.parameters.value import name_field
from mavstack.services.service import Event, HasRoom, Outgoing, Service, always_room

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.wire import Packet

MAX_LISTS = 32
MAX_READS = 256
MAX_ENDED = 256
#: Seconds after the end of a long change for which a repeated request is recognised.
REPETITION_WINDOW = 5.0
BURST = 16
BURST_INTERVAL = 0.004
#: Seconds between two IN_PROGRESS.
PROGRESS_INTERVAL = 2.0


@dataclass(eq=False, slots=True)
class ExtendedSetRequest:
    """A client's request to set a value."""

    parameter: ExtendedParameter
    source: Address
    received_at: float
    progress_due: float = field(default=0.0, repr=False)


@dataclass(frozen=True, slots=True)
class ExtendedParameterWritten(Event):
    """A client set a parameter; `previous` is the value before."""

    parameter: ExtendedParameter
    previous: ExtendedValue
    source: Address


@dataclass(frozen=True, slots=True)
class ExtendedSetStarted(Event):
    """A long change started; end it with `complete`."""

    request: ExtendedSetRequest


#: The handler of a new value: returns its PARAM_ACK, or None for a change that takes longer.
Handler: TypeAlias = Callable[[ExtendedSetRequest], "common.ParamAck | None"]


class ExtendedParameterServer(Service):
    """The extended parameter server; parameters without a handler accept any value of their type."""

    handles = message_ids(common.ParamExtRequestList, common.ParamExtRequestRead, common.ParamExtSet)

    def __init__(self, local: Address) -> None:
        super().__init__(local)
        self._parameters: dict[str, ExtendedParameter] = {}
        self._order: list[str] = []
        self._handlers: dict[str, Handler] = {}
        self._running: dict[str, ExtendedSetRequest] = {}
        self._ended: OrderedDict[tuple[Address, str], tuple[bytes, int, float]] = OrderedDict()
        self._set_filters: OrderedDict[tuple[Address, str], ReorderFilter] = OrderedDict()
        self._lists: OrderedDict[Address, int] = OrderedDict()
        self._reads: OrderedDict[tuple[Address, str], None] = OrderedDict()
        self._next_burst: float | None = None
        self._left_in_burst = BURST

    # Methods for the program

    def add(
        self, name: str, value: ExtendedValue, kind: int | None = None, *, handler: Handler | None = None
    ) -> None:
        """Add a parameter; its type follows from the value if `kind` is None."""
        kind = usual_type(value) if kind is None else kind
        if name in self._parameters or len(self._parameters) >= MAX_PARAMETERS:
            raise InvalidArgumentError(f"cannot add parameter {name}: it exists, or the table is full")
        held = decode(encode(value, kind), kind)
        self._parameters[name_field(name)] = ExtendedParameter(name, held, kind, len(self._order))
        self._order.append(name)
        if handler is not None:
            self._handlers[name] = handler

    def __getitem__(self, name: str) -> ExtendedValue:
        """Return the value of a parameter."""
        return self._parameters[name].value

    def set(self, name: str, value: ExtendedValue) -> None:
        """Set a parameter by the program, and broadcast it if it changed."""
        old = self._parameters[name]
        if encode(value, old.type) != encode(old.value, old.type):
            self._store(name, encode(value, old.type))
            self.send(self._value_message(name), BROADCAST)

    def complete(self, request: ExtendedSetRequest, result: int, now: float) -> None:
        """End a long change with a PARAM_ACK. Idempotent."""
        name = request.parameter.name
        if self._running.get(name) is request:
            del self._running[name]
            self._end(request, result, now)

    @property
    def running(self) -> tuple[ExtendedSetRequest, ...]:
        """The running long changes."""
        return tuple(self._running.values())

    # Methods of a service

    def receive(self, packet: Packet, now: float) -> None:
        source = Address(packet.system, packet.component)
        match packet.message:
            case common.ParamExtRequestList():
                self._list_requested(source)
            case common.ParamExtRequestRead(param_index=index, param_id=name):
                self._read_requested(source, name, index)
            case common.ParamExtSet() as message:
                self._set_requested(source, message, packet.sequence, now)

    def bulk_messages(self, now: float, has_room: HasRoom = always_room) -> Iterator[Outgoing]:
        for client, name in tuple(self._reads):
            if has_room(client):
                del self._reads[client, name]
                yield Outgoing(self._value_message(name), client)
        if self._next_burst is not None and now >= self._next_burst:
            self._next_burst, self._left_in_burst = None, BURST
        waiting: dict[Address, None] = {}
        while self._left_in_burst and (client_or_none := self._next_listener(waiting)) is not None:
            if has_room(client_or_none):
                self._left_in_burst -= 1
                yield Outgoing(self._next_of_list(client_or_none), client_or_none)
            else:
                waiting[client_or_none] = None
        if self._left_in_burst < BURST and self._next_burst is None:
            self._next_burst = now + BURST_INTERVAL

    def next_timeout(self) -> float | None:
        times = [request.progress_due for request in self._running.values()]
        return min((*times, *([] if self._next_burst is None else [self._next_burst])), default=None)

    def handle_timeout(self, now: float) -> None:
        if self._next_burst is not None and now >= self._next_burst:
            self._next_burst, self._left_in_burst = None, BURST
        for request in self._running.values():
            if now >= request.progress_due:
                self._send_progress(request, now)

    # Lists and reads

    def _list_requested(self, client: Address) -> None:
        self._lists.pop(client, None)
        if not self._parameters:
            return
        if len(self._lists) >= MAX_LISTS:
            self._lists.popitem(last=False)
        self._lists[client] = 0

    def _next_listener(self, waiting: dict[Address, None]) -> Address | None:
        return next((client for client in self._lists if client not in waiting), None)

    def _next_of_list(self, client: Address) -> common.ParamExtValue:
        entry = self._lists.pop(client)
        if entry + 1 < len(self._parameters):
            self._lists[client] = entry + 1  # this client waits behind the other clients
        return self._value_message(self._order[entry])

    def _read_requested(self, client: Address, name: str, index: int) -> None:
        if index >= 0:
            name = self._order[index] if index < len(self._parameters) else ""
        if name in self._parameters and len(self._reads) < MAX_READS:
            self._reads[client, name] = None

    # Sets

    def _set_requested(self, source: Address, message: common.ParamExtSet, sequence: int, now: float) -> None:
        name, kind, data = message.param_id, int(message.param_type), field_of(message)
        known = self._parameters.get(name)
        if self._was_overtaken(source, name, sequence, now):
            return
        if known is None or kind != known.type or not is_known(kind):
            parameter = known or ExtendedParameter(name, decode(data, kind), kind)
            self.send(_ack(parameter, common.ParamAck.VALUE_UNSUPPORTED), source)
            return
        self._decide(ExtendedSetRequest(ExtendedParameter(name, decode(data, kind), kind), source, now), now)

    def _decide(self, request: ExtendedSetRequest, now: float) -> None:
        name, wanted = request.parameter.name, _data(request.parameter)
        running = self._running.get(name)
        lately = self._ended.get((request.source, name))
        if running is not None:
            if running.source == request.source and _data(running.parameter) == wanted:
                self._send_progress(running, now)
            else:
                self.send(_ack(self._parameters[name], common.ParamAck.FAILED), request.source)
        elif wanted == _data(self._parameters[name]):
            self.send(_ack(self._parameters[name], common.ParamAck.ACCEPTED), request.source)
        elif lately is not None and lately[0] == wanted and now - lately[2] < REPETITION_WINDOW:
            self.send(_ack(self._parameters[name], lately[1]), request.source)
        else:
            self._carry_out(request, now)

    def _carry_out(self, request: ExtendedSetRequest, now: float) -> None:
        handler = self._handlers.get(request.parameter.name)
        result = common.ParamAck.ACCEPTED if handler is None else handler(request)
        if result is not None:
            self._answer(request, result)
            return
        self._running[request.parameter.name] = request
        self._send_progress(request, now)
        self.emit(ExtendedSetStarted(request))

    def _end(self, request: ExtendedSetRequest, result: int, now: float) -> None:
        key = (request.source, request.parameter.name)
        self._ended[key] = (_data(request.parameter), result, now)
        self._ended.move_to_end(key)
        if len(self._ended) > MAX_ENDED:
            self._ended.popitem(last=False)
        self._answer(request, result)

    def _answer(self, request: ExtendedSetRequest, result: int) -> None:
        name = request.parameter.name
        if result != common.ParamAck.ACCEPTED:
            self.send(_ack(self._parameters[name], result), request.source)
            return
        previous = self._parameters[name].value
        self._store(name, _data(request.parameter))
        self.send(_ack(self._parameters[name], result), BROADCAST)
        self.emit(ExtendedParameterWritten(self._parameters[name], previous, request.source))

    def _store(self, name: str, data: bytes) -> None:
        old = self._parameters[name]
        self._parameters[name] = ExtendedParameter(name, decode(data, old.type), old.type, old.index)

    def _send_progress(self, request: ExtendedSetRequest, now: float) -> None:
        request.progress_due = now + PROGRESS_INTERVAL
        self.send(_ack(request.parameter, common.ParamAck.IN_PROGRESS), request.source)

    def _was_overtaken(self, source: Address, name: str, sequence: int, now: float) -> bool:
        """Return whether a newer set of the same client for the same parameter arrived before."""
        newest = self._set_filters.setdefault((source, name), ReorderFilter())
        self._set_filters.move_to_end((source, name))
        if len(self._set_filters) > MAX_ENDED:
            self._set_filters.popitem(last=False)
        return newest.is_reordered(sequence, now)

    def _value_message(self, name: str) -> common.ParamExtValue:
        parameter = self._parameters[name]
        message = common.ParamExtValue(
            param_id=name,
            param_type=parameter.type,
            param_count=len(self._parameters),
            param_index=parameter.index or 0,
        )
        return with_field(message, _data(parameter))


def _data(parameter: ExtendedParameter) -> bytes:
    return encode(parameter.value, parameter.type)


def _ack(parameter: ExtendedParameter, result: int) -> common.ParamExtAck:
    kind = parameter.type
    message = common.ParamExtAck(param_id=parameter.name, param_type=kind, param_result=result)
    return with_field(message, _data(parameter)) if is_known(kind) else message
