"""Opening a log of any format, which is recognised by the content of the file.

A signature at the beginning of the file decides; a file without one is searched for packets. A file of a
known other kind is refused with its name. Anything else is an empty log of packets, whose `skipped` counts
all bytes.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final

from mavstack.errors import LogError
from mavstack.logs.formats.packets import open_packets
from mavstack.logs.log_bytes import LogBytes
from mavstack.logs.options import OpenOptions
from mavstack.logs.registry import MAX_HEAD, log_format, recognise, recognise_plugin
from mavstack.wire import Parser
from mavstack.wire.other_formats import other_format

if TYPE_CHECKING:
    import os

    from mavstack.logs.log import Log
    from mavstack.logs.options import HasDialect

#: Bytes at the beginning of a file without signature in which a packet must be found to read it as a packet
#: log.
_PACKET_SEARCH: Final = 1 << 13


def open_log(
    path: str | os.PathLike[str],
    dialect: HasDialect | str = "all",
    *,
    format: str | None = None,  # noqa: A002 (the word of the registry)
    timestamped: bool | None = None,
    threads: int = 0,
) -> Log:
    """Open a log as a mapping from names to tables.

    Args:
        path: Path of the file.
        dialect: The dialect of packets, as a `Dialect`, a dialect module or a name.
        format: Name of the format, such as "tlog"; None recognises it by the content.
        timestamped: True for a tlog, False for a raw stream; None detects it from the content.
        threads: Maximum number of threads; 0 for one per processor.

    Returns:
        The log, with no table decoded.

    Raises:
        LogError: The file cannot be read, or is no log.
        InvalidArgumentError: There is no such format.
        UnknownDialectError: There is no dialect of that name.
    """
    options = OpenOptions(dialect, timestamped, threads)
    chosen = None if format is None else log_format(format)
    data = LogBytes(Path(path))
    if chosen is not None:
        return chosen.open(data, options)
    beginning = data.read(0, _PACKET_SEARCH)
    if _is_packets(beginning, options) and recognise(beginning) is None:
        return open_packets(data, options)
    head = data.read(0, MAX_HEAD)
    found = recognise(head)
    other = other_format(head)
    if found is None and (other is not None or not _holds_packet(head, options)):
        found = recognise_plugin(head)
    if found is not None:
        return found.open(data, options)
    if other is not None:
        raise LogError(f"cannot open {path}: this is {other}")
    return open_packets(data, options)


def _is_packets(beginning: bytes, options: OpenOptions) -> bool:
    """Return whether most bytes are packets of known messages: no other signature need be searched then."""
    packets = Parser(options.dialect).feed(beginning)
    known = sum(len(packet) for packet in packets if packet.name is not None)
    return known > len(beginning) / 2


def _holds_packet(head: bytes, options: OpenOptions) -> bool:
    return bool(Parser(options.dialect).feed(head[:_PACKET_SEARCH]))
