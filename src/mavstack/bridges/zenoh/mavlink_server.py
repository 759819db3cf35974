"""The keys of mavlink-server beside those of the fleet, for programs that were written for it.

    mavlink/out                                     each message as JSON
    mavlink/<system>/<component>/<MESSAGE>          the same, by its sender and name
    mavlink/<system>/<component>/<MESSAGE>/<field>  each of its fields
    mavlink_raw/out                                 each packet
    mavlink/in, mavlink_raw/in                      messages and packets for vehicles, with --allow-control

The JSON is that of mavlink-server with version 0.16 of its message crate: a header with the ids, and the
message with its name as `type`. Members of an enum are objects with the name as `type`, flags are texts such
as "A | B | 0x8". Requests may also have the form of earlier versions: flags as objects with `bits`, texts as
arrays of letters. Numbers that are not finite are null, as mavlink-server writes them for single fields.
Nothing is converted without a subscriber.
"""

from __future__ import annotations

import logging
import time
from contextlib import suppress
from enum import Flag
from functools import partial
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.plain_json import json_bytes, parse_object
from mavstack.bridges.zenoh.frame_guard import FrameGuard
from mavstack.dialects import Dialect
from mavstack.errors import InvalidArgumentError, InvalidStateError, MavstackError
from mavstack.security.roles import Role
from mavstack.wire import encode

if TYPE_CHECKING:
    from collections.abc import Mapping
    from types import TracebackType
    from typing import Self

    from mavstack.bridges.zenoh.bus import Bus
    from mavstack.dialects import Message
    from mavstack.node.dispatch import Listener
    from mavstack.vehicle import Connection
    from mavstack.wire import Packet

logger = logging.getLogger("mavstack.bridges")
ROOT, RAW_ROOT = "mavlink", "mavlink_raw"
_JSON: Final = "application/json"
#: Field names that mavlink-server changes because they are reserved words of its programming language.
_RENAMED: Final = {"type": "mavtype"}
_ORIGINAL: Final = {new: old for old, new in _RENAMED.items()}


def message_object(packet: Packet) -> dict[str, Any]:
    """Return a message as the JSON of mavlink-server."""
    return {
        "header": {
            "system_id": packet.system,
            "component_id": packet.component,
            "sequence": packet.sequence,
            "message_id": packet.message_id,
        },
        "message": {"type": packet.name} | _fields(packet.message),
    }


def _fields(message: Message) -> dict[str, Any]:
    dialect = Dialect.load("all")
    values, names = message.to_dict(enums="value"), message.to_dict(enums="name")
    found: dict[str, Any] = {}
    for field in message.definition.fields:
        value = values[field.name]
        enum = dialect.enums.get(field.enum) if field.enum and not field.array_length else None
        if enum is not None:
            name = names[field.name]
            value = _flags_text(str(name)) if issubclass(enum, Flag) else {"type": name}
        found[_RENAMED.get(field.name, field.name)] = value
    return found


def _flags_text(names: str) -> str:
    """Return the names of flags, "A|B|8", as mavlink-server separates them; no flags are an empty text."""
    parts = (f"0x{int(each):x}" if each.isdecimal() else each for each in names.split("|"))
    return " | ".join(each for each in parts if each != "0x0")


def packet_of(request: Mapping[str, Any]) -> bytes:
    """Return the packet of a message in the JSON of mavlink-server.

    Raises:
        InvalidArgumentError: It is not such a message.
    """
    header, message = request.get("header"), request.get("message")
    if not isinstance(header, dict) or not isinstance(message, dict):
        raise InvalidArgumentError("a message must have the fields header and message")
    fields: dict[str, Any] = {
        str(_ORIGINAL.get(name, name)): value for name, value in message.items() if name != "type"
    }
    try:
        kind = Dialect.load("all")[str(message.get("type"))]
        enums = {field.name for field in kind.definition.fields if field.enum}
        values = {name: _plain_field(value, is_enum=name in enums) for name, value in fields.items()}
        return encode(
            kind.from_dict(values),
            system=int(header.get("system_id", 255)),
            component=int(header.get("component_id", 0)),
            sequence=int(header.get("sequence", 0)) & 0xFF,
        )
    except (MavstackError, TypeError, ValueError, OverflowError) as error:
        raise InvalidArgumentError(f"the message is not valid: {error}") from None


