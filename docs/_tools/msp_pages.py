"""The reference of MSP: messages by area with their fields, and settings, out of their tables."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

from mavstack.msp.firmware_info import BETAFLIGHT, INAV
from mavstack.msp.messages.codecs import ByVariant, Items, Number
from mavstack.msp.messages.fields import FieldFacts, Record, RecordCodec, layout_of
from mavstack.msp.messages.registry import AREAS, messages_of
from mavstack.msp.settings.tables import ALL_SETTINGS

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import ModuleType

    from mavstack.msp.messages.codecs import Codec
    from mavstack.msp.messages.layout import TableMessage
    from mavstack.msp.settings import SettingDefinition

FIRMWARES = {BETAFLIGHT: "Betaflight", INAV: "iNav"}
_TITLES = {"rc": "Radio control", "gps": "GPS", "pid": "Controllers", "osd": "On-screen display"}
_TITLES |= {"vtx": "Video transmitter", "led_strip": "LED strip", "config": "Vehicle"}


def render_messages() -> str:
    """Return the reference of the messages, a section for each area."""
    return "\n".join(_area(area) for area in AREAS)


def render_settings() -> str:
    """Return the reference of the settings, a table for each firmware."""
    return "\n".join(_settings_of(variant) for variant in FIRMWARES)


def _area(area: ModuleType) -> str:
    name = area.__name__.rpartition(".")[2]
    title = _TITLES.get(name, name.replace("_", " ").capitalize())
    about = (area.__doc__ or "").splitlines()[0]
    head = f"## {title}\n\n{about} Module `{area.__name__}`.\n"
    return "\n".join((head, *(_message(message) for message in messages_of(area))))


def _message(message: type[TableMessage]) -> str:
    direction = "reply" if message.IS_REPLY else "request"
    facts = [f"`{message.NAME}` ({message.COMMAND})", direction]
    facts += [FIRMWARES[message.VARIANTS[0]]] if len(message.VARIANTS) == 1 else []
    facts += [f"since API {message.SINCE}"] if message.SINCE else []
    text = "\n\n".join(_paragraphs(message))
    head = f"### {message.__name__} {{ #{message.__name__} }}\n\n{', '.join(facts)}. {text}\n"
    rows = list(_rows(message))
    return "\n".join((head, *(["<table>", _FIELD_HEAD, *rows, "</table>\n"] if rows else [])))


def _paragraphs(message: type[TableMessage]) -> list[str]:
    text = (message.__doc__ or "").strip()
    return [" ".join(paragraph.split()) for paragraph in text.split("\n\n")]


_FIELD_HEAD = "<thead><tr><th>field</th><th>type</th><th>unit</th><th>scale</th><th>only</th></tr></thead>"


def _rows(layout: type, indent: str = "") -> Iterator[str]:
    for name, facts in layout_of(layout).items():
        only = [FIRMWARES[facts.variant]] if facts.variant else []
        only += [f"API {facts.since}"] if facts.since else []
        cells = (
            f"<code>{indent}{name}</code>",
            escape(_type(facts)),
            escape(facts.unit),
            _scale(facts),
            ", ".join(only),
        )
        yield f"<tr>{''.join(f'<td>{cell}</td>' for cell in cells)}</tr>"
        record = _record(facts.codec)
        if record is not None:
            yield from _rows(record, f"{indent}{name}[].")


def _type(facts: FieldFacts) -> str:
    number = _number(facts.codec)
    kind = "" if number is None or number.kind is None else f" {number.kind.__name__}"
    return facts.codec.wire_type + kind


def _scale(facts: FieldFacts) -> str:
    number = _number(facts.codec)
    if number is None or (number.per_unit == 1 and number.step == 1):
        return ""
    if number.per_unit != 1:
        return f"1/{number.per_unit:.0f}"
    return f"{number.offset} + {number.step}·n" if number.offset else f"{number.step}"


def _number(codec: Codec) -> Number | None:
    if isinstance(codec, ByVariant):
        codec = codec.betaflight
    if isinstance(codec, Items):
        codec = codec.item
    return codec if isinstance(codec, Number) else None


def _record(codec: Codec) -> type[Record] | None:
    if isinstance(codec, ByVariant):
        codec = codec.betaflight
    if isinstance(codec, Items):
        codec = codec.item
    return codec.record if isinstance(codec, RecordCodec) else None


_SETTING_COLUMNS = ("name", "meaning", "type", "range", "unit", "read, write")
_SETTING_HEAD = f"<thead><tr>{''.join(f'<th>{title}</th>' for title in _SETTING_COLUMNS)}</tr></thead>"


def _settings_of(variant: str) -> str:
    rows = [_setting(item) for item in ALL_SETTINGS if variant in item.variants]
    return "\n".join((f"## {FIRMWARES[variant]}\n", "<table>", _SETTING_HEAD, *rows, "</table>\n"))


def _setting(item: SettingDefinition) -> str:
    meaning = escape(item.description)
    if item.values:
        meaning += ": " + ", ".join(f"{number} {escape(name)}" for number, name in item.values.items())
    meaning += f". Since API {item.since}" if item.since else ""
    meaning += f". Up to API {item.until}" if item.until else ""
    names = "<br>".join(f"<code>{_breakable(name)}</code>" for name in (item.name, *item.aliases))
    limits = f"{item.minimum:.10g} … {item.maximum:.10g}"
    commands = f"{item.read.COMMAND}, {item.write.COMMAND}"
    cells = (names, meaning, item.type.name, limits, escape(item.unit), commands)
    return f"<tr>{''.join(f'<td>{cell}</td>' for cell in cells)}</tr>"


def _breakable(name: str) -> str:
    """Return a name whose line may break behind an underscore."""
    return name.replace("_", "_<wbr>")
