"""Messages with random values, out of their own tables of facts."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any

from hypothesis import assume
from hypothesis import strategies as st

from mavstack.msp.messages.codecs import (
    Bytes,
    ByVariant,
    CountedBytes,
    Items,
    NameList,
    Number,
    PrefixedText,
    RestText,
    Text,
)
from mavstack.msp.messages.fields import RecordCodec, layout_of
from mavstack.msp.messages.layout import TableMessage

if TYPE_CHECKING:
    from mavstack.msp import FirmwareInfo

LETTERS = st.characters(codec="ascii", categories=("L", "N"))


def numbers(codec: Number) -> st.SearchStrategy[Any]:
    if codec.kind is bool:
        return st.booleans()
    if codec.kind is not None:
        return st.sampled_from([member for member in codec.kind if int(member) < 1 << 8 * codec.size])
    raw = st.integers(-(1 << 8 * codec.size - 1), (1 << 8 * codec.size - 1) - 1)
    if not codec.signed:
        raw = st.integers(0, (1 << 8 * codec.size) - 1)
    return raw.map(codec.value)


def values(codec: object, firmware: FirmwareInfo | None) -> st.SearchStrategy[Any]:
    match codec:
        case Number():
            return numbers(codec)
        case ByVariant():
            return values(codec.inav if firmware and firmware.is_inav else codec.betaflight, firmware)
        case RecordCodec():
            return records(codec.record, firmware)
        case Items():
            low, high = codec.count or 0, 4 if codec.count is None else codec.count
            return st.lists(values(codec.item, firmware), min_size=low, max_size=high).map(tuple)
        case Text() | PrefixedText():
            return st.text(LETTERS, max_size=codec.length or 8)
        case RestText():
            return st.text(LETTERS, max_size=16)
        case NameList():
            return st.lists(st.text(LETTERS, min_size=1, max_size=8), max_size=4).map(tuple)
        case Bytes():
            return st.binary(min_size=codec.length or 0, max_size=codec.length or 8)
        case CountedBytes():
            return st.binary(max_size=8)
    raise AssertionError(codec)


@st.composite
def records(draw: st.DrawFn, kind: type, firmware: FirmwareInfo | None, *, complete: bool = False) -> Any:
    """A record or message that the firmware can send; without `complete` its last fields may be missing."""
    fields = [name for name, facts in layout_of(kind).items() if facts.is_in(firmware)]
    optional = [
        item.name for item in dataclasses.fields(kind) if item.default is None and item.name in fields
    ]
    whole = complete or not issubclass(kind, TableMessage)
    kept = len(optional) if whole else draw(st.integers(0, len(optional)))
    present = [name for name in fields if name not in optional[kept:]]
    drawn = {name: draw(values(layout_of(kind)[name].codec, firmware)) for name in present}
    for name in present:  # an optional list without items cannot be told from one that is missing
        assume(name not in optional or drawn[name] != ())
    if "item_count" in drawn and "items" in drawn:
        drawn["item_count"] = len(drawn["items"])
    return kind(**drawn)
