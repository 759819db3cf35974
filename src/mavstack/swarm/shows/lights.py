"""Light programs in the bytes of Skybrush: commands with durations in fiftieths of a second."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Sequence

    Colour = tuple[int, int, int]

_END: Final = 0x00
_SET_COLOUR: Final = 0x04
#: Durations in a light program are in units of 1/50 second.
_TICKS: Final = 50


def light_program(colours: Sequence[tuple[float, Colour]]) -> bytes:
    """Return the program that shows colours from their times on.

    Args:
        colours: Seconds, and red, green and blue from 0 to 255; in order.

    Returns:
        The program; empty without colours.
    """
    if not colours:
        return b""
    changes = [colours[0]]
    for time, colour in colours[1:]:
        if colour != changes[-1][1]:
            changes.append((time, colour))
    ends = [*(time for time, _ in changes[1:]), colours[-1][0]]
    program = bytearray()
    for (begin, colour), end in zip(changes, ends, strict=True):
        # The two times are rounded before the subtraction, so that rounding errors do not add up.
        ticks = max(0, round(end * _TICKS) - round(begin * _TICKS))
        program += bytes((_SET_COLOUR, *(min(max(each, 0), 255) for each in colour))) + _varint(ticks)
    program.append(_END)
    return bytes(program)


def _varint(value: int) -> bytes:
    data = bytearray()
    while value > 0x7F:
        data.append(value & 0x7F | 0x80)
        value >>= 7
    data.append(value)
    return bytes(data)
