"""The parameter server (guide: parameter protocol).

Requested values are sent to the client, changed values to all components. Lists are sent in turns, one value
for each client, as the links to it have room and never more than a burst at once; single values go before
lists. A repeated list request restarts the client's list.

A refused set is answered with PARAM_ERROR, and with the unchanged value, which old clients understand. A
client of MAVLink 1 cannot receive PARAM_ERROR and gets only the value. Types must match in the bytewise
encoding; a cast value is accepted with any type, as by ArduPilot. Setting `_HASH_CHECK` ends the client's
list, as on PX4.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING, TypeAlias

from mavstack.dialects import common
from mavstack.services.addressing import BROADCAST, Address, message_ids
from mavstack.services.parameters.hashing import HASH_NAME
from mavstack.services.parameters.operations import BY_NAME
from mavstack.services.parameters.packed import unpack
from mavstack.services.parameters.reorder_filter import ReorderFilter
from mavstack.services.parameters.table import ParameterDefinition, ParameterTable
from mavstack.services.parameters.value import (
    NO_INDEX,
    Encoding,
    Parameter,
    Value,
    as_type,
    decode,
    encode,
    field_of,
    fitted,
    is_integer,
    is_known,
    same,
    with_field,
)
from mavstack.services.service import Event, HasRoom, Outgoing, Service, always_room

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.wire import Packet

#: Limits of the state that requests of clients can create.
MAX_LISTS = 32
MAX_READS = 256
MAX_SETTERS = 256
#: The number of list entries that are sent at once.
BURST = 32
#: Seconds between two such bursts, because a receiver's buffer is finite.
BURST_INTERVAL = 0.004
#: The position of the hash in the list: it is sent before the first entry.
HASH_FIRST = -1


@dataclass(frozen=True, slots=True)
class ParameterWritten(Event):
    """A client set a parameter; `previous` is the value before."""

    parameter: Parameter
    previous: Value
    source: Address


#: The program's check of a value: returns the reason of a refusal, or None.
Check: TypeAlias = Callable[[ParameterDefinition, Value], "common.MavParamError | None"]


class ParameterServer(Service):
    """The parameter server of one component.

    Args:
        local: The local component.
        encoding: The encoding of values.
        hash_check: Also offer `_HASH_CHECK`; None: with the bytewise encoding.
        check: Checks a value before a client sets it.
    """

    handles = message_ids(common.ParamRequestList, common.ParamRequestRead, common.ParamSet)

    def __init__(
        self,
        local: Address,
        encoding: Encoding = Encoding.BYTEWISE,
        *,
        hash_check: bool | None = None,
        check: Check | None = None,
    ) -> None:
        super().__init__(local)
        self.encoding = encoding
        self.table = ParameterTable()
        self._hash_check = encoding is Encoding.BYTEWISE if hash_check is None else hash_check
        self._check = check
        self._lists: OrderedDict[Address, int] = OrderedDict()  # by client: the next entry to send
        self._reads: OrderedDict[tuple[Address, str], None] = OrderedDict()
        self._set_filters: OrderedDict[tuple[Address, str], ReorderFilter] = OrderedDict()
        self._next_burst: float | None = None
        self._left_in_burst = BURST

    # Methods for the program

    def add(
        self,
        name: str,
        value: Value,
        kind: int | None = None,
        *,
        minimum: Value | None = None,
        maximum: Value | None = None,
        default: Value | None = None,
        read_only: bool = False,
        volatile: bool = False,
    ) -> None:
        """Add a parameter.

        Args:
            name: Its name, 1 to 16 bytes.
            value: Its value.
            kind: Its MAV_PARAM_TYPE; None: INT32 or REAL32, by the value.
            minimum: The smallest value that clients can set; None: no limit.
            maximum: The largest value that clients can set; None: no limit.
            default: Its default; None: `value`.
            read_only: Refuse sets by clients.
            volatile: It changes by itself, and is excluded from the hash.
        """
        default = value if default is None else default
        self.table.add(ParameterDefinition(name, value, kind, minimum, maximum, default, read_only, volatile))

    def __getitem__(self, name: str) -> Value:
        """Return the value of a parameter."""
        return self.table[name].value

    def set(self, name: str, value: Value) -> None:
        """Set a parameter by the program, and broadcast it if it changed."""
        definition = self.table[name]
        held = as_type(name, value, definition.kind)
        changed = not same(held, definition.value)
        definition.value = held
        if changed:
            self.send(self._value_message(name), BROADCAST)

    def load_packed(self, data: bytes, source: Address) -> bool:
        """Set the parameters of an uploaded packed file; returns False, without any change, if it is damaged.

        Unknown parameters and refused values are skipped.
        """
        packed = unpack(data)
        if packed is None or packed.with_defaults:
            return False
        for parameter in packed.parameters:
            definition = self.table.find(parameter.name)
            if definition is not None and self._refusal(definition, parameter.value) is None:
                self._write(definition, parameter.value, source)
        return True

    # Methods of a service

    def receive(self, packet: Packet, now: float) -> None:
        source = Address(packet.system, packet.component)
        match packet.message:
            case common.ParamRequestList():
                self._list_requested(source)
            case common.ParamRequestRead(param_index=index, param_id=name):
                self._read_requested(source, name if index < 0 else index, packet)
            case common.ParamSet() as message:
                self._set_requested(source, message, packet, now)

    def bulk_messages(self, now: float, has_room: HasRoom = always_room) -> Iterator[Outgoing]:
        yield from self._wanted_values(has_room)
        if self._next_burst is not None and now >= self._next_burst:
            self._next_burst, self._left_in_burst = None, BURST
        waiting: dict[Address, None] = {}
        while self._left_in_burst and (client := self._next_listener(waiting)) is not None:
            if has_room(client):
                self._left_in_burst -= 1
                yield Outgoing(self._next_of_list(client), client)
            else:
                waiting[client] = None
        if self._left_in_burst < BURST and self._next_burst is None:
            self._next_burst = now + BURST_INTERVAL

    def next_timeout(self) -> float | None:
        return self._next_burst

    def handle_timeout(self, now: float) -> None:
        if self._next_burst is not None and now >= self._next_burst:
            self._next_burst, self._left_in_burst = None, BURST

    # Lists and reads

    def _list_requested(self, client: Address) -> None:
        restarted = self._lists.pop(client, None) is not None
        if not len(self.table):
            return
        if len(self._lists) >= MAX_LISTS:
            self._lists.popitem(last=False)
        self._lists[client] = 0 if restarted or not self._hash_check else HASH_FIRST

    def _next_listener(self, waiting: dict[Address, None]) -> Address | None:
        return next((client for client in self._lists if client not in waiting), None)

    def _next_of_list(self, client: Address) -> common.ParamValue:
        entry = self._lists.pop(client)
        definition = self.table.find(entry) if entry >= 0 else None
        if entry + 1 < len(self.table):
            self._lists[client] = entry + 1  # this client waits behind the other clients
        return self._hash_message() if definition is None else self._value_message(definition.name)

    def _wanted_values(self, has_room: HasRoom) -> Iterator[Outgoing]:
        full: dict[Address, None] = {}
        for client, name in tuple(self._reads):
            if client in full or not has_room(client):
                full[client] = None
                continue
            del self._reads[client, name]
            if name == HASH_NAME and name not in self.table:
                yield Outgoing(self._hash_message(), client)
            elif name in self.table:
                yield Outgoing(self._value_message(name), client)

    def _read_requested(self, client: Address, which: str | int, packet: Packet) -> None:
        definition = self.table.find(which)
        if definition is not None:
            self._queue_read(client, definition.name)
        elif which == HASH_NAME and self._hash_check:
            self._queue_read(client, HASH_NAME)
        else:
            self._send_error(packet, which, common.MavParamError.DOES_NOT_EXIST)

    def _queue_read(self, client: Address, name: str) -> None:
        if len(self._reads) < MAX_READS:  # a full queue drops the request; the client sends it again
            self._reads[client, name] = None

    # Sets

    def _set_requested(self, source: Address, message: common.ParamSet, packet: Packet, now: float) -> None:
        name = message.param_id
        definition = self.table.find(name)
        if name == HASH_NAME and self._hash_check:
            self._lists.pop(source, None)
            self._send_error(packet, name, common.MavParamError.READ_ONLY)
        elif definition is None:
            self._send_error(packet, name, common.MavParamError.DOES_NOT_EXIST)
        elif not self._was_overtaken(source, name, packet, now):
            self._set_or_refuse(definition, message, packet, source)

    def _set_or_refuse(
        self, definition: ParameterDefinition, message: common.ParamSet, packet: Packet, source: Address
    ) -> None:
        error, value = self._type_error(definition, message), definition.value
        if error is None:
            value = self._value_in(definition, message)
            error = self._refusal(definition, value)
        if error is None:
            self._write(definition, value, source, packet)
        else:
            self._send_refusal(packet, definition.name, error, source)

    def _send_refusal(self, packet: Packet, name: str, error: common.MavParamError, source: Address) -> None:
        self._send_error(packet, name, error)
        self.send(self._value_message(name), source)

    def _write(
        self, definition: ParameterDefinition, value: Value, source: Address, packet: Packet | None = None
    ) -> None:
        """Write a value that is allowed; `packet` is the request, None for a packed file."""
        previous = definition.value
        held = fitted(value, definition.kind)
        definition.value = previous if held is None else held
        self.send(self._value_message(definition.name), BROADCAST)
        if not same(previous, definition.value):
            self.emit(ParameterWritten(self.table.parameter(definition.name), previous, source))

    def _type_error(
        self, definition: ParameterDefinition, message: common.ParamSet
    ) -> common.MavParamError | None:
        kind = int(message.param_type)
        if self.encoding is Encoding.C_CAST or kind == definition.kind:
            return None
        return common.MavParamError.TYPE_MISMATCH if is_known(kind) else common.MavParamError.TYPE_UNSUPPORTED

    def _value_in(self, definition: ParameterDefinition, message: common.ParamSet) -> Value:
        """Return the requested value; a cast one is rounded, as by ArduPilot."""
        data, kind = field_of(message), definition.kind
        value = decode(data, kind, self.encoding)
        if self.encoding is Encoding.BYTEWISE or not is_integer(kind):
            return value
        # The largest integers become a float that is larger than the integer when they are cast.
        number = decode(data, common.MavParamType.REAL32, self.encoding)
        at_limit = encode(value, kind, self.encoding) == data
        return value if at_limit else round(number) if isfinite(number) else number

    def _refusal(self, definition: ParameterDefinition, value: Value) -> common.MavParamError | None:
        error = definition.refusal(value)
        if error is None and self._check is not None:
            error = self._check(definition, value)
        return error

    def _was_overtaken(self, source: Address, name: str, packet: Packet, now: float) -> bool:
        """Return whether a newer set of the same client for the same parameter arrived before."""
        newest = self._set_filters.setdefault((source, name), ReorderFilter())
        self._set_filters.move_to_end((source, name))
        if len(self._set_filters) > MAX_SETTERS:
            self._set_filters.popitem(last=False)
        return newest.is_reordered(packet.sequence, now)

    # Messages

    def _value_message(self, name: str) -> common.ParamValue:
        definition = self.table[name]
        message = common.ParamValue(
            param_id=name,
            param_type=definition.kind,
            param_count=len(self.table),
            param_index=self.table.index_of(name),
        )
        return with_field(message, encode(definition.value, definition.kind, self.encoding))

    def _hash_message(self) -> common.ParamValue:
        message = common.ParamValue(
            param_id=HASH_NAME,
            param_type=common.MavParamType.UINT32,
            param_count=len(self.table),
            param_index=NO_INDEX,
        )
        return with_field(message, self.table.hash().to_bytes(4, "little"))

    def _send_error(self, packet: Packet, which: str | int, error: common.MavParamError) -> None:
        if packet.version < 2:
            return
        client = Address(packet.system, packet.component)
        message = common.ParamError(
            target_system=client.system,
            target_component=client.component,
            param_id=which if isinstance(which, str) else "",
            param_index=BY_NAME if isinstance(which, str) else which,
            error=error,
        )
        self.send(message, client)
