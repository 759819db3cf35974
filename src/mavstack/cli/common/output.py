"""The output of commands, and the one place where it is made safe for a terminal.

Texts come from vehicles, files and other programs, and a terminal obeys the control characters in them. Every
command therefore prints through `echo` and its relatives, which replace all control characters; only they may
write to the standard streams. Colours and the erasing of a progress line are added after that. Until then a
colour is a pair of marks, lone surrogates, which no text from a link can contain.
"""

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
    {
        "bold": "1",
        "red": "31",
        "green": "32",
        "yellow": "33",
        "blue": "34",
        "magenta": "35",
        "cyan": "36",
        "grey": "90",
        "alarm": "1;31",
    }
)
_MARKS: Final[Mapping[str, str]] = MappingProxyType(
    {colour: chr(0xDFF0 + index) for index, colour in enumerate(_CODES)}
)
_END_MARK: Final = "\udfff"
_SEQUENCES: Final[Mapping[str, str]] = MappingProxyType(
    {**{_MARKS[colour]: f"\x1b[{code}m" for colour, code in _CODES.items()}, _END_MARK: "\x1b[0m"}
)
_ERASE: Final = "\r\x1b[K"
#: Minimum width of the output in columns; a narrower terminal wraps the lines itself.
MIN_COLUMNS: Final = 40
DEFAULT_COLUMNS: Final = 80
_INDENT: Final = "  "


def echo(*lines: str, error: bool = False, flush: bool = True) -> None:
    """Print lines without control characters.

    Args:
        *lines: Lines; a line break inside one of them is replaced like any other control character.
        error: Print on stderr instead of stdout; a terminal gets long lines broken between words.
        flush: Flush the stream.
    """
    stream = sys.stderr if error else sys.stdout
    if error and stream.isatty():
        columns = _columns_of(stream)
        lines = tuple(part for line in lines for part in _broken(line, columns))
    stream.write("".join(f"{_rendered(line, stream)}\n" for line in lines))
    if flush:
        stream.flush()


def echo_text(text: str) -> None:
    """Print the text of a file or a page on stdout as it is, except for control characters in its lines."""
    lines = text.split("\n")
    sys.stdout.write(
        "\n".join("\t".join(_rendered(part, sys.stdout) for part in line.split("\t")) for line in lines)
    )
    sys.stdout.flush()


def echo_question(question: str) -> None:
    """Print a question on stdout; the answer is typed on the same line."""
    sys.stdout.write(_rendered(question, sys.stdout))
    sys.stdout.flush()


def echo_progress(line: str) -> None:
    """Replace the progress line on stderr, which must be a terminal; an empty line erases it."""
    sys.stderr.write(_ERASE + _rendered(line, sys.stderr))
    sys.stderr.flush()


def echo_json(value: object) -> None:
    """Print a value as one line of JSON."""
    echo(json.dumps(value, allow_nan=False))


def coloured(text: str, colour: str) -> str:
    """Return a text that `echo` prints in a colour if its stream is a terminal and NO_COLOR is not set."""
    return f"{_MARKS[colour]}{printable(text)}{_END_MARK}" if colour else text


def shown_length(text: str) -> int:
    """Return the number of letters of a text without the marks of its colours."""
    return sum(letter not in _SEQUENCES for letter in text)


def wrapped(text: str, columns: int, indent: str = "") -> list[str]:
    """Return a text as lines of at most `columns`, broken at blanks; further lines are indented."""
    lines: list[str] = []
    line = ""
    for word in text.split(" "):
        longer = f"{line} {word}" if line else word
        if line.strip() and shown_length(longer) > columns:
            lines.append(line)
            line = indent + word
        else:
            line = longer
    return [*lines, line]


def _columns_of(stream: TextIO) -> int:
    try:
        return max(os.get_terminal_size(stream.fileno()).columns, MIN_COLUMNS)
    except (OSError, ValueError):  # the prompt of the shell has replaced the stream
        return max(terminal_width(), MIN_COLUMNS)


def terminal_width() -> int:
    """Return the columns of the terminal as `shutil` does, which is slow to import; 80 without a terminal."""
    chosen = os.environ.get("COLUMNS", "")
    if chosen.isdecimal() and int(chosen):
        return int(chosen)
    try:
        return os.get_terminal_size(sys.stdout.fileno()).columns or DEFAULT_COLUMNS
    except (AttributeError, OSError, ValueError):  # stdout is closed, or is not a terminal
        return DEFAULT_COLUMNS


def _broken(line: str, columns: int) -> list[str]:
    """Return a line as lines that fit; the indentation stays, and further lines have more of it."""
    if shown_length(line) <= columns:
        return [line]
    text = line.lstrip(" ")
    indent = line[: len(line) - len(text)]
    return [indent + part for part in wrapped(text, columns - len(indent), _INDENT)]


def _rendered(line: str, stream: TextIO) -> str:
    """Return a line with colours instead of marks, and without control characters."""
    if line.isprintable():
        return line
    sequences = (
        _SEQUENCES if stream.isatty() and not os.environ.get("NO_COLOR") else dict.fromkeys(_SEQUENCES, "")
    )
    return "".join(sequences[each] if each in sequences else printable(each) for each in line)


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
    rows = [[printable(cell) for cell in row] for row in rows]
    widths = [max(map(len, column)) for column in zip(head, *rows, strict=True)]
    for row in (head, *rows):
        cells = (
            f"{cell:<{width}}" if name in left else f"{cell:>{width}}"
            for name, cell, width in zip(head, row, widths, strict=True)
        )
        yield "  ".join(cells).rstrip()
