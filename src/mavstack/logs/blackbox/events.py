"""Events of a flight: their numbers, their content and their texts."""

from __future__ import annotations

from math import nan
from struct import unpack_from
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.logs.blackbox.encodings import signed_vb, unsigned_vb

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.logs.schema import EnumSchema

SYNC_BEEP, ADJUSTMENT, RESUME, DISARM, FLIGHT_MODE, LOG_END = 0, 13, 14, 15, 30, 255
EVENTS: Final[Mapping[int, str]] = MappingProxyType(
    {
        SYNC_BEEP: "SYNC_BEEP",
        10: "AUTOTUNE_CYCLE_START",
        11: "AUTOTUNE_CYCLE_RESULT",
        12: "AUTOTUNE_TARGETS",
        ADJUSTMENT: "INFLIGHT_ADJUSTMENT",
        RESUME: "LOGGING_RESUME",
        DISARM: "DISARM",
        20: "GTUNE_CYCLE_RESULT",
        FLIGHT_MODE: "FLIGHT_MODE",
        40: "TWITCH_TEST",
        LOG_END: "LOG_END",
    }
)
DISARM_REASONS: Final = (
    "ARMING_DISABLED",
    "FAILSAFE",
    "THROTTLE_TIMEOUT",
    "STICKS",
    "SWITCH",
    "CRASH_PROTECTION",
    "RUNAWAY_TAKEOFF",
    "GPS_RESCUE",
    "SERIAL_IO",
)
#: Sizes in bytes of the contents of events from old firmware, which are skipped.
_SIZES: Final = {10: 5, 11: 4, 12: 8, 40: 5}
_GTUNE: Final = 20
_END_TEXT: Final = b"End of log\0"
_FLOAT_VALUE: Final = 0x80


class Event(NamedTuple):
    """An event.

    Attributes:
        kind: Number of the event.
        time: Its own time in microseconds, or None.
        value: First value: the reason of DISARM, the new flags of FLIGHT_MODE, the loop iteration of
            LOGGING_RESUME, the function of INFLIGHT_ADJUSTMENT; NaN without one.
        detail: Second value: the flags before FLIGHT_MODE, the new value of INFLIGHT_ADJUSTMENT; NaN without
            one.
    """

    kind: int
    time: int | None = None
    value: float = nan
    detail: float = nan


def read_event(data: bytes, position: int) -> tuple[Event | None, int]:
    """Read an event.

    Args:
        data: The bytes of the flight.
        position: Position behind the letter of the frame.

    Returns:
        The event, or None if the bytes are no event, and the position behind it.

    Raises:
        IndexError: The flight ends inside the event.
    """
    kind = data[position]
    position += 1
    if kind == SYNC_BEEP:
        time, position = unsigned_vb(data, position)
        return Event(kind, time), position
    if kind == RESUME:
        iteration, position = unsigned_vb(data, position)
        time, position = unsigned_vb(data, position)
        return Event(kind, time, iteration), position
    if kind == DISARM:
        reason, position = unsigned_vb(data, position)
        return Event(kind, None, reason), position
    if kind == FLIGHT_MODE:
        flags, position = unsigned_vb(data, position)
        before, position = unsigned_vb(data, position)
        return Event(kind, None, flags, before), position
    if kind == ADJUSTMENT:
        return _adjustment(data, position)
    return _other(data, position, kind)


def _adjustment(data: bytes, position: int) -> tuple[Event, int]:
    function = data[position]
    position += 1
    if function < _FLOAT_VALUE:
        number, position = signed_vb(data, position)
        return Event(ADJUSTMENT, None, function, number), position
    if position + 4 > len(data):
        raise IndexError
    (value,) = unpack_from("<f", data, position)
    return Event(ADJUSTMENT, None, function - _FLOAT_VALUE, value), position + 4


def _other(data: bytes, position: int, kind: int) -> tuple[Event | None, int]:
    if kind == LOG_END:
        end = position + len(_END_TEXT)
        return (Event(kind) if data[position:end] == _END_TEXT else None), min(end, len(data))
    if kind == _GTUNE:
        _, position = signed_vb(data, position + 1)
        size = 2
    elif kind in _SIZES:
        size = _SIZES[kind]
    else:
        return None, position
    if position + size > len(data):
        raise IndexError
    return Event(kind), position + size


def event_text(kind: int, value: float, modes: EnumSchema | None) -> str:
    """Return an event in words.

    Args:
        kind: Number of the event.
        value: Its first value.
        modes: The flight modes, or None if their names are not known.
    """
    name = EVENTS.get(kind, str(kind))
    if kind == DISARM:
        number = int(value)
        return f"{name}: {DISARM_REASONS[number] if number < len(DISARM_REASONS) else number}"
    if kind == FLIGHT_MODE:
        return f"{name}: {f'0x{int(value):x}' if modes is None else modes.name_of(int(value))}"
    return name
