"""The kept packets of one message as CSV: a line for each packet, a column for each field.

The columns are those of `mav data convert --to csv`: times are in UTC by ISO 8601, values are raw, as on the
wire, and an array has a column for each element. Secrets are left out, and texts are not formulas.
"""

from __future__ import annotations

import csv
import io
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Final

from numpy import float32

from mavstack.atomic_file import write_file_atomically
from mavstack.dialects.secrets import secret_fields
from mavstack.errors import InvalidArgumentError
from mavstack.logs.export.csv_text import escape_formula

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.cli.watch.inspector.packet_store import StoredPacket, StreamKey
    from mavstack.dialects.model import FieldDefinition, MessageDefinition

_HEAD: Final = ("_time", "_system", "_component", "_sequence", "_version")


def csv_text(entries: Sequence[StoredPacket]) -> str:
    """Return packets of one stream as CSV, in their order.

    Raises:
        InvalidArgumentError: There is no packet, or the message is not in the dialect.
    """
    message = entries[0].packet.message if entries else None
    if message is None:
        raise InvalidArgumentError("export failed: there is no packet whose fields are known")
    definition = type(message).definition
    fields = [field for field in definition.fields if field.name not in secret_fields(definition.name)]
    output = io.StringIO()
    writer = csv.writer(output, lineterminator="\n")
    writer.writerow([*_HEAD, *(name for field in fields for name in _columns(field))])
    writer.writerows(_row(entry, fields) for entry in entries)
    return output.getvalue()


def default_path(definition: MessageDefinition, stream: StreamKey) -> str:
    """Return the name of a file that does not exist yet: `ATTITUDE-1-1.csv`, then `ATTITUDE-1-1-2.csv`."""
    label = f"{stream.label}-" if stream.label else ""
    stem = f"{definition.name}-{label}{stream.system}-{stream.component}"
    path, count = Path(f"{stem}.csv"), 1
    while path.exists():
        count += 1
        path = Path(f"{stem}-{count}.csv")
    return str(path)


def export_csv(entries: Sequence[StoredPacket], path: str) -> None:
    """Write packets of one stream to a new file.

    Raises:
        InvalidArgumentError: There is nothing to write, or the file exists.
        OSError: The file cannot be written.
    """
    text = csv_text(entries)
    if Path(path).exists():
        raise InvalidArgumentError(f"export failed: {path} exists; choose another name")
    write_file_atomically(path, text)


def _columns(field: FieldDefinition) -> list[str]:
    if not field.array_length or field.type == "char":
        return [field.name]
    return [f"{field.name}_{index}" for index in range(field.array_length)]


def _row(entry: StoredPacket, fields: Sequence[FieldDefinition]) -> list[object]:
    packet = entry.packet
    head = [_time_text(entry.time), packet.system, packet.component, packet.sequence, packet.version]
    values = [each for field in fields for each in _values(getattr(packet.message, field.name), field.type)]
    return [*head, *values]


def _values(value: object, kind: str) -> list[object]:
    if isinstance(value, tuple | bytes):
        return [each for item in value for each in _values(item, kind)]
    if isinstance(value, float):
        return [float32(value) if kind == "float" else value]
    return [int(value) if isinstance(value, int) else escape_formula(value)]


def _time_text(time: float) -> str:
    """Return a Unix time in UTC; empty if it is not known or beyond the calendar."""
    try:
        return f"{datetime.fromtimestamp(time, UTC):%Y-%m-%d %H:%M:%S.%f}Z" if time else ""
    except (ValueError, OverflowError, OSError):  # the time is out of range in a damaged or forged recording
        return ""
