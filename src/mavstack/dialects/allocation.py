"""Ids that the MAVLink project allocates, and those that official dialects use.

The developer guide (MAVLink XML schema, `message`) reserves ids up to 149 and from 230 to 255 for common.xml,
leaves 180 to 229 to dialects that need MAVLink 1, and regards all other ids up to 255 as reserved. Above,
official dialects have ranges of their own (the comments of all.xml). Two dialects in one network must not use
one id for two messages, or one value of MAV_CMD for two commands: who receives both decodes nonsense.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.dialects.dialect import Dialect
from mavstack.dialects.tables import official_names

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from mavstack.dialects.model import DialectDefinition, EnumDefinition, MessageDefinition

#: Ids that dialects may use for messages of MAVLink 1.
MAVLINK_1_IDS: Final = range(180, 230)
COMMANDS: Final = "MAV_CMD"
#: Ranges of message ids above 255, by official dialect; the first range that contains an id is used.
RANGES: Final = (
    ("loweheiser", range(10150, 10200)),
    ("ASLUAV", range(8000, 9000)),
    ("common", range(256, 10001)),
    ("uAvionix", range(10001, 11000)),
    ("ardupilotmega", range(11000, 12000)),
    ("common", range(12900, 13000)),
    ("icarous", range(42000, 43000)),
    ("cubepilot", range(50000, 50100)),
    ("csAirLink", range(52000, 52100)),
    ("storm32", range(60000, 60050)),
    ("AVSSUAS", range(60050, 60100)),
)


class Official(NamedTuple):
    """A message of an official dialect."""

    dialect: str
    definition: MessageDefinition


def id_warnings(definition: DialectDefinition) -> Iterator[tuple[int, str]]:
    """Yield the line and text of each id that is reserved, or that an official dialect uses otherwise.

    Args:
        definition: The content of one file.
    """
    by_id, by_name = _official_messages()
    for message in definition.messages:
        same_id, same_name = by_id.get(message.id, ()), by_name.get(message.name, ())
        if any(_is_equal(message, item.definition) for item in same_name):
            continue
        problem = (
            _conflict(message, same_id) or _changed(message, same_name) or _reserved(message, definition.name)
        )
        if problem:
            yield message.line, problem
    for enum in definition.enums:
        if enum.name == COMMANDS:
            yield from _command_conflicts(enum)


def _is_equal(message: MessageDefinition, other: MessageDefinition) -> bool:
    """Return whether two messages are one on the wire."""
    return (message.id, message.crc_extra) == (other.id, other.crc_extra)


def _conflict(message: MessageDefinition, official: Sequence[Official]) -> str:
    """Return the problem of an id that only other messages have."""
    if not official or any(item.definition.name == message.name for item in official):
        return ""
    names = ", ".join(f"{item.definition.name} of {item.dialect}" for item in official)
    return f"message {message.name} has the id {message.id} of {names}"


def _changed(message: MessageDefinition, official: Sequence[Official]) -> str:
    """Return the problem of a message that the official dialects define differently."""
    if not official:
        return ""
    dialect, other = official[0]
    if other.id != message.id:
        return f"message {message.name} has the id {message.id}, in {dialect} it has {other.id}"
    return (
        f"message {message.name} has CRC_EXTRA {message.crc_extra}, in {dialect} {other.crc_extra}: "
        f"neither side reads the other's packets"
    )


def _reserved(message: MessageDefinition, dialect: str) -> str:
    """Return the problem of an id that belongs to another dialect."""
    if _is_official(dialect) or message.id in MAVLINK_1_IDS:
        return ""
    if message.id < 256:
        return (
            f"message {message.name} has the reserved id {message.id}; "
            "custom messages have ids above 255, or 180 to 229 if MAVLink 1 must carry them"
        )
    owner = next((name for name, ids in RANGES if message.id in ids), None)
    return f"message {message.name} has the id {message.id} of the range of {owner}" if owner else ""


def _is_official(dialect: str) -> bool:
    return dialect.lower() in {name.lower() for name in official_names()}


def _command_conflicts(enum: EnumDefinition) -> Iterator[tuple[int, str]]:
    known = _official_commands()
    for entry in enum.entries:
        others = known.get(entry.value, {})
        if others and entry.name not in others:
            name, dialect = next(iter(others.items()))
            yield entry.line, f"{entry.name} has the value {entry.value} of {name} of {dialect}"


@cache
def _official_messages() -> tuple[dict[int, list[Official]], dict[str, list[Official]]]:
    """Return the messages of all official dialects by id and by name."""
    by_id: dict[int, list[Official]] = {}
    by_name: dict[str, list[Official]] = {}
    for name in official_names():
        for message in Dialect.load(name).own_definition.messages:
            by_id.setdefault(message.id, []).append(Official(name, message))
            by_name.setdefault(message.name, []).append(Official(name, message))
    return by_id, by_name


@cache
def _official_commands() -> dict[int, dict[str, str]]:
    """Return the dialect of each command of all official dialects, by value and name."""
    commands: dict[int, dict[str, str]] = {}
    for name in official_names():
        enum = Dialect.load(name).own_definition.enums_by_name.get(COMMANDS)
        for entry in enum.entries if enum else ():
            commands.setdefault(entry.value, {}).setdefault(entry.name, name)
    return commands
