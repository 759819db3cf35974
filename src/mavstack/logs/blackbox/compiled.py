"""Functions that decode the frames of one kind, made for the definition in the header of a flight.

A megabyte of a log holds about a million fields. A loop over their encodings and predictors takes longer than
the decoding itself, so the loop runs once, over the definition, and yields the text of a function with the
steps for each field in order. The text has only the numbers of a checked definition.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from mavstack.logs.blackbox.encodings import (
    NOTHING,
    SIGNED_VALUES,
    SIGNED_VB,
    SMALL_TRIPLES,
    TAG2_3S32,
    TAG2_3SVARIABLE,
    TAG8_8SVB,
    UNSIGNED_VB,
    signed_vb,
    unsigned_vb,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from types import CodeType

    from mavstack.logs.blackbox.encodings import Reader

    #: A function that decodes one frame. It takes the bytes of a flight, the position of the frame, the
    #: values of the last two main frames and the number of iterations that were not logged since; it returns
    #: the values of the frame and the position after it.
    Decoder: TypeAlias = Callable[[bytes, int, Sequence[int], Sequence[int], int], tuple[list[int], int]]

_HEAD: Final = "def decode(data, position, previous, before, skipped):"
_ONE_BYTE: Final = 128


def compile_decoder(groups: Sequence[tuple[int, Reader, int]], predictions: Sequence[str]) -> Decoder:
    """Return the function that decodes a kind of frame.

    Args:
        groups: Encoding, reader and number of fields of each group of successive fields.
        predictions: Statements that add the predictions to the values `v0`, `v1` …, in order.
    """
    lines, first = [_HEAD], 0
    names: dict[str, Any] = {
        "signed": SIGNED_VALUES, "triples": SMALL_TRIPLES, "signed_vb": signed_vb, "unsigned_vb": unsigned_vb,
    }  # fmt: skip
    for number, (encoding, reader, count) in enumerate(groups):
        names[f"read_{number}"] = reader
        fields = [f"v{index}" for index in range(first, first + count)]
        lines += _statements(encoding, number, fields)
        first += count
    lines += [*predictions, f"return [{', '.join(f'v{index}' for index in range(first))}], position"]
    exec(_compiled("\n    ".join(lines)), names)  # noqa: S102 (see the head of this module)
    decode: Decoder = names["decode"]
    return decode


@lru_cache(maxsize=64)
def _compiled(source: str) -> CodeType:
    """Return the code of a function; the flights of a file mostly have the same definitions."""
    return compile(source, "<frame of a Blackbox log>", "exec")


def _statements(encoding: int, number: int, fields: Sequence[str]) -> Iterator[str]:
    """Yield the statements that read the fields of a group."""
    if encoding == NOTHING:
        yield f"{' = '.join(fields)} = 0"
    elif encoding == UNSIGNED_VB:
        for name in fields:
            yield f"{name} = data[position]"
            yield f"if {name} < {_ONE_BYTE}: position += 1"
            yield f"else: {name}, position = unsigned_vb(data, position)"
    elif encoding == SIGNED_VB or (encoding == TAG8_8SVB and len(fields) == 1):
        for name in fields:
            yield from _read_signed(name)
    elif encoding == TAG8_8SVB:
        yield "tag = data[position]; position += 1"
        yield f"{' = '.join(fields)} = 0"
        yield "if tag:"
        for bit, name in enumerate(fields):
            yield f"    if tag & {1 << bit}:"
            yield from (f"        {statement}" for statement in _read_signed(name))
    else:
        yield from _call(encoding, number, fields)


def _read_signed(name: str) -> Iterator[str]:
    """Yield the statements that read a signed number; most have one byte or two."""
    yield "byte = data[position]"
    yield f"if byte < {_ONE_BYTE}: {name} = signed[byte]; position += 1"
    yield "else:"
    yield "    more = data[position + 1]"
    yield f"    if more < {_ONE_BYTE}: {name} = signed[byte & 127 | more << 7]; position += 2"
    yield f"    else: {name}, position = signed_vb(data, position)"


def _call(encoding: int, number: int, fields: Sequence[str]) -> Iterator[str]:
    """Yield the statements that call the reader of a group."""
    target, call = ", ".join(fields), f"position = read_{number}(data, position, {len(fields)}, found)"
    if encoding in (TAG2_3S32, TAG2_3SVARIABLE):
        yield "byte = data[position]"
        yield f"if byte < {len(SMALL_TRIPLES)}: {target} = triples[byte]; position += 1"
        yield f"else: found = []; {call}; {target} = found"
    else:
        yield f"found = []; {call}; {target}{',' * (len(fields) == 1)} = found"
