"""Generated C and C++: the library of `mav gen c` beside that of mavgen, and the time of generation.

Both libraries are compiled with the same flags and run the same program, `peer.c`, over the same bytes. The
bulk parser exists in ours only: it is compared with mavgen's one byte at a time.
"""

from __future__ import annotations

import subprocess
import sys
import time
from functools import partial
from typing import TYPE_CHECKING

from . import c_library
from .measure import OURS, C, Row, rates, speed_ratio, take_turns

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from .rows import Bench

PARSE_TARGET = 1.3
MAVGEN = """
import sys, time
from pymavlink.generator import mavgen
options = mavgen.Opts(output=sys.argv[3], wire_protocol="2.0", language=sys.argv[1], validate=False)
assert mavgen.mavgen(options, [sys.argv[2]])
"""


def rows(bench: Bench) -> Iterator[Row]:
    """Yield the rows of the parser, the encoder and the generators."""
    if bench.program is not None:
        ours = c_library.build_ours(bench.program, bench.folder / "generated-c")
        count, turns = bench.amounts.log, bench.amounts.turns
        flight = bench.file("flight.bin", lambda: bench.flight.stream)
        signed = bench.file("signed.bin", lambda: b"".join(bench.flight.signed(count // 10)))
        works = {
            "C: each byte": ("live", "live", count, flight),
            "C: chunks": ("buffer", "live", count, flight),
            "C: signed": ("signed", "signed", count // 10, signed),
            "C: fields to packet": ("encode", "encode", 5 * count, None),
        }
        for name, (mode, peer_mode, amount, file) in works.items():
            work = {
                OURS: partial(ours.seconds, mode, amount, file),
                C: partial(bench.program.seconds, peer_mode, amount, file),
            }
            results = take_turns(work, turns)
            target = None if name == "C: signed" else PARSE_TARGET
            yield Row(name, rates(results), (speed_ratio(results, C, target),))
    for name, language, peer in (("C", "c", "C"), ("C++", "cpp11", "C++11")):
        yield _generation(name, language, peer, bench)


def _generation(name: str, language: str, peer: str, bench: Bench) -> Row:
    """Return the time from the command line to the last file, for all messages."""
    definition = str(c_library.DEFINITIONS / "all.xml")
    ours = [sys.executable, "-m", "mavstack", "gen", language, definition, "-o"]
    theirs = [sys.executable, "-c", MAVGEN, peer, definition]
    results = take_turns(
        {
            OURS: lambda: _seconds([*ours, str(_fresh(bench.folder))]),
            C: lambda: _seconds([*theirs, str(_fresh(bench.folder))]),
        },
        bench.amounts.turns,
    )
    figures = {library: f"{sorted(times)[len(times) // 2]:.2f} s" for library, times in results.items()}
    return Row(f"{name}: generation of all", figures, (speed_ratio(results, C, 1.0),))


def _fresh(folder: Path) -> Path:
    """Return a new folder: existing files would only be compared."""
    return folder / f"generated-{time.monotonic_ns()}"


def _seconds(command: list[str]) -> float:
    start = time.perf_counter()
    subprocess.run(command, check=True, capture_output=True)
    return time.perf_counter() - start