def _plain_field(value: Any, *, is_enum: bool) -> Any:
    if isinstance(value, dict):
        return value.get("type", value.get("bits", 0))
    if isinstance(value, list):
        letters = bool(value) and all(isinstance(each, str) for each in value)
        return "".join(value).rstrip("\0") if letters else tuple(value)
    if isinstance(value, str) and is_enum:
        parts = (each.strip() for each in value.split("|"))
        return "|".join(str(int(each, 16)) if each.startswith("0x") else each for each in parts) or 0
    return value


class MavlinkServerKeys:
    """All vehicles of a connection on the keys of mavlink-server; a context manager inside the gateway's.

    Args:
        connection: The open connection.
        bus: The open session.
        role: The role of the bus.
    """

    def __init__(self, connection: Connection, bus: Bus, role: Role) -> None:
        #: The filter of packets for vehicles, with its counters.
        self.guard = FrameGuard(None, role, connection.dialect)
        self._connection = connection
        self._bus = bus
        self._role = role
        self._publishers: dict[str, Any] = {}
        self._wanted: set[str] = set()
        self._listener: Listener | None = None
        self._kept: list[Any] = []

    def __enter__(self) -> Self:
        for key in (f"{ROOT}/out", f"{ROOT}/*/*/*", f"{ROOT}/*/*/*/*", f"{RAW_ROOT}/out"):
            self._publishers[key] = self._bus.publisher(key, partial(self._set_wanted, key))
        if self._role > Role.OBSERVE:
            self._kept.append(self._bus.subscriber(f"{RAW_ROOT}/in", self._receive_raw))
            self._kept.append(self._bus.subscriber(f"{ROOT}/in", self._receive_json))
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._listener is not None:
            self._listener.close()
        for each in (*self._publishers.values(), *self._kept):
            self._bus.undeclare(each)

    def _set_wanted(self, key: str, wanted: bool) -> None:
        (self._wanted.add if wanted else self._wanted.discard)(key)
        if self._wanted and self._listener is None:
            self._listener = self._connection.add_packet_listener(None, self._publish)
        elif not self._wanted and self._listener is not None:
            self._listener.close()
            self._listener = None

    def _publish(self, packet: Packet) -> None:
        if f"{RAW_ROOT}/out" in self._wanted:
            self._publishers[f"{RAW_ROOT}/out"].put(packet.raw)
        if packet.message is None or not self._wanted - {f"{RAW_ROOT}/out"}:
            return
        found = message_object(packet)
        data = json_bytes(found)
        if f"{ROOT}/out" in self._wanted:
            self._publishers[f"{ROOT}/out"].put(data, encoding=_JSON)
        key = f"{ROOT}/{packet.system}/{packet.component}/{packet.name}"
        if f"{ROOT}/*/*/*" in self._wanted:
            self._bus.put(key, data, _JSON)
        if f"{ROOT}/*/*/*/*" in self._wanted:
            for name, value in found["message"].items():
                self._bus.put(f"{key}/{name}", json_bytes(value), _JSON)

    def _receive_raw(self, sample: Any) -> None:
        self._pass_on(sample, bytes(sample.payload))

    def _receive_json(self, sample: Any) -> None:
        try:
            data = packet_of(parse_object(bytes(sample.payload)))
        except InvalidArgumentError as error:
            self.guard.refused["is not a message"] += 1
            logger.info("%s/in: %s", ROOT, error)
            return
        self._pass_on(sample, data)

    def _pass_on(self, sample: Any, data: bytes) -> None:
        stamp = sample.timestamp
        source, seconds = ("", None) if stamp is None else (str(stamp.get_id()), stamp.get_time().timestamp())
        for packet in self.guard.accept(data, source, seconds, time.time()):
            with suppress(InvalidStateError):
                self._connection.forward(packet)
