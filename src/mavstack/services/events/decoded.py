"""An event with the words of its metadata."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from mavstack.services.events.definitions import EventContent, decode_content
from mavstack.services.events.sender import LogLevel

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.services.addressing import Address
    from mavstack.services.events.definitions import EventDefinition, Value
    from mavstack.services.events.receiver import EventReceived

_LEVELS: Final = frozenset(map(int, LogLevel))


@dataclass(frozen=True, slots=True)
class DecodedEvent:
    """An event of a component (EVENT); `str(event)` is its message.

    Attributes:
        source: The component that sent it.
        sequence: Its sequence number.
        id: Its id: the component id of the namespace in the highest byte, and 24 bits.
        time: The time of receipt, in Unix seconds.
        time_boot: The time of the event, in seconds since the component booted.
        severity: The level for users: as MAV_SEVERITY; PROTOCOL is for programs only.
        internal_severity: The level for logs.
        name: Namespace and name, "px4::commander_armed_by"; empty if the metadata of the event is not known.
        message: The message with its arguments; the id if the metadata is not known.
        description: A longer text with the arguments; may be empty.
        group: The group: "default", "calibration", "health", "arming_check"; empty if not known.
        arguments: The arguments by name; an enum's value as its name.
        data: The 40 bytes of arguments as sent.
    """

    source: Address
    sequence: int
    id: int
    time: float
    time_boot: float
    severity: LogLevel | int
    internal_severity: LogLevel | int
    name: str
    message: str
    description: str = ""
    group: str = ""
    arguments: Mapping[str, Value] = field(default_factory=dict, hash=False)
    data: bytes = b""

    @property
    def is_known(self) -> bool:
        """True if the metadata of the event is known."""
        return bool(self.name)

    def __str__(self) -> str:
        return self.message


def decode_event(event: EventReceived, table: Mapping[int, EventDefinition]) -> DecodedEvent:
    """Decode an event.

    Args:
        event: The event as received.
        table: The definitions by id, from `parse_event_metadata`.

    Returns:
        The event with its words; without a definition, its message is the id.
    """
    definition = table.get(event.id)
    content = EventContent("", f"event {event.id:#010x} (no metadata)")
    if definition is not None:
        content = decode_content(definition, event.arguments)
    return DecodedEvent(
        source=event.source,
        sequence=event.sequence,
        id=event.id,
        time=event.time,
        time_boot=event.time_boot_ms / 1000,
        severity=_level(event.level),
        internal_severity=_level(event.internal_level),
        name=content.name,
        message=content.message,
        description=content.description,
        group="" if definition is None else definition.group,
        arguments=content.arguments,
        data=event.arguments,
    )


def _level(number: int) -> LogLevel | int:
    return LogLevel(number) if number in _LEVELS else number
