"""Field values as people read them: units of daily use, names of enum values, nothing for "not known".

A value that its definition calls invalid is shown as a dash. Text from the wire is shown without its control
characters: a vehicle must not be able to move the reader's cursor.
"""

from __future__ import annotations

from datetime import UTC, datetime
from enum import IntFlag
from math import isfinite, pi
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.dialects.secrets import secret_fields
from mavstack.security import holds_secret

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.dialects import Message
    from mavstack.dialects.model import FieldDefinition
    from mavstack.wire import Packet

#: What stands in place of a secret.
HIDDEN: Final = "(hidden)"
UNKNOWN: Final = "–"  # noqa: RUF001 (a dash, as in a table)


class Shown(NamedTuple):
    """How a unit is shown: by what to multiply, under which sign, with how many decimals."""

    factor: float
    sign: str
    decimals: int


class Value(NamedTuple):
    """A field as it is shown: whether it has a value at all, and whether that is a set of flags."""

    name: str
    text: str
    known: bool = True
    flags: bool = False


_DEGREES: Final = 180 / pi
_UNITS: Final[Mapping[str, Shown]] = MappingProxyType(
    {
        "rad": Shown(_DEGREES, "°", 1),
        "rad/s": Shown(_DEGREES, "°/s", 1),
        "mrad/s": Shown(_DEGREES / 1000, "°/s", 1),
        "deg": Shown(1, "°", 1),
        "deg/2": Shown(2, "°", 0),
        "cdeg": Shown(0.01, "°", 1),
        "degE5": Shown(1e-5, "°", 5),
        "degE7": Shown(1e-7, "°", 6),
        "deg/s": Shown(1, "°/s", 1),
        "ddeg/s": Shown(0.1, "°/s", 1),
        "mm": Shown(0.001, " m", 2),
        "cm": Shown(0.01, " m", 2),
        "dm": Shown(0.1, " m", 1),
        "m": Shown(1, " m", 2),
        "dam": Shown(10, " m", 0),
        "mm/s": Shown(0.001, " m/s", 2),
        "cm/s": Shown(0.01, " m/s", 2),
        "dm/s": Shown(0.1, " m/s", 1),
        "m/s": Shown(1, " m/s", 2),
        "m/s*5": Shown(0.2, " m/s", 1),
        "m/s/s": Shown(1, " m/s²", 2),
        "mG": Shown(0.001, " g", 3),
        "mgauss": Shown(0.001, " G", 3),
        "gauss": Shown(1, " G", 3),
        "mV": Shown(0.001, " V", 2),
        "cV": Shown(0.01, " V", 2),
        "V": Shown(1, " V", 2),
        "mA": Shown(0.001, " A", 2),
        "cA": Shown(0.01, " A", 2),
        "A": Shown(1, " A", 2),
        "%": Shown(1, " %", 0),
        "d%": Shown(0.1, " %", 1),
        "c%": Shown(0.01, " %", 1),
        "degC": Shown(1, " °C", 1),
        "cdegC": Shown(0.01, " °C", 1),
        "cs": Shown(0.01, " s", 2),
        "ds": Shown(0.1, " s", 1),
        "ms": Shown(1, " ms", 0),
        "us": Shown(1, " µs", 0),
        "hPa": Shown(1, " hPa", 1),
        "bytes": Shown(1, " B", 0),
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
#: Microseconds since 1970 that are a date rather than a duration: the years 2001 to 2286.
_CALENDAR = range(10**15, 10**16)


def message_values(message: Message) -> list[Value]:
    """The fields of a message in the order of its definition."""
    definition = type(message).definition
    secret = secret_fields(definition.name)
    return [
        Value(field.name, HIDDEN) if field.name in secret else _value(field, getattr(message, attribute))
        for field, attribute in zip(definition.fields, message.__match_args__, strict=True)
    ]


def clean(text: str) -> str:
    """Text from the wire with nothing in it that a terminal would obey."""
    return "".join(letter if letter.isprintable() else "\N{REPLACEMENT CHARACTER}" for letter in text)


def _value(field: FieldDefinition, value: object) -> Value:
    if isinstance(value, str):
        text = clean(value.strip())
        return Value(field.name, text, bool(text))
    if isinstance(value, bytes):
        text = value.rstrip(b"\0").hex(" ")
        return Value(field.name, f"[{text}]", bool(text))
    invalid = _invalid(field)
    if isinstance(value, tuple | list):
        texts = [_number(field, item, invalid) for item in value]
        while texts and texts[-1] == UNKNOWN:
            texts.pop()
        return Value(field.name, f"[{_run_lengths(texts)}]", bool(texts))
    text = _number(field, value, invalid)
    return Value(field.name, text, text != UNKNOWN, isinstance(value, IntFlag))


def _run_lengths(texts: list[str]) -> str:
    """The texts with spaces between, five or more of the same as one."""
    if len(texts) >= 5 and len(set(texts)) == 1:
        return f"{len(texts)} × {texts[0]}"  # noqa: RUF001 (a multiplication sign)
    return " ".join(texts)


def _invalid(field: FieldDefinition) -> float | None:
    """The number by which a field says that it is not known."""
    text = field.invalid.strip("[]:,")
    if text in _INVALID:
        return _INVALID[text]
    try:
        return float(int(text, 16)) if text.lower().startswith("0x") else float(text) if text else None
    except ValueError:
        return None


def _number(field: FieldDefinition, value: object, invalid: float | None) -> str:
    if not isinstance(value, int | float):
        return clean(str(value))
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
    shown = _UNITS.get(field.units)
    if shown is not None:
        factor = field.factor * shown.factor
        decimals = 0 if isinstance(value, int) and factor == 1 else shown.decimals
        number = f"{value * factor:.{decimals}f}"
        return f"{_no_minus_zero(number)}{shown.sign}"
    unit = f" {field.units}" if field.units else ""
    if isinstance(value, int) and field.factor == 1:
        return f"{int(value)}{unit}"
    number = f"{value * field.factor:.4g}"
    return f"{_no_minus_zero(number)}{unit}"


def _no_minus_zero(number: str) -> str:
    return number[1:] if number.startswith("-") and not number.strip("-0.") else number


def raw_hex(packet: Packet) -> str:
    """The bytes of a packet as text, unless they hold a secret."""
    return HIDDEN if holds_secret(packet) else packet.raw.hex()
