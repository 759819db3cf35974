"""Generated C and C++: the library of `mav gen c` beside that of mavgen, and the time of generation.

Both libraries are compiled with the same flags and run the same program, `peer.c`, over the same bytes. The
bulk parser exists in ours only: it is compared with mavgen's one byte at a time.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from . import c_library
from .codegen_generation import generation
from .measure import OURS, C, Row, rates, speed_ratio, take_turns

if TYPE_CHECKING:
    from collections.abc import Iterator

    from .rows import Bench

PARSE_TARGET = 1.3


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
        yield generation(name, language, peer, bench, C)
