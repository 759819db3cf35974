"""Settings of flight controllers, as fields of MSP messages that are read and written.

A setting has a name of at most sixteen characters, so that it is also a parameter of MAVLink. Its type and
unit are those of the field: a scaled field is a REAL32 in a usual unit. Other names of it are its aliases.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from mavstack.dialects.common import MavParamType
from mavstack.errors import InvalidArgumentError
from mavstack.msp.firmware_info import BETAFLIGHT, INAV, FirmwareInfo
from mavstack.msp.messages.codecs import ByVariant, Items, Number
from mavstack.msp.messages.fields import FieldFacts, RecordCodec, layout_of, parse_api
from mavstack.msp.messages.layout import TableMessage

if TYPE_CHECKING:
    from mavstack.msp.messages.base import MspMessage

NAME_LENGTH = 16
Value = int | float
WriteBuilder = Callable[[TableMessage, str, Any], TableMessage]

_TYPES = {
    "u8": MavParamType.UINT8,
    "i8": MavParamType.INT8,
    "u16": MavParamType.UINT16,
    "i16": MavParamType.INT16,
    "u32": MavParamType.UINT32,
    "i32": MavParamType.INT32,
}
_PATH = re.compile(r"(\w+)(?:\[(?:(\d+)|(\w+)=(\d+(?:/\d+)*))\])?(?:\.(\w+))?")


@dataclass(frozen=True, slots=True)
class FieldPath:
    """The place of a setting in a message: a field, an item of a list, or a field of such an item.

    Attributes:
        field: The field of the message.
        index: The position of an item in its list.
        part: The field of the item.
        key: The field of the items that identifies them, if not their position does.
        keys: The values of this field, one of which the item has.
    """

    field: str
    index: int | None = None
    part: str = ""
    key: str = ""
    keys: tuple[int, ...] = ()

    @classmethod
    def parse(cls, text: str) -> FieldPath:
        """Return the path of a text such as "controllers[0].p" or "ports[port=0/51].functions"."""
        found = _PATH.fullmatch(text)
        if found is None:
            raise InvalidArgumentError(f"a path must look like field[index].part, got {text!r}")
        field, index, key, keys, part = found.groups()
        values = tuple(map(int, keys.split("/"))) if keys else ()
        return cls(field, None if index is None else int(index), part or "", key or "", values)

    def get(self, message: object) -> Any:  # noqa: ANN401 (the value of any field)
        """Return the value in a message; None if the firmware does not have it."""
        value = getattr(message, self.field)
        if value is None or not (self.key or self.index is not None):
            return value
        position = self._position(value)
        if position is None:
            return None
        return getattr(value[position], self.part) if self.part else value[position]

    def _position(self, items: Sequence[object]) -> int | None:
        """Return the position of the item in its list; None if the list does not have it."""
        if self.key:
            return next((n for n, each in enumerate(items) if getattr(each, self.key) in self.keys), None)
        return self.index if self.index is not None and self.index < len(items) else None

    def changed(self, message: TableMessage, value: object) -> dict[str, object]:
        """Return the field of the message, by its name, with another value at this place."""
        if not self.key and self.index is None:
            return {self.field: value}
        items = list(getattr(message, self.field))
        position = self._position(items)
        if position is None:
            raise InvalidArgumentError(f"{type(message).__name__}.{self.field} does not have this item")
        items[position] = dataclasses.replace(items[position], **{self.part: value}) if self.part else value
        return {self.field: tuple(items)}

    def facts(self, message: type[TableMessage]) -> tuple[FieldFacts, Number]:
        """Return the facts of the field, and the codec of the number at this place."""
        facts = layout_of(message)[self.field]
        codec = facts.codec
        if isinstance(codec, ByVariant):
            codec = codec.betaflight
        if isinstance(codec, Items):
            codec = codec.item
        if isinstance(codec, RecordCodec):
            part = layout_of(codec.record)[self.part]
            facts, codec = dataclasses.replace(part, since=facts.since), part.codec
        if isinstance(codec, ByVariant):  # both firmwares have a number of the same size
            codec = codec.betaflight
        if not isinstance(codec, Number):
            raise InvalidArgumentError(f"{message.NAME}.{self.field} is not a number")
        return facts, codec


@dataclass(frozen=True, slots=True)
class SettingDefinition:
    """The facts of one setting.

    Attributes:
        name: The name, at most sixteen characters.
        read: Message that has the value.
        write: Message that sets it.
        path: Place of the value in the message that is read.
        type: Type of the value as a parameter of MAVLink.
        minimum: Smallest value that the firmware is meant to have.
        maximum: Largest value that the firmware is meant to have.
        increment: Step between two values.
        unit: Unit of the value, "" without one.
        description: The meaning in one sentence.
        variants: Firmwares that have the setting.
        since: Version of Betaflight's MSP interface that added it, "" for an old one.
        until: Last version of Betaflight's MSP interface that has it, "" for the present one.
        aliases: Other names.
        values: Meaning of the values, for those that stand for something.
        build: Makes the message that is written; None if its fields have the names of the one that is read.
    """

    name: str
    read: type[TableMessage]
    write: type[TableMessage]
    path: FieldPath
    type: MavParamType
    minimum: Value
    maximum: Value
    increment: float
    unit: str
    description: str
    variants: tuple[str, ...]
    since: str = ""
    until: str = ""
    aliases: tuple[str, ...] = ()
    values: Mapping[int, str] = dataclasses.field(default_factory=dict)
    build: WriteBuilder | None = None

    def is_in(self, firmware: FirmwareInfo) -> bool:
        """Return whether a firmware of this version has the setting."""
        return self.absence(firmware) == ""

    def absence(self, firmware: FirmwareInfo) -> str:
        """Return the reason why a firmware does not have the setting, "" if it does."""
        variant = INAV if firmware.is_inav else BETAFLIGHT
        if variant not in self.variants:
            return f"{firmware.firmware} does not have it"
        version = f"{firmware.firmware} {firmware.version_text} has version {_dotted(firmware.api)} of MSP"
        if variant == BETAFLIGHT and self.since and firmware.api < parse_api(self.since):
            return f"it needs version {self.since} of MSP, {version}"
        if variant == BETAFLIGHT and self.until and firmware.api > parse_api(self.until):
            return f"it ends with version {self.until} of MSP, {version}"
        return ""

    def value_in(self, message: MspMessage) -> Value | None:
        """Return the value in a message that was read; None if the firmware does not send it."""
        value = self.path.get(message)
        if value is None:
            return None
        return float(value) if self.type == MavParamType.REAL32 else int(value)

    def checked(self, value: object) -> Value:
        """Return a value as the type that the setting has.

        Raises:
            InvalidArgumentError: The value is not a number, is outside the range, or is not an integer.
        """
        if isinstance(value, bool):
            value = int(value)
        if not isinstance(value, (int, float)) or value != value:
            raise InvalidArgumentError(f"{self.name} must be a number, got {value!r}")
        slack = self.increment / 2 if self.type == MavParamType.REAL32 else 0
        if not self.minimum - slack <= value <= self.maximum + slack:
            limits = f"{self.minimum:g} to {self.maximum:g} {self.unit}".rstrip()
            raise InvalidArgumentError(f"{self.name} must be {limits}, got {value:g}")
        if self.type == MavParamType.REAL32:
            return float(value)
        if value != int(value):
            raise InvalidArgumentError(f"{self.name} must be an integer, got {value:g}")
        return int(value)

    def is_equal(self, one: Value, other: Value) -> bool:
        """Return whether two values are the same for the firmware, which rounds scaled ones."""
        return abs(one - other) < 0.75 * self.increment

    def message(self, current: TableMessage, value: Value) -> TableMessage:
        """Return the message that sets a value.

        Args:
            current: The message that was read, whose other settings stay.
            value: The new value.
        """
        if self.build is not None:
            return self.build(current, self.path.field, value)
        return self.write.from_message(current, **self.path.changed(current, value))


def _dotted(version: tuple[int, ...]) -> str:
    return ".".join(map(str, version))


def define(
    name: str,
    path: str,
    description: str,
    minimum: Value | None = None,
    maximum: Value | None = None,
    *,
    messages: tuple[type[TableMessage], type[TableMessage]],
    variants: tuple[str, ...] | None = None,
    since: str = "",
    until: str = "",
    alias: str = "",
    values: Mapping[int, str] | tuple[str, ...] = (),
    build: WriteBuilder | None = None,
) -> SettingDefinition:
    """Define a setting; type, unit, version and missing limits are those of its field.

    Args:
        name: The name, at most sixteen characters.
        path: Place of the value in the message that is read.
        description: The meaning in one sentence.
        minimum: Smallest value, in the unit of the field; None for that of its type.
        maximum: Largest value, in the unit of the field; None for that of its type.
        messages: The message that is read and the one that is written.
        variants: Firmwares that have the setting; None for those of the message.
        since: Version that added it, if it is not that of the field.
        until: Last version that has it.
        alias: Another name.
        values: Meaning of the values, or their names from 0 on.
        build: Makes the message that is written, if its fields differ from those of the one that is read.
    """
    place = FieldPath.parse(path)
    read, write = messages
    facts, number = place.facts(read)
    meanings = values if isinstance(values, Mapping) else dict(enumerate(values))
    low, high = number.limits
    if meanings and maximum is None:
        minimum, maximum = min(meanings), max(meanings)
    if number.kind is bool and maximum is None:
        minimum, maximum = 0, 1
    return SettingDefinition(
        name=name,
        read=read,
        write=write,
        path=place,
        type=_TYPES[number.wire_type] if number.per_unit == 1 else MavParamType.REAL32,
        minimum=low if minimum is None else minimum,
        maximum=high if maximum is None else maximum,
        increment=number.step / number.per_unit,
        unit=facts.unit,
        description=description,
        variants=read.VARIANTS if variants is None else variants,
        since=since or max(facts.since, read.SINCE, key=lambda text: parse_api(text or "0.0")),
        until=until,
        aliases=(alias,) if alias else (),
        values=meanings,
        build=build,
    )
