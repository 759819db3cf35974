"""Texts that are safe to print on a terminal, and sizes and durations in units that people read."""

from __future__ import annotations

from typing import Final

_STEP: Final = 1000.0
_UNITS: Final = ("B", "kB", "MB", "GB", "TB")
_MINUTE: Final = 60
_HOUR: Final = 3600


def printable(text: str) -> str:
    """Return a text from the wire without control characters, which a terminal would obey."""
    return "".join(letter if letter.isprintable() else "\N{REPLACEMENT CHARACTER}" for letter in text)


def size_text(size: float) -> str:
    """Return a number of bytes with a decimal unit: 1.5 MB."""
    unit = 0
    while size >= _STEP - 0.5 and unit < len(_UNITS) - 1:
        size, unit = size / _STEP, unit + 1
    return f"{size:.0f} B" if unit == 0 else f"{size:.{1 if size < 100 else 0}f} {_UNITS[unit]}"


def duration_text(seconds: float) -> str:
    """Return a duration: 42 s, 3:07 min, 2:05 h."""
    whole = round(seconds)
    if whole < _MINUTE:
        return f"{whole} s"
    unit, sign = (_MINUTE, "min") if whole < _HOUR else (_HOUR, "h")
    return f"{whole // unit}:{whole % unit * 60 // unit:02d} {sign}"
