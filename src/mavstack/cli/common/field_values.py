"""Field values as text: common units, names of enum values, a dash for a value that is not known.

A value that the definition of its field calls invalid is shown as a dash. Text from the wire is shown without
control characters: a vehicle must not be able to move the reader's cursor.
"""

from __future__ import annotations

from datetime import UTC, datetime
from enum import IntFlag
from math import isfinite, pi
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.cli.common.text import printable
from mavstack.dialects.secrets import secret_fields
from mavstack.security import has_secret_fields

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.dialects import Message
    from mavstack.dialects.model import FieldDefinition
    from mavstack.wire import Packet

#: The text that is shown in place of a secret value.
HIDDEN: Final = "(hidden)"
UNKNOWN: Final = "–"  # noqa: RUF001 (a dash, as in a table)


class UnitFormat(NamedTuple):
    """The display of a unit: the factor to multiply by, the suffix, the number of decimals."""

    factor: float
    suffix: str
    decimals: int


class FieldText(NamedTuple):
    """A field as text; `known` is False for an invalid value, `flags` is True for a bitmask."""

    name: str
    text: str
    known: bool = True
    flags: bool = False


_DEGREES: Final = 180 / pi
_UNITS: Final[Mapping[str, UnitFormat]] = MappingProxyType(
    {
        "rad": UnitFormat(_DEGREES, "°", 1),
        "rad/s": UnitFormat(_DEGREES, "°/s", 1),
        "mrad/s": UnitFormat(_DEGREES / 1000, "°/s", 1),
        "deg": UnitFormat(1, "°", 1),
        "deg/2": UnitFormat(2, "°", 0),
        "cdeg": UnitFormat(0.01, "°", 1),
        "degE5": UnitFormat(1e-5, "°", 5),
        "degE7": UnitFormat(1e-7, "°", 6),
        "deg/s": UnitFormat(1, "°/s", 1),
        "ddeg/s": UnitFormat(0.1, "°/s", 1),
        "mm": UnitFormat(0.001, " m", 2),
        "cm": UnitFormat(0.01, " m", 2),
        "dm": UnitFormat(0.1, " m", 1),
        "m": UnitFormat(1, " m", 2),
        "dam": UnitFormat(10, " m", 0),
        "mm/s": UnitFormat(0.001, " m/s", 2),
        "cm/s": UnitFormat(0.01, " m/s", 2),
        "dm/s": UnitFormat(0.1, " m/s", 1),
        "m/s": UnitFormat(1, " m/s", 2),
        "m/s*5": UnitFormat(0.2, " m/s", 1),
        "m/s/s": UnitFormat(1, " m/s²", 2),
        "mG": UnitFormat(0.001, " g", 3),
        "mgauss": UnitFormat(0.001, " G", 3),
        "gauss": UnitFormat(1, " G", 3),
        "mV": UnitFormat(0.001, " V", 2),
        "cV": UnitFormat(0.01, " V", 2),
        "V": UnitFormat(1, " V", 2),
        "mA": UnitFormat(0.001, " A", 2),
        "cA": UnitFormat(0.01, " A", 2),
        "A": UnitFormat(1, " A", 2),
        "%": UnitFormat(1, " %", 0),
        "d%": UnitFormat(0.1, " %", 1),
        "c%": UnitFormat(0.01, " %", 1),
        "degC": UnitFormat(1, " °C", 1),
        "cdegC": UnitFormat(0.01, " °C", 1),
        "cs": UnitFormat(0.01, " s", 2),
        "ds": UnitFormat(0.1, " s", 1),
        "ms": UnitFormat(1, " ms", 0),
        "us": UnitFormat(1, " µs", 0),
        "hPa": UnitFormat(1, " hPa", 1),
        "bytes": UnitFormat(1, " B", 0),
    }
)
_CLOCKS: Final[Mapping[str, float]] = MappingProxyType({"ms": 1e-3, "us": 1e-6, "ns": 1e-9})
_INVALID: Final[Mapping[str, float]] = MappingProxyType(
    {
        "INT8_MAX": 2**7 - 1,
        "INT16_MAX": 2**15 - 1,
        "INT32_MAX": 2**31 - 1,
        "UINT8_MAX": 2**8 - 1,
        "UINT16_MAX": 2**16 - 1,
        "UINT32_MAX": 2**32 - 1,
        "UINT64_MAX": 2**64 - 1,
    }
)
#: Microseconds since 1970 that are shown as a date rather than a duration: the years 2001 to 2286.
_CALENDAR = range(10**15, 10**16)


