"""Repair of damaged logs: what the file still holds, without the damage.

Sound records are copied byte for byte into a file of the same format; everything else is dropped and counted.
A file that was cut off, that holds the noise of a radio or blocks of a failing memory card becomes a file
that every program reads to its end.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from mavstack.dialects import Dialect
from mavstack.errors import LogError
from mavstack.logs.export.writer import PartFile
from mavstack.logs.log_bytes import LogBytes
from mavstack.logs.registry import MAX_HEAD, log_format, recognise
from mavstack.wire.other_formats import other_format

if TYPE_CHECKING:
    import os
    from collections.abc import Callable

    from mavstack.logs.damage import LogDamage
    from mavstack.logs.rescue import Rescue

#: The noun for an intact record in messages about formats other than packet logs.
_NOUNS: Final = {"dataflash": "sound record", "ulog": "sound message"}
#: Reasons why logs of other formats cannot be repaired.
_OTHER_FORMATS: Final = {
    "pcap": "this is a capture; convert it to a tlog, which holds the packets that it has",
    "dataflash-text": "this is a log as text, whose lines are read one by one",
}


@dataclass(frozen=True, slots=True)
class Repair:
    """The result of a repair.

    Attributes:
        format: "packets" (a tlog or raw stream), "dataflash" or "ulog".
        records: Records (packets, messages) that were kept.
        kept_bytes: Size of the repaired file.
        dropped_bytes: Bytes that were dropped.
        damage: Counts of what was dropped, by reason.
    """

    format: str
    records: int
    kept_bytes: int
    dropped_bytes: int
    damage: LogDamage

    def to_dict(self) -> dict[str, Any]:
        """Return the result as values that JSON can hold."""
        return {
            "format": self.format,
            "records": self.records,
            "kept_bytes": self.kept_bytes,
            "dropped_bytes": self.dropped_bytes,
            "damage": self.damage.to_dict(),
        }


def repair_log(
    path: str | os.PathLike[str],
    output: str | os.PathLike[str],
    dialect: Dialect | None = None,
    progress: Callable[[int, int], None] | None = None,
    *,
    format: str | None = None,  # noqa: A002 (the word of open_log)
) -> Repair:
    """Copy the sound records of a damaged log into a new file of the same format.

    Args:
        path: Path of the damaged file: a tlog, a raw stream, a binary DataFlash log (`.BIN`) or a ULog.
        output: Path of the new file, which must not exist.
        dialect: The dialect of packets; None: "all".
        progress: Called with the bytes that were read, and with the size of the file.
        format: Name of the format; None recognises it by the content.

    Returns:
        The records that were kept, and what was dropped.

    Raises:
        LogError: The file cannot be read, has another format or no sound record, or the new file exists or
            cannot be written.
        InvalidArgumentError: There is no such format.
    """
    source, target = Path(path), Path(output)
    if target.exists():
        raise LogError(f"cannot write {target}: it exists, and a repair never overwrites a file")
    data = LogBytes(source)
    name = _format_of(data, format)
    rescue = _rescue(name, data, dialect or Dialect.load("all"))
    part = PartFile(target)
    kept = 0
    try:
        with part.temporary.open("wb") as copy:
            for piece in rescue.pieces(progress or _no_progress):
                kept += copy.write(piece)
        if not rescue.records:
            raise LogError(f"cannot repair {source}: it contains no {_NOUNS.get(name, 'MAVLink packet')}")
        part.complete()
    except OSError as error:
        raise LogError(f"cannot write {error.filename or target}: {error.strerror or error}") from error
    finally:
        part.discard()
    return Repair(name, rescue.records, kept, data.size - kept, rescue.damage)


def _format_of(data: LogBytes, name: str | None) -> str:
    """Return the name of a file's format; raises if files of that format are not repaired."""
    if name is None:
        head = data.read(0, MAX_HEAD)
        found, other = recognise(head), other_format(head)
        if found is None and other is not None:
            raise LogError(f"cannot repair {data.path}: this is {other}")
        name = "packets" if found is None else found.name
    else:
        name = log_format(name).name
    if name not in ("packets", "tlog", "raw", *_NOUNS):
        reason = _OTHER_FORMATS.get(name, f"logs of the format {name} are not repaired")
        raise LogError(f"cannot repair {data.path}: {reason}")
    return name


def _rescue(name: str, data: LogBytes, dialect: Dialect) -> Rescue:
    if name == "dataflash":
        from mavstack.logs.dataflash.dataflash_rescue import DataFlashRescue

        return DataFlashRescue(data)
    if name == "ulog":
        from mavstack.logs.ulog.ulog_rescue import UlogRescue

        return UlogRescue(data)
    from mavstack.logs.packets.packet_rescue import PacketRescue

    return PacketRescue(data, dialect, {"tlog": True, "raw": False}.get(name))


def _no_progress(done: int, size: int) -> None:
    """Ignore the progress."""
