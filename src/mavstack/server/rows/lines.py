"""Lines of a stream of bytes, bounded in length, and their rows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.server.rows.template import parse_row

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.server.rows.template import Row, RowTemplate

MAX_LINE: Final = 4096


class LineAssembler:
    """Collects bytes to lines that end with a line feed; those longer than `MAX_LINE` are dropped."""

    def __init__(self) -> None:
        self._pending = bytearray()
        self._skipping = False
        #: Number of lines that were dropped because they were too long.
        self.dropped = 0

    def feed(self, data: bytes) -> list[str]:
        """Return the lines that bytes complete; bytes that are not UTF-8 become U+FFFD."""
        *complete, rest = data.split(b"\n")
        lines: list[str] = []
        for end in complete:
            self._extend(end)
            if not self._skipping and self._pending:
                lines.append(self._pending.decode("utf-8", "replace").rstrip("\r"))
            self._pending.clear()
            self._skipping = False
        self._extend(rest)
        return lines

    def _extend(self, data: bytes) -> None:
        if self._skipping:
            return
        self._pending += data
        if len(self._pending) > MAX_LINE:
            self._pending.clear()
            self._skipping = True
            self.dropped += 1


class LineReader:
    """Reads the rows of one stream of lines.

    Args:
        templates: The templates of the lines.
    """

    def __init__(self, templates: Sequence[RowTemplate]) -> None:
        self._templates = templates
        self._lines = LineAssembler()
        self._unread = 0

    @property
    def refused(self) -> int:
        """Lines that fit no template, and lines that were too long."""
        return self._lines.dropped + self._unread

    def feed(self, data: bytes) -> list[Row]:
        """Return the rows that bytes complete."""
        rows = [parse_row(self._templates, line) for line in self._lines.feed(data)]
        found = [row for row in rows if row is not None]
        self._unread += len(rows) - len(found)
        return found
