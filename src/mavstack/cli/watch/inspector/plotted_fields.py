"""The fields that are plotted together, each with a colour of its own."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.cli.watch.inspector.field_series import FieldSeries, LinkClock, PlottedField
from mavstack.cli.watch.inspector.field_table import field_names
from mavstack.cli.watch.inspector.packet_store import StreamKey
from mavstack.cli.watch.inspector.plot import COLOURS, PlotSeries
from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from mavstack.cli.watch.inspector.field_table import FieldName
    from mavstack.cli.watch.inspector.packet_store import PacketStore
    from mavstack.cli.watch.trend import FieldPatterns
    from mavstack.wire import Packet

#: Maximum number of fields in the plot: one for each colour.
MAX_PLOTTED: Final = len(COLOURS)


class PlottedFields:
    """The plotted fields.

    Args:
        live: Whether each link is live, by its letter; a replay is not.
        patterns: Fields that are plotted once they are received; None: none.
    """

    def __init__(self, live: Mapping[str, bool], patterns: FieldPatterns | None = None) -> None:
        self._clocks = {label: LinkClock(live=is_live) for label, is_live in live.items()}
        self._patterns = patterns
        self._matched: set[StreamKey] = set()
        self._series: dict[PlottedField, FieldSeries] = {}

    def receive(self, label: str, packets: Sequence[Packet], time: float, now: float) -> None:
        """Set the clock of a link by packets, and plot those of their fields that the patterns name."""
        self._clocks[label].receive(time, now)
        if self._patterns is None:
            return
        for packet in packets:
            key = StreamKey(label, packet.system, packet.component, packet.message_id)
            if key not in self._matched:
                self._matched.add(key)
                self._plot_matching(key, packet, self._patterns)

    def names(self, stream: StreamKey | None) -> dict[FieldName, str]:
        """Return the colours of the plotted fields of a stream."""
        return {field.name: each.colour for field, each in self._series.items() if field.stream == stream}

    def toggle(self, fields: Sequence[PlottedField], message: str) -> None:
        """Plot fields of a message; if one of them is plotted already, end the plots of all of them.

        Raises:
            InvalidArgumentError: There are no colours left.
        """
        plotted = [field for field in fields if field in self._series]
        for field in plotted:
            del self._series[field]
        if plotted:
            return
        if len(self._series) + len(fields) > MAX_PLOTTED:
            raise InvalidArgumentError(f"at most {MAX_PLOTTED} fields can be plotted; remove some first")
        for field in fields:
            self._add(field, message)

    def clear(self) -> None:
        """Plot no field."""
        self._series.clear()
        self._patterns = None

    def series(self, store: PacketStore, now: float, span: float) -> list[PlotSeries]:
        """Return the series of the last `span` seconds before `now`, a time on a monotonic clock."""
        found = []
        for field, each in self._series.items():
            each.update(store)
            end = self._clocks[field.stream.label].at(now)
            points = each.points(end - span, end)
            found.append(PlotSeries(each.title, each.unit, each.colour, points, end))
        return found

    def _plot_matching(self, key: StreamKey, packet: Packet, patterns: FieldPatterns) -> None:
        wanted = set(patterns.fields(packet.name)) if packet.name is not None else set()
        names = field_names(packet.message) if wanted else []
        for name in names:
            if name.field in wanted and len(self._series) < MAX_PLOTTED:
                self._add(PlottedField(key, name), packet.name or "")

    def _add(self, field: PlottedField, message: str) -> None:
        used = {each.colour for each in self._series.values()}
        colour = next(each for each in COLOURS if each not in used)
        self._series[field] = FieldSeries(field, message, colour)
