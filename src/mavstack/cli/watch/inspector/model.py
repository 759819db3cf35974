"""The model of the inspector, without its drawing: fed with packets, asked for rows.

`update` takes a picture of the sources at a time that is its argument. While the inspector is paused, the
picture and the packets stay as they are, and everything else goes on: another message can be selected,
plotted and exported as it was at that moment. Packets that arrive meanwhile are counted and kept.
"""

from __future__ import annotations

from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, Final

from mavstack.cli.watch.inspector.comparison import Comparison, compare
from mavstack.cli.watch.inspector.csv_export import default_path, export_csv
from mavstack.cli.watch.inspector.field_series import PlottedField
from mavstack.cli.watch.inspector.field_table import COURSE_LENGTH, field_rows
from mavstack.cli.watch.inspector.packet_store import PacketStore, StreamKey
from mavstack.cli.watch.inspector.plotted_fields import PlottedFields
from mavstack.cli.watch.inspector.source_rows import source_rows
from mavstack.cli.watch.snapshot import merge_snapshots
from mavstack.cli.watch.sources import take_snapshots
from mavstack.cli.watch.summary import message_order
from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from mavstack.cli.watch.inspector.field_table import FieldName, FieldRow
    from mavstack.cli.watch.inspector.packet_store import StoredPacket
    from mavstack.cli.watch.inspector.plot import PlotSeries
    from mavstack.cli.watch.inspector.source_rows import SourceRow
    from mavstack.cli.watch.snapshot import MessageRow, Snapshot
    from mavstack.cli.watch.sources import WatchedSource
    from mavstack.cli.watch.trend import FieldPatterns
    from mavstack.wire import Packet

#: Time spans of a plot in seconds; `next_span` switches to the next one.
SPANS: Final = (30.0, 60.0, 300.0, 10.0)
SORTS: Final = ("name", "rate", "count")
#: Maximum number of packets in the list of raw packets.
MAX_LISTED: Final = 500
_MARK_INTERVAL: Final = 1.0


@dataclass(frozen=True, slots=True)
class Picture:
    """The sources at one moment: the snapshot of each, by its letter, and all of them together."""

    parts: dict[str, Snapshot]
    whole: Snapshot
    now: float


