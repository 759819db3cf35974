"""Texts of a vehicle as CSV: cells that a spreadsheet runs as formulas, beside mavlogdump."""

from __future__ import annotations

import csv
import subprocess
import sys
import tempfile
from pathlib import Path
from time import time
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.wire import Encoder

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

FORMULAS_ROW: Final = "formulas of status texts in CSV, of 4"
_FORMULAS: Final = ('=HYPERLINK("http://x","y")', "+1+cmd", "@SUM(A1)", "-2+3+cmd")
_FIRST: Final = ("=", "+", "-", "@", "\t", "\r")


def ours(log: Path, csv_file: Path) -> list[str] | None:
    """Return the command that writes a log as CSV; None: the program is not installed."""
    return [
        sys.executable,
        "-m",
        "mavstack",
        "data",
        "convert",
        str(log),
        "--to",
        "csv",
        "-o",
        str(csv_file.parent),
    ]


def mavlogdump(log: Path, csv_file: Path) -> list[str] | None:
    """Return the command of pymavlink, which writes to its standard output."""
    del csv_file
    program = Path(sys.executable).parent / "mavlogdump.py"
    types = ["--format", "csv", "--types", "STATUSTEXT", str(log)]
    return [sys.executable, str(program), *types] if program.exists() else None


def formulas(command: Callable[[Path, Path], list[str] | None]) -> float | None:
    """Convert a log with four formulas in status texts; return how many of them are in the cells.

    Args:
        command: Makes the command line.

    Returns:
        The number; None: the program is not installed.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        log, encoder = folder / "flight.tlog", Encoder(1, 1)
        stamp = int(time() * 1e6).to_bytes(8)
        texts = (common.Statustext(severity=6, text=text) for text in _FORMULAS)
        log.write_bytes(b"".join(stamp + encoder.encode(text) for text in texts))
        words = command(log, folder / "csv")
        if words is None:
            return None
        done = subprocess.run(words, capture_output=True, text=True, check=True)  # noqa: S603 (the command is ours)
        written = [path.read_text("utf-8") for path in folder.rglob("*.csv")] or [done.stdout]
        cells = [cell for text in written for row in csv.reader(text.splitlines()) for cell in row]
    found = [cell for cell in cells if cell.startswith(_FIRST) and not _is_number(cell)]
    if not any(_FORMULAS[1] in cell for cell in cells):
        raise SystemExit(f"{words[1:4]}: the texts are not in the file")
    return len(found)


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


#: Programs that write logs as CSV, by the column of their figures.
TEXTS: Final[Mapping[str, Callable[[Path, Path], list[str] | None]]] = MappingProxyType(
    {"mavstack": ours, "mavlogdump": mavlogdump}
)
