"""The tables of all messages as JSON, from which libraries in other languages are generated.

The ground station in the browser interprets them (`web/src/lib/msp`); `conformance/msp.jsonl` holds payloads
with their fields.
"""

from __future__ import annotations

import dataclasses
from enum import IntEnum, IntFlag
from typing import TYPE_CHECKING, Any, Final

from mavstack.msp.messages.arming import ArmingDisableFlag
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
from mavstack.msp.messages.config import BAUD_RATES, INAV_BAUD_RATES
from mavstack.msp.messages.fields import RecordCodec, layout_of
from mavstack.msp.messages.modes import BETAFLIGHT_MODES, INAV_MODES
from mavstack.msp.messages.osd_items import OSD_ITEMS
from mavstack.msp.messages.pid import BETAFLIGHT_PID_NAMES, INAV_PID_NAMES
from mavstack.msp.messages.registry import all_messages
from mavstack.msp.serial_ports import PORT_NAMES

if TYPE_CHECKING:
    from mavstack.msp.messages.layout import TableMessage

_KINDS: Final = {
    Text: "text",
    PrefixedText: "prefixed",
    RestText: "rest",
    NameList: "names",
    Bytes: "bytes",
    CountedBytes: "counted",
}


def msp_facts() -> dict[str, Any]:
    """Return the messages, and the names of modes, items of the display, ports and reasons not to arm.

    Returns:
        A JSON object; the classes of messages are the keys of `messages`.
    """
    return {
        "messages": {message.__name__: message_facts(message) for message in all_messages()},
        "modes": {"BTFL": BETAFLIGHT_MODES, "INAV": INAV_MODES},
        "pids": {"BTFL": BETAFLIGHT_PID_NAMES, "INAV": INAV_PID_NAMES},
        "osdItems": OSD_ITEMS,
        "baudRates": {"BTFL": BAUD_RATES, "INAV": INAV_BAUD_RATES},
        "portNames": dict(sorted(PORT_NAMES.items())),
        "armingReasons": {flag.value.bit_length() - 1: flag.name for flag in ArmingDisableFlag},
    }


def message_facts(message: type[TableMessage]) -> dict[str, Any]:
    """Return the facts of a message for JSON.

    Args:
        message: The class of the message.
    """
    return {
        "command": message.COMMAND,
        "name": message.NAME,
        "isReply": message.IS_REPLY,
        "variants": message.VARIANTS,
        "fields": _fields(message),
    }


def _fields(layout: type) -> list[dict[str, Any]]:
    defaults = {item.name: item.default for item in dataclasses.fields(layout)}
    return [
        {
            "name": name,
            "codec": codec_facts(facts.codec),
            "optional": defaults[name] is None,
            **_present(unit=facts.unit, since=facts.since, variant=facts.variant),
            **({"default": int(default)} if isinstance(default := defaults[name], int) else {}),
        }
        for name, facts in layout_of(layout).items()
    ]


def codec_facts(codec: Codec) -> dict[str, Any]:
    """Return the facts of a codec for JSON.

    Args:
        codec: The codec of a field.
    """
    match codec:
        case Number():
            return {"kind": codec.wire_type, **_scale(codec), **_names(codec)}
        case ByVariant():
            both = {"BTFL": codec_facts(codec.betaflight), "INAV": codec_facts(codec.inav)}
            return {"kind": "variant", **both}
        case RecordCodec():
            return {"kind": "record", "fields": _fields(codec.record)}
        case Items():
            rest = _present(
                count=codec.count, counted=codec.counted, leave=codec.leave, countField=codec.count_field
            )
            return {"kind": "items", "item": codec_facts(codec.item), **rest}
    lengths = {name: getattr(codec, name) for name in ("length", "fill") if hasattr(codec, name)}
    return {"kind": _KINDS[type(codec)], **lengths}


def _scale(codec: Number) -> dict[str, float]:
    values = {"perUnit": (codec.per_unit, 1), "step": (codec.step, 1), "offset": (codec.offset, 0)}
    return {name: value for name, (value, default) in values.items() if value != default}


def _names(codec: Number) -> dict[str, Any]:
    kind = codec.kind
    if kind is bool:
        return {"isBool": True}
    if kind is None or not issubclass(kind, (IntEnum, IntFlag)):
        return {}
    names = {int(member): member.name for member in kind}
    return {"bits" if issubclass(kind, IntFlag) else "values": names}


def _present(**values: object) -> dict[str, object]:
    return {name: value for name, value in values.items() if value not in (None, "", False, 0)}
