"""The wire protocol: parser, encoder, signing and their statistics, all sans-IO.

A `Parser` takes the bytes of one channel in chunks of any size and returns `Packet`s; MAVLink 1 and 2 may be
mixed. Bytes that are no valid packet never raise: they are counted in `Parser.statistics` and skipped. After
a false start the search continues one byte after the false magic. A packet keeps its bytes unchanged. An
`Encoder` encodes the messages of one component for one link, and counts their sequence numbers. `Signing` is
the state of one link, shared by its parser and its encoder; time is an argument. `fields_json` writes the
fields of a packet as JSON, without an object for each field.
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
    fields_json,
)

TYPE_CHECKING = False
if TYPE_CHECKING:
    # For type checkers only: the core accepts any object with the attribute `core_dialect`.
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
    "fields_json",
]
