"""A logging handler for stderr that can hold its lines back while a display covers the terminal."""

from __future__ import annotations

from collections import deque
from logging import Handler
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.output import echo

if TYPE_CHECKING:
    from logging import LogRecord

#: Number of lines that are kept while the output is held back; the oldest ones are dropped.
MAX_HELD_LINES: Final = 1000


class StderrHandler(Handler):
    """Prints on the current `sys.stderr`, which a prompt or a test may have replaced."""

    def __init__(self) -> None:
        super().__init__()
        self._held: deque[str] | None = None

    def emit(self, record: LogRecord) -> None:
        """Print a record, or keep it until `print_held_lines`."""
        try:
            line = self.format(record)
            if self._held is None:
                echo(*line.split("\n"), error=True)
            else:
                self._held.append(line)
        except Exception:  # noqa: BLE001 (as in logging's own handlers)
            self.handleError(record)

    def hold_lines(self) -> None:
        """Keep lines from now on."""
        self._held = deque(maxlen=MAX_HELD_LINES)

    def print_held_lines(self) -> None:
        """Print the lines that were kept."""
        held, self._held = self._held, None
        echo(*(each for line in held or () for each in line.split("\n")), error=True)
