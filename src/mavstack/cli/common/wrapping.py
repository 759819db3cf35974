"""Tables and widths of the terminal; a pipe gets texts of 80 columns, and whole tables."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.output import (
    DEFAULT_COLUMNS,
    MIN_COLUMNS,
    align_columns,
    shown_length,
    terminal_width,
    wrapped,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

#: The width of a table that is written to a pipe: programs read it, so no line is wrapped.
UNLIMITED: Final = 1 << 20
#: Minimum width of the last column of a table in characters; a narrower one is not wrapped.
_MIN_LAST_COLUMN: Final = 20


def terminal_columns(in_pipe: int = DEFAULT_COLUMNS) -> int:
    """Return the width of the terminal, or `in_pipe` if the output goes elsewhere."""
    if not sys.stdout.isatty():
        return in_pipe
    return max(terminal_width(), MIN_COLUMNS)


def table_that_fits(
    rows: Sequence[Sequence[str]], columns: int, *, right: frozenset[int] = frozenset()
) -> list[str]:
    """Return a table as lines that fit, broken between words.

    Args:
        rows: The heads, then the rows; the first column is short.
        columns: Width of the terminal. The last column is wrapped below itself; if there is no room for that,
            each row becomes a text, in which the columns of `right` are named by their heads.
        right: Columns that are aligned to the right.
    """
    lines = align_columns(rows, right=right)
    if max(map(shown_length, lines)) <= columns:
        return lines
    start = lines[0].rindex(rows[0][-1])
    if columns - start < _MIN_LAST_COLUMN:
        return _texts(rows, columns, right)
    found: list[str] = []
    for line in lines:
        first, *rest = wrapped(line[start:], columns - start)
        found += [f"{line[:start]}{first}".rstrip(), *(" " * start + each for each in rest)]
    return found


def _texts(rows: Sequence[Sequence[str]], columns: int, right: frozenset[int]) -> list[str]:
    head, *others = rows
    width = max(len(row[0]) for row in rows)
    lines: list[str] = []
    for first, *cells in others:
        named = [
            f"{head[index]} {cell}" if index in right else cell for index, cell in enumerate(cells, 1) if cell
        ]
        begin, *rest = wrapped(", ".join(named), columns - width - 2)
        lines += [f"{first:>{width}}  {begin}", *(f"{'':{width}}  {each}" for each in rest)]
    return lines