class Inspector:
    """The state of the inspector.

    Args:
        sources: The links that are watched.
        sort: Order of the messages: name, rate or count.
        patterns: Fields that are plotted from the start; None: none.
        activity: Returns what is recorded or replayed, in words.
    """

    def __init__(
        self,
        sources: Sequence[WatchedSource],
        sort: str = SORTS[0],
        patterns: FieldPatterns | None = None,
        activity: Callable[[], str] = str,
    ) -> None:
        self.sort = sort
        self.span = SPANS[0]
        #: The source whose messages are shown; None: the messages of all sources.
        self.scope: SourceRow | None = None
        #: The filter of the listed messages: a part of the name, or a pattern with wildcards.
        self.search = ""
        #: The message whose fields are shown; None before the first message.
        self.selected: StreamKey | None = None
        #: True if the packets of all messages are listed; False: only the packets of the selected message.
        self.lists_all_packets = False
        #: True if all links have ended.
        self.has_ended = False
        self._activity = activity
        self._sources = sources
        self._plotted = PlottedFields({source.label: source.is_live for source in sources}, patterns)
        self._store = PacketStore()
        self._frozen: PacketStore | None = None
        self._marked: float | None = None
        self._picture: Picture | None = None

    # Received packets

    def receive(self, label: str, packets: Sequence[Packet], time: float, now: float) -> None:
        """Take packets of a link.

        Args:
            label: Letter of the source; empty if there is only one.
            packets: The packets, in their order.
            time: Their Unix time in seconds; of a replay, the recorded one.
            now: Time of the reception, in seconds of a monotonic clock.
        """
        self._store.add(label, packets, time)
        self._plotted.receive(label, packets, time, now)

    def update(self, now: float) -> None:
        """Take a picture of the sources, unless the inspector is paused."""
        if self._marked is None or now - self._marked >= _MARK_INTERVAL:
            self._marked = now
            for source in self._sources:
                source.observer.traffic.mark()
        if self._picture is not None and self.is_paused:
            return
        parts = take_snapshots(self._sources, now)
        self._picture = Picture(parts, merge_snapshots(parts), now)
        if self.selected is None and self.messages:
            self.select(_key(self.messages[0]))

    # The displayed state

    @property
    def picture(self) -> Picture:
        """The last picture; raises InvalidArgumentError before the first `update`."""
        if self._picture is None:
            raise InvalidArgumentError("there is no picture before update()")
        return self._picture

    @property
    def activity(self) -> str:
        """The running recording and replay in words, and whether all links have ended."""
        ended = "ended" if self.has_ended else ""
        return ", ".join(part for part in (self._activity(), ended) if part)

    @property
    def sources(self) -> list[SourceRow]:
        """A row for each link, its channels and its components."""
        titles = {source.label: source.title for source in self._sources}
        return [
            row
            for label, part in self.picture.parts.items()
            for row in source_rows(label, titles[label], part)
        ]

    @property
    def messages(self) -> list[MessageRow]:
        """The messages of the chosen source that match the search, in the chosen order."""
        rows = [row for row in self.picture.whole.messages if self._is_listed(row)]
        return message_order(rows, self.sort)

    @property
    def selected_name(self) -> str:
        """Name and source of the selected message."""
        row = self._selected_row
        return "" if row is None else f"{row.name} {row.source}"

    @property
    def fields(self) -> list[FieldRow]:
        """The fields of the selected message."""
        if self.selected is None:
            return []
        return field_rows(self._packets.newest(self.selected, COURSE_LENGTH))

    @property
    def comparison(self) -> Comparison:
        """The selected message of all sources that send it, side by side."""
        return compare(self._compared, self._packets)

    @property
    def packets(self) -> list[StoredPacket]:
        """The last packets of the selected message, or of all messages, newest first."""
        return self._packets.newest(None if self.lists_all_packets else self.selected, MAX_LISTED)

    @property
    def plot(self) -> list[PlotSeries]:
        """The series of the plotted fields within the span."""
        return self._plotted.series(self._packets, self.picture.now, self.span)

    @property
    def plot_colours(self) -> dict[FieldName, str]:
        """The colours of the plotted fields of the selected message."""
        return self._plotted.names(self.selected)

    # actions

    @property
    def is_paused(self) -> bool:
        """True if the picture stays as it is."""
        return self._frozen is not None

    def toggle_pause(self) -> None:
        """Pause, or go on."""
        self._frozen = self._store.copy() if self._frozen is None else None

    def select(self, key: StreamKey) -> None:
        """Select a message of a component."""
        self.selected = key

    def next_sort(self) -> None:
        """Change the order of the messages."""
        self.sort = SORTS[(SORTS.index(self.sort) + 1) % len(SORTS)]

    def next_span(self) -> None:
        """Change the seconds that the plot shows."""
        self.span = SPANS[(SPANS.index(self.span) + 1) % len(SPANS)]

    def toggle_scope(self, row: SourceRow | None) -> None:
        """List the messages of one source only, or of all again."""
        known = self.scope
        self.scope = None if row is None or (known is not None and known.key == row.key) else row

    def toggle_plot(self, name: FieldName, *, everywhere: bool = False) -> None:
        """Plot a field of the selected message, or end that.

        Args:
            name: The field.
            everywhere: True for all sources that send the message.

        Raises:
            InvalidArgumentError: The field is no number, or too many fields are plotted.
        """
        row = self._selected_row
        if row is None:
            return
        streams = self._compared if everywhere else [_key(row)]
        if not any(each.name == name and each.is_number for each in self.fields):
            raise InvalidArgumentError(f"plotting {row.name}.{name} failed: it is not a number")
        self._plotted.toggle([PlottedField(stream, name) for stream in streams], row.name)

    def clear_plot(self) -> None:
        """Plot no field."""
        self._plotted.clear()

    def default_export_path(self) -> str:
        """Return the name of a new file for the selected message.

        Raises:
            InvalidArgumentError: No message is selected, or its fields are not known.
        """
        row = self._selected_row
        message = None if row is None else row.packet.message
        if self.selected is None or message is None:
            raise InvalidArgumentError("export failed: select a message whose fields are known")
        return default_path(type(message).definition, self.selected)

    def export(self, path: str) -> int:
        """Write the kept packets of the selected message to a new CSV file; return their number.

        Raises:
            InvalidArgumentError: There is nothing to write, or the file exists.
            OSError: The file cannot be written.
        """
        entries = list(self._packets.stream(self.selected)) if self.selected is not None else []
        export_csv(entries, path)
        return len(entries)

    # details

    @property
    def _packets(self) -> PacketStore:
        return self._store if self._frozen is None else self._frozen

    @property
    def _compared(self) -> list[StreamKey]:
        """The streams of the selected message, of all sources."""
        if self.selected is None:
            return []
        message_id = self.selected.message_id
        return sorted(_key(row) for row in self.picture.whole.messages if row.message_id == message_id)

    @property
    def _selected_row(self) -> MessageRow | None:
        return next((row for row in self.picture.whole.messages if _key(row) == self.selected), None)

    def _is_listed(self, row: MessageRow) -> bool:
        if self.scope is not None and not self.scope.includes(row):
            return False
        pattern = self.search.upper()
        if not set(pattern) & set("*?["):
            pattern = f"*{pattern}*"
        return fnmatchcase(row.name.upper(), pattern) or fnmatchcase(row.source.upper(), pattern)


def _key(row: MessageRow) -> StreamKey:
    return StreamKey(row.label, row.system, row.component, row.message_id)
