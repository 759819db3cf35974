"""The fields of MSP messages: how each is specified in the body of a message class, decoded and encoded."""

from __future__ import annotations

import dataclasses
from dataclasses import MISSING, dataclass
from functools import cache
from struct import Struct
from typing import TYPE_CHECKING, Any, TypeVar, dataclass_transform

from mavstack.errors import InvalidArgumentError, InvalidTypeError
from mavstack.msp.firmware_info import BETAFLIGHT, INAV, FirmwareInfo
from mavstack.msp.messages.codecs import (
    Bytes,
    Codec,
    CountedBytes,
    Items,
    NameList,
    Number,
    NumberKind,
    PayloadReader,
    PayloadTooShortError,
    PayloadWriter,
    PrefixedText,
    RestText,
    Text,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

RecordT = TypeVar("RecordT", bound="Record")


@dataclass(frozen=True, slots=True)
class FieldFacts:
    """The facts of one field.

    Attributes:
        codec: How the field stands in the payload.
        unit: Unit of the value, "" without one.
        since: Version of Betaflight's MSP interface that added the field, "" for an old one.
        variant: The only firmware that has the field, "" for all.
    """

    codec: Codec
    unit: str = ""
    since: str = ""
    variant: str = ""

    def is_in(self, firmware: FirmwareInfo | None) -> bool:
        """Return whether a firmware has the field; None stands for the newest Betaflight."""
        return self.is_in_variant(variant_of(firmware))

    def is_in_variant(self, variant: str) -> bool:
        """Return whether Betaflight or iNav has the field."""
        return not self.variant or self.variant == variant

    def is_too_new_for(self, firmware: FirmwareInfo | None) -> bool:
        """Return whether a Betaflight is older than the field."""
        if firmware is None or firmware.is_inav or not self.since or firmware.api == (0, 0):
            return False
        return firmware.api < parse_api(self.since)


def variant_of(firmware: FirmwareInfo | None) -> str:
    """Return whose layouts a firmware has: iNav's or Betaflight's."""
    return INAV if firmware is not None and firmware.is_inav else BETAFLIGHT


def parse_api(text: str) -> tuple[int, int]:
    """Return the numbers of a version such as "1.46"."""
    major, _, minor = text.partition(".")
    return int(major), int(minor)


def _field(facts: FieldFacts, default: object) -> Any:
    metadata = {"msp": facts}
    if default is MISSING:
        return dataclasses.field(metadata=metadata)
    return dataclasses.field(default=default, metadata=metadata)


def _number(wire_type: str) -> Callable[..., Any]:
    def specify(
        per_unit: float = 1,
        unit: str = "",
        *,
        kind: NumberKind = None,
        step: int = 1,
        offset: int = 0,
        since: str = "",
        variant: str = "",
        default: object = MISSING,
    ) -> Any:
        codec = Number(wire_type, per_unit, step, offset, kind)
        return _field(FieldFacts(codec, unit, since, variant), default)

    specify.__doc__ = f"Specify a field that is one {wire_type}; `per_unit` of its counts are one `unit`."
    return specify


u8 = _number("u8")
i8 = _number("i8")
u16 = _number("u16")
i16 = _number("i16")
u32 = _number("u32")
i32 = _number("i32")


def of(codec: Codec, unit: str = "", *, since: str = "", variant: str = "", default: object = MISSING) -> Any:
    """Specify a field with a codec of its own, such as a list."""
    return _field(FieldFacts(codec, unit, since, variant), default)


def text(length: int, *, since: str = "", variant: str = "", default: object = MISSING) -> Any:
    """Specify a text of a fixed length."""
    return of(Text(length), since=since, variant=variant, default=default)


def prefixed_text(length: int = 0, *, since: str = "", variant: str = "", default: object = MISSING) -> Any:
    """Specify a text behind a byte with its length."""
    return of(PrefixedText(length), since=since, variant=variant, default=default)


def rest_text(*, default: object = MISSING) -> Any:
    """Specify a text up to the end of the payload."""
    return of(RestText(), default=default)


def name_list(*, default: object = MISSING) -> Any:
    """Specify names up to the end of the payload."""
    return of(NameList(), default=default)


def raw(length: int | None = None, *, since: str = "", variant: str = "", default: object = MISSING) -> Any:
    """Specify bytes that are not interpreted."""
    return of(Bytes(length), since=since, variant=variant, default=default)


def counted_raw(*, since: str = "", variant: str = "", default: object = MISSING) -> Any:
    """Specify bytes behind a byte with their number."""
    return of(CountedBytes(), since=since, variant=variant, default=default)


def items_of(
    item: type[Record] | Codec,
    unit: str = "",
    *,
    count: int | None = None,
    counted: bool = False,
    leave: int = 0,
    since: str = "",
    variant: str = "",
    default: object = MISSING,
) -> Any:
    """Specify a list of records or numbers; see `Items` for `count`, `counted` and `leave`."""
    codec = RecordCodec(item) if isinstance(item, type) else item
    return of(Items(codec, count, counted, leave), unit, since=since, variant=variant, default=default)


def layout_of(layout: type) -> Mapping[str, FieldFacts]:
    """Return the fields of a message or record class by name, in the order of the payload."""
    return _layout(layout)


@cache
def _layout(layout: type) -> Mapping[str, FieldFacts]:
    return {item.name: item.metadata["msp"] for item in dataclasses.fields(layout)}


@cache
def _optional_fields(layout: type) -> frozenset[str]:
    return frozenset(item.name for item in dataclasses.fields(layout) if item.default is None)


@dataclass(frozen=True, slots=True)
class NumberPlan:
    """The layout of a message whose fields are all numbers, which is decoded in one step."""

    layout: Struct
    codecs: tuple[tuple[str, Number], ...]


@cache
def _number_plan(layout: type, variant: str) -> NumberPlan | None:
    """Return the plan of a layout in a firmware; None if it has other fields than numbers."""
    fields = [
        (name, facts.codec) for name, facts in layout_of(layout).items() if facts.is_in_variant(variant)
    ]
    codecs = tuple((name, codec) for name, codec in fields if isinstance(codec, Number))
    if not fields or len(codecs) < len(fields):
        return None
    return NumberPlan(Struct("<" + "".join(codec.format for _, codec in codecs)), codecs)


def decode_fields(layout: type, reader: PayloadReader) -> dict[str, Any]:
    """Take the fields of a message or record from a payload, those that its firmware has.

    Raises:
        PayloadEndsInFieldError: The payload is too short.
    """
    plan = _number_plan(layout, variant_of(reader.firmware))
    if plan is not None and reader.remaining >= plan.layout.size:
        numbers = plan.layout.unpack(reader.take(plan.layout.size))
        return {name: codec.value(raw) for (name, codec), raw in zip(plan.codecs, numbers, strict=True)}
    values: dict[str, Any] = {}
    reader.values = values
    optional = _optional_fields(layout)
    for name, facts in layout_of(layout).items():
        if not facts.is_in(reader.firmware):
            continue
        if not reader.remaining and name in optional:
            break
        try:
            values[name] = facts.codec.decode(reader)
        except PayloadTooShortError as error:
            raise PayloadEndsInFieldError(name, error.missing) from None
    return values


def encode_fields(message: Layout, payload: PayloadWriter) -> None:
    """Append the fields of a message or record to a payload, those that its firmware has.

    Raises:
        InvalidArgumentError: A value does not fit into its field, or a field is None before one that is not.
        InvalidTypeError: A value has a wrong type.
    """
    missing = ""
    payload.message = message
    for name, facts in layout_of(type(message)).items():
        if not facts.is_in(payload.firmware) or facts.is_too_new_for(payload.firmware):
            continue
        value = getattr(message, name)
        if value is None:
            missing = missing or name
            continue
        if missing:
            raise InvalidArgumentError(f"{missing} must be set, because {name} behind it is")
        try:
            facts.codec.encode(value, payload)
        except (InvalidArgumentError, InvalidTypeError) as error:
            raise type(error)(f"{name} {error}") from None


class PayloadEndsInFieldError(Exception):
    """A payload ends inside a field."""

    def __init__(self, name: str, missing: int) -> None:
        super().__init__(name, missing)
        self.name, self.missing = name, missing


@dataclass_transform(
    frozen_default=True,
    field_specifiers=(
        u8,
        i8,
        u16,
        i16,
        u32,
        i32,
        of,
        text,
        prefixed_text,
        rest_text,
        name_list,
        raw,
        counted_raw,
        items_of,
    ),
)
class Layout:
    """A class whose body is a table of fields."""

    __slots__ = ()


class Record(Layout):
    """A group of fields that occurs several times in a message."""

    __slots__ = ()


@dataclass(frozen=True, slots=True)
class RecordCodec:
    """A record as a field or as an item of a list."""

    record: type[Record]

    @property
    def wire_type(self) -> str:
        """The type in the payload."""
        return self.record.__name__

    def decode(self, reader: PayloadReader) -> Record:
        """Take the record from a payload."""
        try:
            return self.record(**decode_fields(self.record, reader))
        except PayloadEndsInFieldError as error:
            raise PayloadTooShortError(error.missing) from None

    def encode(self, value: object, payload: PayloadWriter) -> None:
        """Append the record to a payload."""
        if not isinstance(value, self.record):
            raise InvalidTypeError(f"must be a {self.record.__name__}, got {value!r}")
        encode_fields(value, payload)


def record(made: type[RecordT]) -> type[RecordT]:
    """Define a group of fields that occurs several times in a message."""
    return dataclass(frozen=True, slots=True)(made)