def field_texts(message: Message) -> list[FieldText]:
    """Return the fields of a message as texts, in the order of its definition; secrets are hidden."""
    definition = type(message).definition
    secret = secret_fields(definition.name)
    return [
        FieldText(field.name, HIDDEN) if field.name in secret else _text(field, getattr(message, attribute))
        for field, attribute in zip(definition.fields, message.__match_args__, strict=True)
    ]


def element_text(field: FieldDefinition, value: object) -> str:
    """Return a value of a field, or an element of its array, as text."""
    return _number(field, value, _invalid(field))


def is_known(field: FieldDefinition, value: object) -> bool:
    """Return False if the definition calls a value of the field invalid."""
    return value != _invalid(field)


def display_format(field: FieldDefinition) -> UnitFormat:
    """Return the display of a field: the factor to multiply its raw values by, suffix and decimals."""
    known = _UNITS.get(field.units) or UnitFormat(1, f" {field.units}" if field.units else "", 0)
    return known._replace(factor=known.factor * field.factor)


def _text(field: FieldDefinition, value: object) -> FieldText:
    if isinstance(value, str):
        text = printable(value.strip())
        return FieldText(field.name, text, bool(text))
    if isinstance(value, bytes):
        text = value.rstrip(b"\0").hex(" ")
        return FieldText(field.name, f"[{text}]", bool(text))
    invalid = _invalid(field)
    if isinstance(value, tuple | list):
        texts = [_number(field, item, invalid) for item in value]
        while texts and texts[-1] == UNKNOWN:
            texts.pop()
        return FieldText(field.name, f"[{_run_lengths(texts)}]", bool(texts))
    text = _number(field, value, invalid)
    return FieldText(field.name, text, text != UNKNOWN, isinstance(value, IntFlag))


def _run_lengths(texts: list[str]) -> str:
    """Join the texts with spaces; five or more equal texts become `5 × text`."""  # noqa: RUF002
    if len(texts) >= 5 and len(set(texts)) == 1:
        return f"{len(texts)} × {texts[0]}"  # noqa: RUF001 (a multiplication sign)
    return " ".join(texts)


def _invalid(field: FieldDefinition) -> float | None:
    """Return the number with which a field says that its value is not known."""
    text = field.invalid.strip("[]:,")
    if text in _INVALID:
        return _INVALID[text]
    try:
        return float(int(text, 16)) if text.lower().startswith("0x") else float(text) if text else None
    except ValueError:
        return None


def _number(field: FieldDefinition, value: object, invalid: float | None) -> str:
    if not isinstance(value, int | float):
        return printable(str(value))
    if value == invalid or not isfinite(value):
        return UNKNOWN
    name = getattr(value, "name", None)
    if isinstance(name, str):
        return name.removeprefix("_") or "0"
    if field.units == "us" and isinstance(value, int) and value in _CALENDAR:
        return f"{datetime.fromtimestamp(value / 1e6, UTC):%Y-%m-%d %H:%M:%S} UTC"
    if field.units in _CLOCKS and value >= 10 / _CLOCKS[field.units]:
        return f"{value * _CLOCKS[field.units]:.3f} s"
    return _with_unit(field, value)


def _with_unit(field: FieldDefinition, value: float) -> str:
    unit_format = _UNITS.get(field.units)
    if unit_format is not None:
        factor = field.factor * unit_format.factor
        decimals = 0 if isinstance(value, int) and factor == 1 else unit_format.decimals
        number = f"{value * factor:.{decimals}f}"
        return f"{_no_minus_zero(number)}{unit_format.suffix}"
    unit = f" {field.units}" if field.units else ""
    if isinstance(value, int) and field.factor == 1:
        return f"{int(value)}{unit}"
    number = f"{value * field.factor:.4g}"
    return f"{_no_minus_zero(number)}{unit}"


def _no_minus_zero(number: str) -> str:
    return number[1:] if number.startswith("-") and not number.strip("-0.") else number


def raw_hex(packet: Packet) -> str:
    """Return the bytes of a packet in hexadecimal, or `HIDDEN` if they hold a secret."""
    return HIDDEN if has_secret_fields(packet) else packet.raw.hex()
