"""The base of all message classes: what a message can do beside holding its fields.

Fields are read and written in the payload by the core; this class adds text, dictionaries, JSON, copies and
pickles. JSON has no NaN and no infinities: they are written as the strings "NaN", "Infinity" and
"-Infinity", and a float32 is written with the fewest digits that read back to the same float32, so that
nothing is lost. `uint8_t` arrays are lists of numbers in JSON, and enum values are integers unless names
are asked for.
"""

from __future__ import annotations

import json
from math import isfinite, isnan
from struct import pack, unpack

from mavstack._core import MessageBase
from mavstack.dialects.enums import EnumReader, MavEnum, MavFlag, enum_reader
from mavstack.dialects.secrets import secret_fields
from mavstack.errors import FieldNameError, FieldTypeError

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any, ClassVar, Literal, Self, TypeAlias

    from mavstack.dialects.dialect import Dialect
    from mavstack.dialects.model import MessageDefinition
    from mavstack.dialects.tables import MessageRow

#: How enum values come out: as members, as integers, or by their official names.
EnumForm: TypeAlias = 'Literal["member", "value", "name"]'


class _LazyDefinition:
    """`Attitude.definition`, built when someone asks for it."""

    def __get__(self, _message: object, owner: type[Message]) -> MessageDefinition:
        return owner.__mavlink_dialect__.message_definition(owner.__mavlink_row__[0])


class Message(MessageBase):
    """A MAVLink message; its class says which."""

    __slots__ = ()

    definition = _LazyDefinition()

    if TYPE_CHECKING:
        __match_args__: ClassVar[tuple[str, ...]]
        #: The dialect whose class this is, and the row of its table that says how it lies on the wire.
        __mavlink_dialect__: ClassVar[Dialect]
        __mavlink_row__: ClassVar[MessageRow]

    @classmethod
    def _enum_values(cls, name: str) -> EnumReader:
        """How the core reads an enum field: asked once a field."""
        enum = cls.__mavlink_row__[5][cls.__match_args__.index(name)][4]
        return enum_reader(cls.__mavlink_dialect__.enums[enum])

    def __repr__(self) -> str:
        parts = [f"{name}={self._text(name)}" for name in self.__match_args__]
        return f"{type(self).__name__}({', '.join(parts)})"

    def _text(self, name: str) -> str:
        # What is shown ends up in log files, where a key or a password must never be.
        if name in secret_fields(self.__mavlink_row__[1]):
            return "…"
        return _shown(getattr(self, name), self._kind(name))

    @classmethod
    def _kind(cls, name: str) -> str:
        return str(cls.__mavlink_row__[5][cls.__match_args__.index(name)][1])

    def to_dict(self, *, enums: EnumForm = "member") -> dict[str, Any]:
        """The fields by their official names."""
        names = zip(self.__mavlink_row__[5], self.__match_args__, strict=True)
        return {row[0]: _enum_form(getattr(self, name), enums) for row, name in names}

    @classmethod
    def from_dict(cls, fields: Mapping[str, Any]) -> Self:
        """A message of what `to_dict` gave; fields left out are zero, enum values may be official names."""
        attributes = {
            row[0]: name for row, name in zip(cls.__mavlink_row__[5], cls.__match_args__, strict=True)
        }
        return cls(
            **{attributes.get(name, name): cls._from_name(name, value) for name, value in fields.items()}
        )

    def to_json(self, *, enums: EnumForm = "value") -> str:
        """The fields as one JSON object."""
        fields = self.to_dict(enums="value" if enums == "member" else enums)
        kinds = {row[0]: row[1] for row in self.__mavlink_row__[5]}
        return json.dumps(
            {name: _jsonable(value, kinds[name]) for name, value in fields.items()}, allow_nan=False
        )

    @classmethod
    def from_json(cls, text: str | bytes) -> Self:
        """A message of what `to_json` gave."""
        fields = json.loads(text)
        if not isinstance(fields, dict):
            raise FieldTypeError(f"{cls.__name__} is made from a JSON object, not {type(fields).__name__}")
        kinds = {row[0]: row[1] for row in cls.__mavlink_row__[5]}
        return cls.from_dict(
            {name: _from_jsonable(value, kinds.get(name, "")) for name, value in fields.items()}
        )

    @classmethod
    def _from_name(cls, field: str, value: object) -> object:
        """An enum value given by name, or by several names joined by `|`, as a number."""
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
        """A copy with some fields changed."""
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
    """The message that was pickled."""
    return dialect[name].from_payload(payload)


def shortest(value: float, kind: str) -> float:
    """The float with the fewest digits that is the same on the wire."""
    if kind != "float" or not isfinite(value):
        return value
    for digits in range(6, 9):
        candidate = float(f"{value:.{digits}g}")
        if abs(candidate) < 3.4e38 and unpack("<f", pack("<f", candidate))[0] == value:
            return candidate
    return value


def _shown(value: object, kind: str) -> str:
    """A field's value as the text of a message shows it."""
    if isinstance(value, tuple):
        inside = ", ".join(_shown(element, kind) for element in value)
        return f"({inside},)" if len(value) == 1 else f"({inside})"
    if isinstance(value, MavFlag):
        names = value.name.split("|") if value.name else [str(int(value))]
        return "|".join(name if name.isdecimal() else f"{type(value).__name__}.{name}" for name in names)
    if isinstance(value, MavEnum):
        return f"{type(value).__name__}.{value.name}"
    return repr(shortest(value, kind)) if isinstance(value, float) else repr(value)


def _enum_form(value: object, form: EnumForm) -> object:
    """A value with the enum members in it in the form asked for."""
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
        return shortest(value, kind) if isinstance(value, float) else value
    if isnan(value):
        return "NaN"
    return "Infinity" if value > 0 else "-Infinity"


def _from_jsonable(value: object, kind: str) -> object:
    if kind == "char" and isinstance(value, str):
        return value.replace("\N{REPLACEMENT CHARACTER}", "?")  # one byte again, as what was not UTF-8
    if kind not in ("float", "double"):
        return value
    if isinstance(value, list):
        return [_from_jsonable(element, kind) for element in value]
    return float(value) if isinstance(value, str) and value in ("NaN", "Infinity", "-Infinity") else value
