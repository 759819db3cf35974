"""Messages as JSON, as the API and the WebSockets show and take them.

    {"message": "ATTITUDE", "system": 1, "component": 1, "time": 1790000000.0, "fields": {"roll": 0.01, …}}

Fields have the names and the units of the definition; enums are numbers. A message that the dialect does not
define has its id and the bytes of its packet: {"message": null, "id": 54321, "raw": "fd00ff…", …}.
"""

from __future__ import annotations

from math import nan
from typing import TYPE_CHECKING, Any

from mavstack.dialects import Dialect
from mavstack.http.bodies import RefusedError
from mavstack.server.sender_rules import may_send
from mavstack.wire import fields_json

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack._core import HasCoreDialect
    from mavstack.dialects import Message
    from mavstack.security.roles import Role
    from mavstack.server.latest_messages import LatestMessage
    from mavstack.wire import Packet


def packet_json(packet: Packet, time: float, *, ascii: bool = True) -> str:  # noqa: A002 (the word of fields_json)
    """Return a received packet as JSON, written from its bytes.

    Args:
        packet: The packet.
        time: The time of receipt, in Unix seconds.
        ascii: Escape the characters outside ASCII.

    Returns:
        The JSON text, without spaces.
    """
    fields = fields_json(packet, strict=True, ascii=ascii)
    sender = f'"system":{packet.system},"component":{packet.component},"time":{time!r}'
    if fields is None:
        return f'{{"message":null,{sender},"id":{packet.message_id},"raw":"{packet.raw.hex()}"}}'
    return f'{{"message":"{packet.name}",{sender},"fields":{fields}}}'


def latest_json(latest: LatestMessage, now: float) -> str:
    """Return a latest message as JSON with its count and its rate in hertz."""
    if not latest.text:
        latest.text = packet_json(latest.packet, latest.time, ascii=False)
    return f'{latest.text[:-1]},"count":{latest.count},"rate":{round(latest.rate(now), 3)!r}}}'


def message_class(dialect: HasCoreDialect, name: str) -> type[Message]:
    """Return a message class by its name; raises `UnknownMessageError`."""
    found: type[Message] = _full(dialect)[name.upper()]
    return found


def message_of(dialect: HasCoreDialect, name: str, fields: Mapping[str, Any], role: Role) -> Message:
    """Return a message to send.

    Args:
        dialect: The dialect of the station.
        name: The name of the message.
        fields: The fields by name; missing ones are 0, null is NaN.
        role: The role of the client.

    Returns:
        The message.

    Raises:
        UnknownMessageError: The dialect has no such message.
        RefusedError: The role may not send it, or an array holds other arrays.
        FieldNameError: The message has no such field.
        FieldTypeError: A value has the wrong type.
        FieldRangeError: A value is out of range.
    """
    kind = message_class(dialect, name)
    message = kind.from_dict({key: _value(key, value) for key, value in fields.items()})
    command = getattr(message, "command", None)
    number = int(kind.__mavlink_row__[0])
    if not may_send(role, number, command if isinstance(command, int) else None):
        raise RefusedError(403, f"the role {role.word} may not send {name}")
    return message


def _value(name: str, value: object) -> object:
    if not isinstance(value, list):
        return nan if value is None else value
    if any(isinstance(each, list | dict) for each in value):
        raise RefusedError(400, f"the array {name[:60]!r} must hold numbers")
    return tuple(nan if each is None else each for each in value)


def _full(dialect: HasCoreDialect) -> Dialect:
    return dialect if isinstance(dialect, Dialect) else Dialect.load("all")
