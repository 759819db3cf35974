"""The base of all message classes: text, dictionaries, JSON, copies and pickles.

The core reads and writes the fields in the payload. JSON has no NaN and no infinities: they are written as
the strings "NaN", "Infinity" and "-Infinity". A float32 is written with the fewest digits that read back to
the same float32. `uint8_t` arrays are lists of numbers in JSON, and enum values are integers unless names are
requested.
"""

from __future__ import annotations

import json
from math import isfinite, isnan
from struct import pack, unpack

from mavstack._core import MessageBase, fields_json
from mavstack.dialects.enums import EnumReader, MavEnum, MavFlag, enum_reader
from mavstack.dialects.secrets import HIDDEN, secret_fields
from mavstack.errors import FieldNameError, FieldTypeError

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any, ClassVar, Literal, Self, TypeAlias

    from mavstack.dialects.dialect import Dialect
    from mavstack.dialects.model import MessageDefinition
    from mavstack.dialects.tables import MessageRow

#: The form of enum values: enum members, integers, or names of entries.
EnumForm: TypeAlias = 'Literal["member", "value", "name"]'


class _LazyDefinition:
    """`Attitude.definition`, created on first access."""

    def __get__(self, _message: object, owner: type[Message]) -> MessageDefinition:
        return owner.__mavlink_dialect__.message_definition(owner.__mavlink_row__[0])


class Message(MessageBase):
    """Base class of all MAVLink messages.

    A message class has an attribute for each field. `Attitude(roll=0.1)` creates a message; fields that are
    not given are zero. Values are checked when they are assigned. Messages are compared by their payload.

    Attributes:
        definition: The definition of the message, with descriptions, units and enums.

    Raises:
        FieldNameError: The message has no such field.
        FieldTypeError: A value has the wrong type.
        FieldRangeError: A value is outside the range of its field.
    """

    __slots__ = ()

    definition = _LazyDefinition()

    if TYPE_CHECKING:
        __match_args__: ClassVar[tuple[str, ...]]
        #: The dialect of the message class, and the row with its layout in the dialect's table.
        __mavlink_dialect__: ClassVar[Dialect]
        __mavlink_row__: ClassVar[MessageRow]

    @classmethod
    def _enum_values(cls, name: str) -> EnumReader:
        """Return the conversion of an enum field, for the core, which calls it once per field."""
        enum = cls.__mavlink_row__[5][cls.__match_args__.index(name)][4]
        return enum_reader(cls.__mavlink_dialect__.enums[enum])

    def __repr__(self) -> str:
        parts = [f"{name}={self._text(name)}" for name in self.__match_args__]
        return f"{type(self).__name__}({', '.join(parts)})"

    def _text(self, name: str) -> str:
        # Texts of messages are logged, and logs must not contain keys or passwords.
        if name in secret_fields(self.__mavlink_row__[1]):
            return "…"  # shorter than HIDDEN
        return _format_value(getattr(self, name), self._field_type(name))

    @classmethod
    def _field_type(cls, name: str) -> str:
        return str(cls.__mavlink_row__[5][cls.__match_args__.index(name)][1])

    def to_dict(self, *, enums: EnumForm = "member", secrets: bool = False) -> dict[str, Any]:
        """Return the fields as a dictionary.

        Args:
            enums: Form of enum values: "member", "value" (an integer) or "name" (of the definition).
            secrets: Include keys, passwords and PINs; else they are "(hidden)". The attributes have them.

        Returns:
            The values by field name.
        """
        names = zip(self.__mavlink_row__[5], self.__match_args__, strict=True)
        fields = {row[0]: _enum_form(getattr(self, name), enums) for row, name in names}
        if not secrets:
            for name in secret_fields(self.__mavlink_row__[1]) & fields.keys():
                fields[name] = HIDDEN
        return fields

    @classmethod
    def from_dict(cls, fields: Mapping[str, Any]) -> Self:
        """Create a message from a dictionary of `to_dict`.

        Args:
            fields: Values by field name; missing fields are zero. Enum values may be numbers or names.

        Returns:
            The message.

        Raises:
            FieldNameError: The message has no such field.
            FieldTypeError: A value has the wrong type or is hidden, or the enum has no such entry.
            FieldRangeError: A value is outside the range of its field.
        """
        for name in secret_fields(cls.__mavlink_row__[1]) & fields.keys():
            if fields[name] == HIDDEN:
                text = f"{cls.__name__}.{name} is hidden: write the message with secrets=True"
                raise FieldTypeError(text)
        attributes = {
            row[0]: name for row, name in zip(cls.__mavlink_row__[5], cls.__match_args__, strict=True)
        }
        return cls(
            **{attributes.get(name, name): cls._from_name(name, value) for name, value in fields.items()}
        )

    def to_json(self, *, enums: EnumForm = "value", secrets: bool = False) -> str:
        """Return the fields as a JSON object.

        Args:
            enums: Form of enum values: "value" (an integer) or "name" (of the definition).
            secrets: Include keys, passwords and PINs; else they are "(hidden)".

        Returns:
            The JSON text, without NaN or Infinity literals.
        """
        if enums != "name" and not secrets:
            return fields_json(self) or ""
        fields = self.to_dict(enums="value" if enums == "member" else enums, secrets=secrets)
        types = {row[0]: row[1] for row in self.__mavlink_row__[5]}
        return json.dumps(
            {name: _jsonable(value, types[name]) for name, value in fields.items()}, allow_nan=False
        )

    @classmethod
    def from_json(cls, text: str | bytes) -> Self:
        """Create a message from the JSON text of `to_json`.

        Args:
            text: A JSON object with values by field name.

        Returns:
            The message.

        Raises:
            FieldNameError: The message has no such field.
            FieldTypeError: The text is no JSON object, or a value has the wrong type or is hidden.
            FieldRangeError: A value is outside the range of its field.
            ValueError: The text is not JSON.
        """
        fields = json.loads(text)
        if not isinstance(fields, dict):
            raise FieldTypeError(f"{cls.__name__} needs a JSON object, got {type(fields).__name__}")
        types = {row[0]: row[1] for row in cls.__mavlink_row__[5]}
        return cls.from_dict(
            {name: _from_jsonable(value, types.get(name, "")) for name, value in fields.items()}
        )

    @classmethod
    def _from_name(cls, field: str, value: object) -> object:
        """Convert an enum value given by name, or by several names joined by `|`, to a number."""
        if not isinstance(value, str | list | tuple):
            return value
        enum = next((row[4] for row in cls.__mavlink_row__[5] if row[0] == field and row[1] != "char"), "")
        if not enum:
            return value
        if not isinstance(value, str):
            return [cls._from_name(field, element) for element in value]
        values = cls.__mavlink_dialect__.enum_values(enum)
        total = 0
        for name in map(str.strip, value.split("|")):
            if not name.isdecimal() and name not in values:
                raise FieldTypeError(f"{cls.__name__}.{field}: {enum} has no entry {name!r}")
            total |= int(name) if name.isdecimal() else values[name]
        return total

    def replace(self, **changes: object) -> Self:
        """Return a copy with some fields changed.

        Args:
            changes: New values by attribute name.

        Returns:
            A new message of the same class.

        Raises:
            FieldNameError: The message has no such field.
            FieldTypeError: A value has the wrong type.
            FieldRangeError: A value is outside the range of its field.
        """
        copy = self.__copy__()
        for name, value in changes.items():
            if name not in self.__match_args__:
                raise FieldNameError(f"{type(self).__name__} has no field {name!r}")
            setattr(copy, name, value)
        return copy

    def __copy__(self) -> Self:
        return self.from_payload(self.to_payload())

    def __deepcopy__(self, _memo: object) -> Self:
        return self.__copy__()

    def __reduce__(self) -> tuple[Any, ...]:
        if type(self) is self.__mavlink_dialect__[self.__mavlink_row__[0]]:
            return restore_message, (self.__mavlink_dialect__, self.__mavlink_row__[1], self.to_payload())
        return type(self).from_payload, (self.to_payload(),), getattr(self, "__dict__", None)


