"""The time of `mav gen` beside mavgen: all messages, from the command line to the last file."""

from __future__ import annotations

import subprocess
import sys
import time
from statistics import median
from typing import TYPE_CHECKING

from . import c_library
from .measure import OURS, Row, speed_ratio, take_turns

if TYPE_CHECKING:
    from pathlib import Path

    from .rows import Bench

MAVGEN = "mavgen"
PROGRAM = """
import sys
from pymavlink.generator import mavgen
options = mavgen.Opts(sys.argv[3], wire_protocol="2.0", language=sys.argv[1], validate=False)
assert mavgen.mavgen(options, [sys.argv[2]])
"""


def generation(name: str, language: str, peer: str, bench: Bench, column: str = MAVGEN) -> Row:
    """Return the row of a language.

    Args:
        name: The language in the table.
        language: Its name for `mav gen`.
        peer: Its name for mavgen.
        bench: Conditions of the run.
        column: Column of mavgen in the table.
    """
    ours, theirs = our_command(language, "all"), mavgen_command(peer, "all")
    file = {"Python": "all.py", "WLua": "all.lua", "Lua": "modules"}.get(peer, "")
    results = take_turns(
        {
            OURS: lambda: _seconds(ours, _fresh(bench.folder)),
            column: lambda: _seconds(theirs, _fresh(bench.folder) / file),
        },
        bench.amounts.turns,
    )
    figures = {library: f"{median(times):.2f} s" for library, times in results.items()}
    return Row(f"{name}: generation of all", figures, (speed_ratio(results, column, 1.0),))


def our_command(language: str, dialect: str) -> list[str]:
    """Return the command line of `mav gen`, without the folder at its end."""
    return [sys.executable, "-m", "mavstack", "gen", language, dialect, "-o"]


def mavgen_command(language: str, dialect: str) -> list[str]:
    """Return the command line of mavgen with our definitions, without the folder at its end."""
    return [sys.executable, "-c", PROGRAM, language, str(c_library.DEFINITIONS / f"{dialect}.xml")]


def _fresh(folder: Path) -> Path:
    """Return a new folder: files that exist would only be compared."""
    target = folder / f"generated-{time.monotonic_ns()}"
    target.mkdir()
    return target


def _seconds(command: list[str], target: Path) -> float:
    start = time.perf_counter()
    subprocess.run([*command, str(target)], check=True, capture_output=True)
    return time.perf_counter() - start
