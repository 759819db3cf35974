"""Options that several commands share: the dialect, a choice of messages, and types of arguments."""

from __future__ import annotations

import re
from argparse import ArgumentTypeError
from fnmatch import fnmatchcase
from math import isfinite
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.errors import UsageError

if TYPE_CHECKING:
    from argparse import ArgumentParser
    from collections.abc import Mapping

    from mavstack.dialects import Dialect, Message

_SIZE: Final = re.compile(r"(\d{1,15}(?:\.\d+)?)\s*([kMG]?)B?", re.IGNORECASE)
_UNITS: Final[Mapping[str, int]] = MappingProxyType({"": 1, "k": 10**3, "m": 10**6, "g": 10**9})


def add_dialect_option(parser: ArgumentParser) -> None:
    """Declare `--dialect`; its default `all` knows every official message."""
    parser.add_argument(
        "--dialect", default="all", metavar="NAME|FILE.xml", help="dialect of the messages (default: all)"
    )


def message_ids(dialect: Dialect, text: str) -> frozenset[int]:
    """Return the message ids of a comma-separated list of names, patterns such as `GPS*`, and ids."""
    found: set[int] = set()
    for word in filter(None, (part.strip().upper() for part in text.split(","))):
        found |= {int(word)} if word.isdecimal() else _matching(dialect, word)
    if not found:
        raise UsageError(f"no message is named in {text!r}")
    return frozenset(found)


def finite_number(text: str) -> float:
    """Parse a finite number, for argparse."""
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not isfinite(value):
        raise ArgumentTypeError(f"{text!r} is not a number")
    return value


def seconds(text: str) -> float:
    """Parse a positive number of seconds, for argparse."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0 < value < float("inf"):
        raise ArgumentTypeError(f"{text!r} is not a positive number of seconds")
    return value


def seconds_from_start(text: str) -> float:
    """Parse a number of seconds that is not negative, for argparse."""
    value = finite_number(text)
    if value < 0:
        raise ArgumentTypeError(f"{text!r} is not a number of seconds after the beginning")
    return value


def byte_size(text: str) -> int:
    """Parse a positive number of bytes such as 500k or 2G, for argparse."""
    match = _SIZE.fullmatch(text.strip())
    size = int(float(match[1]) * _UNITS[match[2].lower()]) if match else 0
    if size < 1:
        raise ArgumentTypeError(f"{text!r} is not a number of bytes such as 500k, 20M or 2G")
    return size


def system_id(text: str) -> int:
    """Parse a MAVLink system id, for argparse."""
    if not (text.isdecimal() and int(text) <= 255):
        raise ArgumentTypeError(f"{text!r} is not a system id, 0 to 255")
    return int(text)


def _matching(dialect: Dialect, pattern: str) -> set[int]:
    ids = {message.definition.id for message in _named(dialect, pattern)}
    if not ids:
        from difflib import get_close_matches

        near = get_close_matches(pattern, dialect.names, n=1)
        hint = f"; did you mean {near[0]}?" if near else ""
        raise UsageError(f"dialect {dialect.name} has no message {pattern}{hint}")
    return ids


def _named(dialect: Dialect, pattern: str) -> list[type[Message]]:
    return [dialect[name] for name in dialect.names if fnmatchcase(name.upper(), pattern)]
