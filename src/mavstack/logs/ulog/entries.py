"""The messages of a ULog that are not records: information, parameters, texts, dropouts.

A value has a key `type name`, such as `uint32_t ver_sw_release` or `char[6] sys_name`. Parameters before the
end of the definitions are initial values, later ones are changes. A message without a time gets the latest
time of a record before it.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from operator import itemgetter
from struct import Struct, calcsize, error, unpack
from typing import TYPE_CHECKING, Final, TypeAlias

from mavstack.logs.mapped_pages import STEP

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from typing import Any

    from mavstack._core import UlogIndex

    Done = Callable[[int, int], object]

#: A number, a text (`char[n]`), bytes (`uint8_t[n]` and unknown types), or the elements of another array.
Value: TypeAlias = "int | float | bool | str | bytes | tuple[int | float | bool, ...]"

_KEY: Final = re.compile(r"(?P<type>[^\[\] ]+)(?:\[(?P<length>\d+)\])? (?P<name>\S+)")
_CODES: Final = {
    "int8_t": "b",
    "uint8_t": "B",
    "int16_t": "h",
    "uint16_t": "H",
    "int32_t": "i",
    "uint32_t": "I",
    "int64_t": "q",
    "uint64_t": "Q",
    "float": "f",
    "double": "d",
    "bool": "?",
}
_TEXT: Final = Struct("<BQ")
_TAGGED_TEXT: Final = Struct("<BHQ")
_LOWEST_LEVEL, _MAX_SEVERITY, _INFO = ord("0"), 7, 6
#: Names of the groups of default values, by bit.
_DEFAULT_GROUPS: Final = {1: "system", 2: "configuration"}


@dataclass(frozen=True, slots=True)
class LoggedText:
    """A text that a program on the vehicle printed.

    Attributes:
        boot_us: Time since boot in microseconds.
        severity: MAV_SEVERITY, 0 (emergency) to 7 (debug).
        text: The text.
        tag: Number of the program, or None.
    """

    boot_us: int
    severity: int
    text: str
    tag: int | None = None


@dataclass(frozen=True, slots=True)
class Dropout:
    """A time in which the logger lost messages.

    Attributes:
        boot_us: Time since boot in microseconds, at which the loss was noted.
        duration: Duration in seconds.
    """

    boot_us: int
    duration: float


@dataclass(slots=True)
class Entries:
    """All messages of a ULog that are not records.

    Attributes:
        information: Values by name ('I').
        multi_information: For each name a list of values ('M'), each a list of parts.
        parameters: Values at the beginning of the log ('P'), by name.
        parameter_changes: Time since boot in microseconds, name and new value of each change.
        defaults: Default values ('Q') by group ("system", "configuration") and name.
        dropouts: Losses in the order of the file ('O').
        damaged: Number of messages whose content makes no sense.
    """

    information: dict[str, Value] = field(default_factory=dict)
    multi_information: dict[str, list[list[Value]]] = field(default_factory=dict)
    parameters: dict[str, float] = field(default_factory=dict)
    parameter_changes: list[tuple[int, str, float]] = field(default_factory=list)
    defaults: dict[str, dict[str, float]] = field(default_factory=dict)
    dropouts: list[Dropout] = field(default_factory=list)
    damaged: int = 0


def read_entries(index: UlogIndex, done: Done | None = None) -> Entries:
    """Return the messages of a file that are not records.

    Args:
        index: The index of the file.
        done: Called with each part of the file that was read.
    """
    entries = Entries()
    for kind, reader in _READERS.items():
        for position, time, body in index.messages(kind, step=STEP, done=done):
            try:
                reader(entries, body, time, _is_change(index, position))
            except (ValueError, error):
                entries.damaged += 1
    return entries


def _is_change(index: UlogIndex, position: int) -> bool:
    """Return whether a position is after the definitions."""
    return index.definitions_end is not None and position > index.definitions_end


def read_texts(index: UlogIndex, done: Done | None = None) -> list[LoggedText]:
    """Return the texts of a file, in its order.

    Args:
        index: The index of the file.
        done: Called with each part of the file that was read.
    """
    found = []
    for kind, head in (("L", _TEXT), ("C", _TAGGED_TEXT)):
        messages = index.messages(kind, step=STEP, done=done)
        found += [(position, _text(body, head)) for position, _, body in messages]
    return [text for _, text in sorted(found, key=itemgetter(0)) if text is not None]


def _text(body: bytes, head: Struct) -> LoggedText | None:
    if len(body) < head.size:
        return None
    level, *tag, time = head.unpack_from(body)
    severity = level - _LOWEST_LEVEL
    known = severity if 0 <= severity <= _MAX_SEVERITY else _INFO
    return LoggedText(time, known, body[head.size :].decode("utf-8", "replace"), *tag)


def _read_information(entries: Entries, body: bytes, _time: int, _change: bool) -> None:
    name, value = parse_value(body)
    entries.information[name] = value


def _read_multiple(entries: Entries, body: bytes, _time: int, _change: bool) -> None:
    name, value = parse_value(body[1:])
    lists = entries.multi_information.setdefault(name, [])
    if body[0] and lists:
        lists[-1].append(value)
    else:
        lists.append([value])


def _read_parameter(entries: Entries, body: bytes, time: int, change: bool) -> None:
    name, value = _number(body)
    if change:
        entries.parameter_changes.append((time, name, value))
    else:
        entries.parameters[name] = value


def _read_default(entries: Entries, body: bytes, _time: int, _change: bool) -> None:
    name, value = _number(body[1:])
    for bit, group in _DEFAULT_GROUPS.items():
        if body[0] & bit:
            entries.defaults.setdefault(group, {})[name] = value


def _read_dropout(entries: Entries, body: bytes, time: int, _change: bool) -> None:
    entries.dropouts.append(Dropout(time, int.from_bytes(body, "little") / 1000))


_READERS: Final[Mapping[str, Callable[[Entries, bytes, int, bool], None]]] = {
    "I": _read_information,
    "M": _read_multiple,
    "P": _read_parameter,
    "Q": _read_default,
    "O": _read_dropout,
}


def _number(body: bytes) -> tuple[str, float]:
    name, value = parse_value(body)
    if not isinstance(value, int | float):
        raise ValueError(f"{name} is no number")
    return name, value


def parse_value(body: bytes) -> tuple[str, Value]:
    """Return the name and the value of a message with a key.

    Args:
        body: Length of the key, key, value.

    Raises:
        ValueError: The key is malformed, or the value has another size.
    """
    if not body:
        raise ValueError("no key")
    end = 1 + body[0]
    key = _KEY.fullmatch(body[1:end].decode("utf-8", "replace"))
    if key is None or len(body) < end:
        raise ValueError("malformed key")
    return key["name"], _value(key["type"], key["length"], body[end:])


def _value(kind: str, length: str | None, data: bytes) -> Value:
    if kind == "char":
        return data.decode("utf-8", "replace")
    code = _CODES.get(kind)
    if code is None or (kind == "uint8_t" and length is not None):
        return data
    count = 1 if length is None else len(data) // calcsize(code)
    values: tuple[Any, ...] = unpack(f"<{count}{code}", data)
    return values if length is not None else values[0]
