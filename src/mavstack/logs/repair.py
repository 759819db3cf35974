"""Repair of damaged logs of packets: what the file still holds, without the damage.

Packets whose CRC is right are copied byte for byte with their times; everything else is dropped and counted.
A file that was cut off, or that holds the noise of a radio, becomes a file that every program reads.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, Final

from mavstack._core import looks_timestamped
from mavstack.dialects import Dialect
from mavstack.errors import LogError
from mavstack.logs.export.writer import PartFile
from mavstack.wire import Parser
from mavstack.wire.other_formats import other_format

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Iterable

    from mavstack.wire import Packet

_CHUNK: Final = 1 << 20
_TIMESTAMP: Final = 8


@dataclass(frozen=True, slots=True)
class Repair:
    """The result of a repair.

    Attributes:
        packets: Packets that were kept.
        kept_bytes: Size of the repaired file.
        dropped_bytes: Bytes that were dropped.
    """

    packets: int
    kept_bytes: int
    dropped_bytes: int


def repair_log(
    path: str | os.PathLike[str],
    output: str | os.PathLike[str],
    dialect: Dialect | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Repair:
    """Copy the packets of a damaged tlog or raw stream into a new file.

    Args:
        path: Path of the damaged file.
        output: Path of the new file, which must not exist.
        dialect: The dialect of the packets; None: "all".
        progress: Called with the bytes that were read, and with the size of the file.

    Returns:
        The packets that were kept, and the bytes that were dropped.

    Raises:
        LogError: The file cannot be read, has another format or no packet, or the new file exists or cannot
            be written.
    """
    source, target = Path(path), Path(output)
    if target.exists():
        raise LogError(f"cannot write {target}: it exists, and a repair never overwrites a file")
    part = PartFile(target)
    try:
        with source.open("rb") as file, part.temporary.open("wb") as copy:
            repair = _copy(file, copy, source, dialect or Dialect.load("all"), progress)
        if not repair.packets:
            raise LogError(f"cannot repair {source}: it contains no MAVLink packet")
        part.complete()
    except OSError as error:
        raise LogError(f"cannot repair {error.filename or source}: {error.strerror or error}") from error
    finally:
        part.discard()
    return repair


def _copy(
    file: BinaryIO,
    copy: BinaryIO,
    path: Path,
    dialect: Dialect,
    progress: Callable[[int, int], None] | None,
) -> Repair:
    head = file.read(_CHUNK)
    other = other_format(head)
    if other is not None:
        raise LogError(f"cannot repair {path}: this is {other}, not a stream of MAVLink packets")
    timestamped = looks_timestamped(head, dialect)
    parser = Parser(dialect, timestamped=timestamped)
    size, read, kept, packets = path.stat().st_size, 0, 0, 0
    data = head
    while data:
        read += len(data)
        found = parser.feed(data)
        data = file.read(_CHUNK)
        if not data:
            found = [*found, *parser.flush()]
        kept += copy.write(b"".join(_records(found, timestamped=timestamped)))
        packets += len(found)
        if progress is not None:
            progress(read, size)
    return Repair(packets, kept, read - kept)


def _records(packets: Iterable[Packet], *, timestamped: bool) -> Iterable[bytes]:
    if not timestamped:
        return [packet.raw for packet in packets]
    return [(packet.timestamp or 0).to_bytes(_TIMESTAMP, "big") + packet.raw for packet in packets]
