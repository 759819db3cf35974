"""One line per packet, as JSON or as text."""

from __future__ import annotations

import json
from datetime import datetime
from typing import TYPE_CHECKING

from mavstack.cli.common.field_values import field_texts, raw_hex
from mavstack.wire import fields_json

if TYPE_CHECKING:
    from mavstack.wire import Packet

_NO_CLOCK = "--:--:--.---"


def json_line(packet: Packet, time: float | None, source: str = "") -> str:
    """Return a packet as one JSON object without secrets; `time` is Unix time in seconds.

    `source` is the link or file of the packet, if there are several.
    """
    fields = fields_json(packet)
    # Formatted directly: the json module takes several times as long, and numbers need no escapes.
    head = (
        f'{{"time": {"null" if time is None else repr(time)}, {_source(source)}"system": {packet.system}, '
        f'"component": {packet.component}, "id": {packet.message_id}, "message": '
    )
    if fields is None:
        return f'{head}null, "raw": "{raw_hex(packet)}"}}'
    return f'{head}"{packet.name}", "fields": {fields}}}'


def _source(source: str) -> str:
    return f'"source": {json.dumps(source)}, ' if source else ""


def clock_text(time: float | None) -> str:
    """Return the local time of day; dashes if a time is not known or beyond the calendar."""
    try:
        return f"{datetime.fromtimestamp(time).astimezone():%H:%M:%S.%f}"[:-3] if time else _NO_CLOCK
    except (ValueError, OverflowError, OSError):  # the time is out of range in a damaged or forged recording
        return _NO_CLOCK


def text_line(packet: Packet, time: float | None, label: str = "") -> str:
    """Return a packet as text without secrets; `time` is Unix time in seconds.

    `label` is the letter of the link or file, if there are several.
    """
    clock = clock_text(time) + (f" {label}" if label else "")
    source = f"{packet.system}/{packet.component}"
    message = packet.message
    if message is None:
        return f"{clock} {source:>7} unknown id {packet.message_id}: {raw_hex(packet)}"
    values = " ".join(f"{value.name}={value.text}" for value in field_texts(message))
    return f"{clock} {source:>7} {packet.name} {values}"
