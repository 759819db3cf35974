"""Output of commands: aligned columns, tables with a header, JSON lines, coloured text."""

from __future__ import annotations

import json
import os
import sys
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.text import printable

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping, Sequence
    from typing import TextIO

_CODES: Final[Mapping[str, str]] = MappingProxyType(
    {"bold": "1", "red": "31", "green": "32", "yellow": "33", "cyan": "36", "grey": "90", "alarm": "1;31"}
)


def print_json(value: object) -> None:
    """Print a value as one line of JSON."""
    print(json.dumps(value, allow_nan=False), flush=True)


def align_columns(rows: Sequence[Sequence[str]], *, right: frozenset[int] = frozenset()) -> list[str]:
    """Return rows as lines with aligned columns; the columns in `right` are aligned to the right."""
    rows = [[printable(cell) for cell in row] for row in rows]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(
            cell.rjust(width) if index in right else cell.ljust(width)
            for index, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    ]


def table_lines(head: Sequence[str], rows: Sequence[Sequence[str]], left: Collection[str]) -> Iterator[str]:
    """Yield the lines of a table with a header; the columns named in `left` are aligned to the left."""
    widths = [max(map(len, column)) for column in zip(head, *rows, strict=True)]
    for row in (head, *rows):
        cells = (
            f"{cell:<{width}}" if name in left else f"{cell:>{width}}"
            for name, cell, width in zip(head, row, widths, strict=True)
        )
        yield "  ".join(cells).rstrip()


def coloured(text: str, colour: str, stream: TextIO | None = None) -> str:
    """Return a text in a colour if the stream (stdout by default) is a terminal and NO_COLOR is not set."""
    out = sys.stdout if stream is None else stream
    if not colour or not out.isatty() or os.environ.get("NO_COLOR"):
        return text
    return f"\x1b[{_CODES[colour]}m{text}\x1b[0m"
