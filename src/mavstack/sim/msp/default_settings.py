"""Defaults of the settings of a firmware, read from a TOML file.

A section holds the fields of a message by their names. Values of an enum are its names ("GPS|TELEMETRY"),
and bytes are hexadecimal.
"""

from __future__ import annotations

import tomllib
from functools import reduce
from importlib.resources import files
from operator import or_
from typing import TYPE_CHECKING, Any, TypeVar

from mavstack.msp.firmware_info import BETAFLIGHT
from mavstack.msp.messages.codecs import Bytes, ByVariant, Items, Number
from mavstack.msp.messages.fields import Layout, RecordCodec, layout_of
from mavstack.msp.messages.registry import all_messages

if TYPE_CHECKING:
    from mavstack.msp.messages.codecs import Codec
    from mavstack.msp.messages.layout import TableMessage

LayoutT = TypeVar("LayoutT", bound=Layout)


def read_defaults(name: str, variant: str = BETAFLIGHT) -> tuple[TableMessage, ...]:
    """Return the messages of a file in this folder, for a variant of the firmware."""
    messages = {message.__name__: message for message in all_messages()}
    sections = tomllib.loads((files(__package__) / name).read_text("ascii"))
    return tuple(_build(messages[section], values, variant) for section, values in sections.items())


def _build(layout: type[LayoutT], values: dict[str, Any], variant: str) -> LayoutT:
    codecs = {name: facts.codec for name, facts in layout_of(layout).items()}
    return layout(**{name: _value(codecs[name], value, variant) for name, value in values.items()})


def _value(codec: Codec, value: Any, variant: str) -> object:  # noqa: ANN401 - a value of TOML
    """Return the value of a field for one in the file."""
    match codec:
        case ByVariant():
            return _value(codec.betaflight if variant == BETAFLIGHT else codec.inav, value, variant)
        case Items():
            return tuple(_value(codec.item, each, variant) for each in value)
        case RecordCodec():
            return _build(codec.record, value, variant)
        case Number(kind=kind) if kind is not None and isinstance(value, str):
            return reduce(or_, (getattr(kind, name) for name in value.split("|")))
        case Bytes():
            return bytes.fromhex(value)
    return value
