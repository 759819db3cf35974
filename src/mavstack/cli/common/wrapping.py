"""Tables and widths of the terminal; a pipe gets texts of 80 columns, and whole tables."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.output import (
    DEFAULT_COLUMNS,
    MIN_COLUMNS,
    align_columns,
    shown_length,
    table_lines,
    terminal_width,
    wrapped,
)
from mavstack.cli.common.text import printable

if TYPE_CHECKING:
    from collections.abc import Sequence

#: The width of a table that is written to a pipe: programs read it, so no line is wrapped.
UNLIMITED: Final = 1 << 20
_INDENT: Final = "    "
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


def rows_that_fit(head: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Return a table; in a terminal that is too narrow, each row as its first cell and the others below."""
    lines = list(table_lines(head, rows, head))
    columns = terminal_columns(UNLIMITED)
    if max(map(len, lines)) <= columns:
        return lines
    found: list[str] = []
    for first, *others in (head, *rows):
        text = printable("  ".join(filter(None, others)))
        found += [printable(first), *(_INDENT + line for line in wrapped(text, columns - len(_INDENT)))]
    return found


def example_that_fits(line: str, columns: int) -> list[str]:
    """Return a line of a help page; if it is an example that is too long, its comment is a line above it."""
    command, mark, comment = line.rpartition("  # ")
    if not mark or len(line) <= columns:
        return [line]
    return [f"  # {comment}", command.rstrip()]


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
