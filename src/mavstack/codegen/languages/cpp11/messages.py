"""The parts of a message's struct that depend on its fields."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.codegen.languages.c.reserved import identifier, quoted
from mavstack.codegen.templates import one_line

if TYPE_CHECKING:
    from mavstack.dialects.model import FieldDefinition, MessageDefinition

#: Members of each struct of a message, and names that their declarations use.
_MEMBERS: Final = frozenset(
    {
        *(
            "CRC_EXTRA",
            "Info",
            "LENGTH",
            "MIN_LENGTH",
            "MSG_ID",
            "Message",
            "NAME",
            "deserialize",
            "for_each_field",
        ),
        *("get_message_info", "get_name", "mavlink", "msgid_t", "serialize", "to_yaml"),
    }
)


class MessageParts(NamedTuple):
    """Texts of a message for the template of its header."""

    name: str
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
        name=struct_name(message),
        comment=one_line(message.description) or message.name,
        members="\n".join(
            f"    {_type(field)} {_member(message, field)}{{}};{_comment(field)}" for field in message.fields
        ),
        writes="\n".join(f"        map << {_written(message, field, version)};" for field in wire),
        reads="\n".join(f"        map >> {_place(message, field)};" for field in wire),
        fields="\n".join(_call(message, field) for field in message.fields),
    )


def _type(field: FieldDefinition) -> str:
    return f"std::array<{field.type}, {field.array_length}>" if field.array_length else field.type


def _call(message: MessageDefinition, field: FieldDefinition) -> str:
    info = f'{{"{field.name}", {quoted(field.units)}, "{field.enum}", {field.offset}}}'
    return f"        function(mavlink::FieldInfo{info}, {_place(message, field)});"


def struct_name(message: MessageDefinition) -> str:
    """Return the name of a message's struct."""
    return f"{message.name}_" if message.name in _MEMBERS else identifier(message.name)


def _member(message: MessageDefinition, field: FieldDefinition) -> str:
    """Return the member of a field: a struct has no member with its own name."""
    taken = field.name in _MEMBERS or field.name == struct_name(message)
    return f"{field.name}_" if taken else identifier(field.name)


def _place(message: MessageDefinition, field: FieldDefinition) -> str:
    """Return the member as the methods of the struct name it, two of which have a parameter of that name."""
    name = _member(message, field)
    return f"this->{name}" if name in ("function", "map") else name


def _written(message: MessageDefinition, field: FieldDefinition, version: int) -> str:
    return f"uint8_t({version})" if field.protocol_version else _place(message, field)


def _comment(field: FieldDefinition) -> str:
    words = [f"[{field.units}]" if field.units else "", field.enum, field.description]
    text = one_line(" ".join(words))
    return f"  ///< {text}" if text else ""