def restore_message(dialect: Dialect, name: str, payload: bytes) -> Message:
    """Restore a pickled message."""
    return dialect[name].from_payload(payload)


def shortest_float(value: float, kind: str) -> float:
    """Return the float with the fewest digits that has the same value on the wire."""
    if kind != "float" or not isfinite(value):
        return value
    for digits in range(6, 9):
        candidate = float(f"{value:.{digits}g}")
        if abs(candidate) < 3.4e38 and unpack("<f", pack("<f", candidate))[0] == value:
            return candidate
    return value


def _format_value(value: object, kind: str) -> str:
    """Format the value of a field for `repr`."""
    if isinstance(value, tuple):
        inside = ", ".join(_format_value(element, kind) for element in value)
        return f"({inside},)" if len(value) == 1 else f"({inside})"
    if isinstance(value, MavFlag):
        names = value.name.split("|") if value.name else [str(int(value))]
        return "|".join(name if name.isdecimal() else f"{type(value).__name__}.{name}" for name in names)
    if isinstance(value, MavEnum):
        return f"{type(value).__name__}.{value.name}"
    return repr(shortest_float(value, kind)) if isinstance(value, float) else repr(value)


def _enum_form(value: object, form: EnumForm) -> object:
    """Convert the enum members in a value to the given form."""
    if form == "member":
        return value
    if isinstance(value, tuple):
        return tuple(_enum_form(element, form) for element in value)
    if isinstance(value, MavEnum | MavFlag):
        return value.official_name if form == "name" else int(value)
    return value


def _jsonable(value: object, kind: str) -> object:
    if isinstance(value, bytes | tuple):
        return [_jsonable(element, kind) for element in value]
    if not isinstance(value, float) or isfinite(value):
        return shortest_float(value, kind) if isinstance(value, float) else value
    if isnan(value):
        return "NaN"
    return "Infinity" if value > 0 else "-Infinity"


def _from_jsonable(value: object, kind: str) -> object:
    if kind == "char" and isinstance(value, str):
        return value.replace("\N{REPLACEMENT CHARACTER}", "?")  # the character that replaced an invalid byte
    if kind not in ("float", "double"):
        return value
    if isinstance(value, list):
        return [_from_jsonable(element, kind) for element in value]
    return float(value) if isinstance(value, str) and value in ("NaN", "Infinity", "-Infinity") else value
