"""The selected message of several sources side by side: a row for each field, a column for each source."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mavstack.cli.watch.inspector.field_table import field_rows

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from mavstack.cli.watch.inspector.field_table import FieldName, FieldRow
    from mavstack.cli.watch.inspector.packet_store import PacketStore, StreamKey


@dataclass(frozen=True, slots=True)
class ComparisonRow:
    """One field and its value at each source; None if the source did not send it."""

    name: FieldName
    values: Sequence[FieldRow | None]

    @property
    def differs(self) -> bool:
        """True if the sources have different values."""
        return len({value.text for value in self.values if value is not None}) > 1


@dataclass(frozen=True, slots=True)
class Comparison:
    """One message of several sources."""

    sources: Sequence[str] = ()
    rows: Sequence[ComparisonRow] = ()


def compare(streams: Iterable[StreamKey], store: PacketStore) -> Comparison:
    """Return the last values of streams of one message side by side."""
    columns = {
        stream.source: {row.name: row for row in field_rows(store.newest(stream, 2))} for stream in streams
    }
    names = dict.fromkeys(name for column in columns.values() for name in column)
    rows = [ComparisonRow(name, [column.get(name) for column in columns.values()]) for name in names]
    return Comparison(list(columns), rows)
