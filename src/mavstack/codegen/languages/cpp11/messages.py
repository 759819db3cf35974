"""The parts of a message's struct that depend on its fields."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mavstack.codegen.languages.c.reserved import identifier
from mavstack.codegen.templates import one_line

if TYPE_CHECKING:
    from mavstack.dialects.model import FieldDefinition, MessageDefinition


@dataclass(frozen=True, slots=True)
class MessageParts:
    """Texts of a message for the template of its header."""

    comment: str
    members: str
    writes: str
    reads: str
    fields: str


def message_parts(message: MessageDefinition, version: int) -> MessageParts:
    """Return the texts of a message.

    Args:
        message: The message.
        version: Version of the dialect, which HEARTBEAT carries.
    """
    wire = message.wire_order
    return MessageParts(
        comment=one_line(message.description) or message.name,
        members="\n".join(
            f"    {_type(field)} {identifier(field.name)}{{}};{_comment(field)}" for field in message.fields
        ),
        writes="\n".join(f"        map << {_written(field, version)};" for field in wire),
        reads="\n".join(f"        map >> {identifier(field.name)};" for field in wire),
        fields="\n".join(map(_call, message.fields)),
    )


def _type(field: FieldDefinition) -> str:
    return f"std::array<{field.type}, {field.array_length}>" if field.array_length else field.type


def _call(field: FieldDefinition) -> str:
    info = f'{{"{field.name}", "{field.units}", "{field.enum}", {field.offset}}}'
    return f"        function(mavlink::FieldInfo{info}, {identifier(field.name)});"


def _written(field: FieldDefinition, version: int) -> str:
    return f"uint8_t({version})" if field.protocol_version else identifier(field.name)


def _comment(field: FieldDefinition) -> str:
    words = [f"[{field.units}]" if field.units else "", field.enum, one_line(field.description)]
    text = " ".join(word for word in words if word)
    return f"  ///< {text}" if text else ""
