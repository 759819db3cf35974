"""Messages and enums as the lines of Python classes."""

from __future__ import annotations

from keyword import kwlist, softkwlist
from textwrap import wrap
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.codegen.templates import one_line

if TYPE_CHECKING:
    from mavstack.dialects.model import EnumDefinition, FieldDefinition, MessageDefinition

#: Attributes of the class `Message`, and names that its methods use.
_OWN_NAMES: Final = (
    *("self", "cls", "to_payload", "from_payload", "to_dict", "pack"),
    *("ID", "NAME", "CRC_EXTRA", "BASE_LENGTH", "LENGTH", "STRUCT", "EXTRA", "NUMBER"),
)
RESERVED_WORDS: Final = frozenset({*kwlist, *(word for word in softkwlist if word == "_"), *_OWN_NAMES})

_FORMATS: Final = {
    "char": "s",
    "int8_t": "b",
    "uint8_t": "B",
    "int16_t": "h",
    "uint16_t": "H",
    "int32_t": "i",
    "uint32_t": "I",
    "int64_t": "q",
    "uint64_t": "Q",
    "float": "f",
    "double": "d",
}
#: Maximum length of a line of docstring text.
_WIDTH: Final = 92
#: Maximum length of a line of code.
_LINE: Final = 100


class MessageClass(NamedTuple):
    """The parts of the class of a message, as source.

    Attributes:
        name: Name of the class.
        definition: The message.
        doc: Lines of the docstring.
        slots: The names of the fields.
        arguments: The arguments of the constructor with types and defaults.
        assignments: The statements of the constructor.
        format: Format of the payload for `struct`.
        pack: The values of the payload.
        unpack: Statements that set the fields.
    """

    name: str
    definition: MessageDefinition
    doc: str
    slots: str
    arguments: str
    assignments: str
    format: str
    pack: str
    unpack: str


class EnumClass(NamedTuple):
    """The parts of the class of an enum: name, lines of the docstring, members with value and comment."""

    name: str
    doc: str
    members: str


class _Field(NamedTuple):
    """The parts of a field: `values` values in the format of `struct`; `unpacked` has {0} for their index."""

    name: str
    argument: str
    format: str
    packed: str
    unpacked: str
    values: int


def _field(item: FieldDefinition, version: int) -> _Field:
    """Return the parts of a field; version is the default of HEARTBEAT.mavlink_version."""
    name = f"{item.name}_" if item.name in RESERVED_WORDS else item.name
    value, length = f"self.{name}", item.array_length
    if item.type == "char":
        packed, size = f'from_text({value}, {length or 1}, "{name}")', f"{length or 1}s"
        return _Field(name, f'{name}: str = ""', size, packed, "to_text(values[{0}])", 1)
    if length and item.type == "uint8_t":
        packed = f'from_bytes({value}, {length}, "{name}")'
        return _Field(name, f"{name}: bytes = bytes({length})", f"{length}s", packed, "values[{0}]", 1)
    kind, zero = ("float", "0.0") if item.type in ("float", "double") else ("int", "0")
    code = _FORMATS[item.type]
    if length:
        argument = f'{name}: "tuple[{kind}, ...]" = ({zero},) * {length}'
        return _Field(
            name, argument, f"{length}{code}", f"*{value}", f"values[{{0}}:{{0}} + {length}]", length
        )
    default = str(version) if item.protocol_version else zero
    return _Field(name, f"{name}: {kind} = {default}", code, value, "", 1)


def message_class(message: MessageDefinition, name: str, enums: dict[str, str], version: int) -> MessageClass:
    """Return the parts of the class of a message.

    Args:
        message: The message.
        name: Name of the class.
        enums: Names of the classes of enums, by their official names.
        version: Version of the dialect.
    """
    fields = {item.name: _field(item, version) for item in message.fields}
    wire = [fields[item.name] for item in message.wire_order]
    names = [item.name for item in fields.values()]
    return MessageClass(
        name=name,
        definition=message,
        doc=_message_doc(message, fields, enums),
        slots=_group("__slots__ = (", [f'"{name}"' for name in names], ")", 4),
        arguments=",\n        ".join([item.argument for item in fields.values()]),
        assignments="\n        ".join([f"self.{name} = {name}" for name in names]),
        format="<" + "".join([item.format for item in wire]),
        pack=_group("return self.STRUCT.pack(", [item.packed for item in wire], ")", 8),
        unpack=_unpack(wire),
    )


def _unpack(wire: list[_Field]) -> str:
    """Return one assignment of all single values, or one for each field."""
    if not any(item.unpacked for item in wire):
        return _group("(", [f"self.{item.name}" for item in wire], ") = cls.STRUCT.unpack(payload)", 8)
    lines, index = ["values = cls.STRUCT.unpack(payload)"], 0
    for item in wire:
        lines.append(f"self.{item.name} = {(item.unpacked or 'values[{0}]').format(index)}")
        index += item.values
    return "\n        ".join(lines)


def _group(start: str, items: list[str], end: str, indent: int) -> str:
    """Return the items of a call or of a tuple, on one line or on a line each."""
    is_call = start[-2].isalpha() if len(start) > 1 else False
    text = ", ".join(items) + ("," if len(items) == 1 and not is_call else "")
    if len(text) + len(start) + len(end) + indent <= _LINE:
        return f"{start}{text}{end}"
    gap = "\n" + " " * indent
    return f"{start}{gap}    {f',{gap}    '.join(items)},{gap}{end}"


def _message_doc(message: MessageDefinition, fields: dict[str, _Field], enums: dict[str, str]) -> str:
    lines = [*_wrapped(_doc_text(message.description) or f"{message.name}."), ""]
    if message.deprecated:
        replaced = f" Use {message.deprecated.replaced_by}." if message.deprecated.replaced_by else ""
        lines += [_doc_text(f"Deprecated since {message.deprecated.since}.{replaced}"), ""]
    lines.append("Attributes:")
    for item in message.fields:
        lines += [f"    {line}" for line in _field_doc(item, fields[item.name].name, enums)]
    return "\n    ".join(lines).replace("\n    \n", "\n\n")


def _field_doc(item: FieldDefinition, name: str, enums: dict[str, str]) -> list[str]:
    """Return lines with the type, unit, enum and description of a field."""
    text = f"{name}: {item.type}[{item.array_length}]" if item.array_length else f"{name}: {item.type}"
    text += f", in {_doc_text(item.units)}" if item.units else ""
    text += f", `enums.{enums[item.enum]}`" if item.enum else ""
    text += ", extension." if item.extension else "."
    return _wrapped(f"{text} {_doc_text(item.description)}" if item.description else text, indent="    ")


def _wrapped(text: str, indent: str = "") -> list[str]:
    """Return the lines of a text; most texts have one."""
    if len(text) <= _WIDTH:
        return [text]
    return wrap(text, _WIDTH, subsequent_indent=indent, break_on_hyphens=False)


def _doc_text(text: str) -> str:
    """Return a text for a docstring."""
    return one_line(text).replace("\\", "\\\\").replace('"', "'")


def enum_class(enum: EnumDefinition, name: str, names: dict[str, str]) -> EnumClass:
    """Return the parts of the class of an enum, with the names of its members by those of the entries."""
    members = []
    for entry in enum.entries:
        comment = f"  # {one_line(entry.description)}" if entry.description else ""
        members.append(f"{names[entry.name]} = {entry.value}{comment}")
    text = _doc_text(enum.description) or enum.name
    return EnumClass(name, "\n    ".join(_wrapped(text)), "\n    ".join(members or ["pass"]))
