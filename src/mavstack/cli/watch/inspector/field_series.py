"""The chosen fields of a plot as series of points, taken from the packets that are kept.

The time of a point is that of its packet. A series is drawn against the clock of its link: the clock of a
live link runs on while it is silent, that of a replay is the time of its last packet. Links with different
clocks, such as a vehicle and a recording of last year, are therefore plotted side by side.
"""

from __future__ import annotations

from bisect import bisect_left
from collections import deque
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.cli.watch.inspector.field_table import scaled_value, unit_suffix

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.cli.watch.inspector.field_table import FieldName
    from mavstack.cli.watch.inspector.packet_store import PacketStore, StreamKey

#: Maximum number of points of a series.
MAX_POINTS: Final = 30_000


class PlottedField(NamedTuple):
    """A field of a stream that is plotted."""

    stream: StreamKey
    name: FieldName


class Point(NamedTuple):
    """A value at a time in seconds; None if it is not known."""

    time: float
    value: float | None


class FieldSeries:
    """The points of one field.

    Args:
        field: The field.
        message: Name of its message.
        colour: Colour of its plot.
    """

    def __init__(self, field: PlottedField, message: str, colour: str) -> None:
        self.field = field
        self.message = message
        self.colour = colour
        self.unit = ""
        self._points: deque[Point] = deque(maxlen=MAX_POINTS)
        self._number = 0

    @property
    def title(self) -> str:
        """Source, message and field."""
        return f"{self.field.stream.source} {self.message}.{self.field.name}"

    def update(self, store: PacketStore) -> None:
        """Take the packets that came since the last update."""
        for entry in store.since(self.field.stream, self._number):
            self._number = entry.number
            message = entry.packet.message
            if message is None:
                continue
            self._points.append(Point(entry.time, scaled_value(message, self.field.name)))
            self.unit = self.unit or unit_suffix(entry.packet, self.field.name)

    def points(self, start: float, end: float) -> Sequence[Point]:
        """Return the points between two times, oldest first."""
        points = list(self._points)
        first = bisect_left(points, start, key=lambda point: point.time)
        return [point for point in points[first:] if point.time <= end]


class LinkClock:
    """The clock of a link: the time of its packets, which goes on while a live link is silent."""

    def __init__(self, *, live: bool) -> None:
        self._live = live
        self._time = 0.0
        self._received = 0.0

    def receive(self, time: float, now: float) -> None:
        """Note that a packet of the Unix time `time` was received at `now` on a monotonic clock."""
        self._time, self._received = time, now

    def at(self, now: float) -> float:
        """Return the time of the link at `now`."""
        return self._time + (now - self._received if self._live else 0.0)
