"""The parts of a message's header that depend on its fields."""

from __future__ import annotations

from itertools import groupby
from typing import TYPE_CHECKING, NamedTuple

from mavstack.codegen.languages.c.reserved import identifier, parameter, quoted, struct_name
from mavstack.codegen.templates import one_line
from mavstack.dialects.model import TYPE_SIZES

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.dialects.model import FieldDefinition, MessageDefinition


class MessageParts(NamedTuple):
    """Texts of a message for the template of its header."""

    lower: str
    pointer: str
    comment: str
    attribute: str
    packed_start: str
    packed_end: str
    array_lengths: str
    members: str
    info: str
    parameters: str
    arguments: str
    puts: str
    swaps: str
    decode_swaps: str
    getters: str


def message_parts(message: MessageDefinition, version: int) -> MessageParts:
    """Return the texts of a message.

    Args:
        message: The message.
        version: Version of the dialect, which HEARTBEAT carries.
    """
    lower = struct_name(message.name)
    pointer = parameter(lower)
    packed = any(field.offset % TYPE_SIZES[field.type] for field in message.fields)
    attribute = "MAVLINK_WIP " if message.wip else ""
    passed = [field for field in message.fields if not field.protocol_version]
    swaps = list(_swaps(message))
    constants = [
        f"    _buf[{field.offset}] = {version};" for field in message.fields if field.protocol_version
    ]
    return MessageParts(
        lower=lower,
        pointer=pointer,
        comment=one_line(message.description) or message.name,
        attribute=attribute,
        packed_start="MAVPACKED(" if packed else "",
        packed_end=")" if packed else "",
        array_lengths="".join(
            f"#define MAVLINK_MSG_{message.name}_FIELD_{field.name.upper()}_LEN {field.array_length}\n"
            for field in message.fields
            if field.array_length
        ),
        members="\n".join(f"    {_member(field)};{_comment(field)}" for field in message.wire_order),
        info=", \\\n".join(f"        {_info(field, lower)}" for field in message.fields),
        parameters=", ".join(map(_parameter, passed)),
        arguments=", ".join(parameter(field.name) for field in passed),
        puts="\n".join(_put(field, version) for field in message.wire_order),
        swaps="\n".join([*(f"    _MAVLINK_SWAP(_buf, {swap});" for swap in swaps), *constants]),
        decode_swaps="".join(f"    _MAVLINK_SWAP({pointer}, {swap});\n" for swap in swaps),
        getters="".join(_getter(field, lower, attribute) for field in message.fields),
    )


def _member(field: FieldDefinition) -> str:
    length = f"[{field.array_length}]" if field.array_length else ""
    return f"{field.type} {identifier(field.name)}{length}"


def _comment(field: FieldDefinition) -> str:
    words = [f"[{field.units}]" if field.units else "", field.enum, field.description]
    text = one_line(" ".join(words))
    return f" /**< {text} */" if text else ""


def _parameter(field: FieldDefinition) -> str:
    name = parameter(field.name)
    return f"const {field.type} *{name}" if field.array_length else f"{field.type} {name}"


def _put(field: FieldDefinition, version: int) -> str:
    name = str(version) if field.protocol_version else parameter(field.name)
    if field.array_length:
        return f"    _mav_put_{field.type}_array(_buf, {field.offset}, {name}, {field.array_length});"
    return f"    _mav_put_{field.type}(_buf, {field.offset}, {name});"


def _swaps(message: MessageDefinition) -> Iterator[str]:
    """Yield offset, size and number of adjacent values of one size, for big-endian processors."""
    for size, fields in groupby(message.wire_order, key=lambda field: TYPE_SIZES[field.type]):
        if size > 1:
            group = list(fields)
            yield f"{group[0].offset}, {size}, {sum(max(field.array_length, 1) for field in group)}"


def _info(field: FieldDefinition, lower: str) -> str:
    print_format = quoted(field.print_format) if field.print_format else "NULL"
    return (
        f'{{ "{field.name}", {print_format}, MAVLINK_TYPE_{field.type.upper()}, {field.array_length}, '
        f"{field.offset}, offsetof(mavlink_{lower}_t, {identifier(field.name)}), "
        f'{quoted(field.units)}, "{field.enum}" }}'
    )


def _getter(field: FieldDefinition, lower: str, attribute: str) -> str:
    head = f"{attribute}static inline %s mavlink_msg_{lower}_get_{field.name}(const mavlink_message_t *msg%s)"
    if field.array_length:
        name = parameter(field.name)
        head %= "uint16_t", f", {field.type} *{name}"
        value = f"_MAV_RETURN_{field.type}_array(msg, {name}, {field.array_length}, {field.offset})"
    else:
        head %= field.type, ""
        value = f"_MAV_RETURN_{field.type}(msg, {field.offset})"
    return f"{head}\n{{\n    return {value};\n}}\n\n"
