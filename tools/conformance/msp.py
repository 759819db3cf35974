"""Vectors of MSP: payloads with their fields, frames with their bytes, from fixed seeds."""

from __future__ import annotations

import json
from random import Random
from typing import TYPE_CHECKING, Any, Final

from mavstack.msp import Frame, FrameVersion
from mavstack.msp.firmware_info import BETAFLIGHT, INAV, FirmwareInfo
from mavstack.msp.frame import Direction
from mavstack.msp.messages.codecs import (
    Bytes,
    ByVariant,
    Codec,
    CountedBytes,
    Items,
    NameList,
    Number,
    PrefixedText,
    RestText,
    Text,
)
from mavstack.msp.messages.fields import Layout, RecordCodec, layout_of
from mavstack.msp.messages.registry import all_messages

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.msp.messages.layout import TableMessage

#: Firmwares of the vectors: an old and a new Betaflight, and iNav.
FIRMWARES: Final = (
    FirmwareInfo(BETAFLIGHT, api=(1, 42)),
    FirmwareInfo(BETAFLIGHT, api=(1, 48)),
    FirmwareInfo(INAV, api=(2, 5)),
)
_LETTERS: Final = "ABCdef123"
_SEED: Final = 20


def msp_text() -> str:
    """Return the vectors as lines of JSON."""
    return "".join(json.dumps(each) + "\n" for each in (*_frames(), *_messages()))


def _frames() -> Iterator[dict[str, Any]]:
    random = Random(_SEED)
    for version in FrameVersion:
        for size in (0, 1, 17, 254, 255, 300):
            for direction in Direction:
                frame = Frame(random.randrange(1, 250), random.randbytes(size), direction, version)
                yield {
                    "frame": version.name,
                    "direction": str(direction),
                    "command": frame.command,
                    "payload": frame.payload.hex(),
                    "bytes": frame.encode().hex(),
                }


def _messages() -> Iterator[dict[str, Any]]:
    for message in all_messages():
        for firmware in FIRMWARES:
            if firmware.variant not in message.VARIANTS or _has_newer_records(message, firmware):
                continue
            random = Random(f"{message.__name__} {firmware.variant} {firmware.api}")
            for _ in range(2):
                yield _vector(message, _message(message, firmware, random), firmware)


def _has_newer_records(kind: type[TableMessage], firmware: FirmwareInfo) -> bool:
    """Return whether a list has records with fields that the firmware does not know: they have no end."""
    for facts in layout_of(kind).values():
        item = facts.codec.item if isinstance(facts.codec, Items) else None
        if isinstance(item, RecordCodec) and any(
            each.is_too_new_for(firmware) for each in layout_of(item.record).values()
        ):
            return True
    return False


def _vector(kind: type[TableMessage], message: TableMessage, firmware: FirmwareInfo) -> dict[str, Any]:
    payload = message.encode(firmware)
    major, minor = firmware.api
    return {
        "message": kind.__name__,
        "firmware": firmware.variant,
        "api": f"{major}.{minor}",
        "payload": payload.hex(),
        "fields": _json(kind.decode(payload, firmware), firmware),
    }


def _message(kind: type[Any], firmware: FirmwareInfo, random: Random) -> Any:  # noqa: ANN401 (of any class)
    values: dict[str, Any] = {}
    for name, facts in layout_of(kind).items():
        if facts.is_in(firmware):
            values[name] = _value(facts.codec, firmware, random, values)
    return kind(**values)


def _value(codec: Codec, firmware: FirmwareInfo, random: Random, values: dict[str, Any]) -> object:
    match codec:
        case Number():
            return codec.value(_raw(codec, random))
        case ByVariant():
            part = codec.inav if firmware.is_inav else codec.betaflight
            return _value(part, firmware, random, values)
        case RecordCodec():
            return _message(codec.record, firmware, random)
        case Items():
            count = values[codec.count_field] if codec.count_field else codec.count
            number = random.randrange(1, 4) if count is None else count
            return tuple(_value(codec.item, firmware, random, values) for _ in range(number))
        case Text() | PrefixedText():
            return "".join(random.choices(_LETTERS, k=random.randrange(0, (codec.length or 8) + 1)))
        case RestText():
            return "".join(random.choices(_LETTERS, k=5))
        case NameList():
            return tuple("".join(random.choices(_LETTERS, k=4)) for _ in range(3))
        case Bytes():
            return random.randbytes(codec.length or 4)
        case CountedBytes():
            return random.randbytes(3)
    raise AssertionError(codec)


def _raw(codec: Number, random: Random) -> int:
    if codec.kind is bool:
        return random.randrange(2)
    bits = 8 * codec.size
    low = -(1 << bits - 1) if codec.signed else 0
    return random.randrange(low, low + (1 << bits))


def _json(value: object, firmware: FirmwareInfo) -> object:
    if isinstance(value, Layout):
        present = (name for name, facts in layout_of(type(value)).items() if facts.is_in(firmware))
        fields = ((name, getattr(value, name)) for name in present)
        return {name: _json(each, firmware) for name, each in fields if each is not None}
    if isinstance(value, tuple):
        return [_json(each, firmware) for each in value]
    if isinstance(value, bytes):
        return list(value)
    return int(value) if isinstance(value, int) and not isinstance(value, bool) else value
