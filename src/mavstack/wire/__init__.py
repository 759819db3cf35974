"""Packets in and out: the parser, the encoder, signing and their statistics, all sans-IO.

A `Parser` takes the bytes of one channel in any chunks and yields `Packet`s, MAVLink 1 and 2 mixed. What
is not a packet never raises: it is counted in `Parser.statistics` and skipped, and after a false start the
search goes on one byte behind the false magic. A packet keeps its bytes as they came. An `Encoder` numbers
the packets of one component on one link. `Signing` belongs to a link and is shared by its parser and its
encoder; time is an argument.
"""

from __future__ import annotations

from mavstack._core import (
    Encoder,
    Packet,
    Parser,
    Refusals,
    Signing,
    SourceStatistics,
    Statistics,
    crc16,
    encode,
)

TYPE_CHECKING = False
if TYPE_CHECKING:
    # Known to type checkers only: the core takes whatever has the attribute.
    from mavstack._core import HasCoreDialect as HasCoreDialect

__all__ = [
    "Encoder",
    "Packet",
    "Parser",
    "Refusals",
    "Signing",
    "SourceStatistics",
    "Statistics",
    "crc16",
    "encode",
]
