"""The right half of the inspector's window: the selected message in three views, and the plot below them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from rich.text import Text
from textual.containers import Vertical
from textual.content import Content
from textual.widgets import ContentSwitcher, Static

from mavstack.cli.watch.inspector import lines
from mavstack.cli.watch.inspector.plot import plot_lines
from mavstack.cli.watch.inspector.row_list import RowList

if TYPE_CHECKING:
    from textual.app import ComposeResult

    from mavstack.cli.watch.inspector.field_table import FieldName, FieldRow
    from mavstack.cli.watch.inspector.model import Inspector
    from mavstack.cli.watch.inspector.packet_store import StoredPacket

#: The views of the selected message; each text begins with the key that shows the view.
VIEWS: Final = {"fields": "1 Fields", "comparison": "2 Compare", "packets": "3 Packets"}


class DetailPanel(Vertical):
    """The selected message, and the plot.

    Args:
        inspector: The model.
    """

    DEFAULT_CSS = """
    DetailPanel #views { height: 1fr; }
    DetailPanel #plot { height: 45%; border: round $foreground 25%; }
    DetailPanel #bytes { height: auto; max-height: 10; border: round $foreground 25%; }
    """

    def __init__(self, inspector: Inspector) -> None:
        super().__init__(id="detail")
        self._inspector = inspector
        self._first_compared = 0
        self._compared: list[str] = []
        self._colours: dict[FieldName, str] = {}

    def compose(self) -> ComposeResult:
        """Yield the parts of the panel."""
        with ContentSwitcher(initial="fields", id="views"):
            yield RowList(lines.field_heading, self._field_line, lambda row: row.name, id="fields")
            yield RowList(
                lambda width: lines.comparison_heading(self._compared, width, self._first_compared),
                lambda row, width: lines.comparison_line(row, width, self._first_compared),
                lambda row: row.name,
                id="comparison",
            )
            yield RowList(
                lines.packet_heading,
                lines.packet_line,
                lambda row: row.number,
                id="packets",
                newest_first=True,
            )
        yield Static(id="bytes")
        yield Static(id="plot")

    @property
    def view(self) -> str:
        """The view that is shown: fields, comparison or packets."""
        return self.query_one("#views", ContentSwitcher).current or "fields"

    @view.setter
    def view(self, name: str) -> None:
        focused = self.screen.focused is self.rows
        self.query_one("#views", ContentSwitcher).current = name
        if focused:
            self.rows.focus()

    @property
    def next_view(self) -> str:
        """The view that follows the one that is shown."""
        views = list(VIEWS)
        return views[(views.index(self.view) + 1) % len(views)]

    @property
    def rows(self) -> RowList[Any]:
        """The list of the view that is shown."""
        return self.query_one(f"#{self.view}", RowList)

    @property
    def has_plot(self) -> bool:
        """True if the plot is shown."""
        return self.query_one("#plot", Static).display

    def shift(self, columns: int) -> None:
        """Show the next or the previous sources side by side."""
        last = max(len(self._compared) - 1, 0)
        self._first_compared = max(min(self._first_compared + columns, last), 0)

    def show(self) -> None:
        """Show the selected message and the plot."""
        inspector, rows, view = self._inspector, self.rows, self.view
        every = view == "packets" and inspector.lists_all_packets
        tabs = [(f" {name} ", "reverse" if each == view else "") for each, name in VIEWS.items()]
        rows.border_title = Content.assemble(*tabs)
        rows.border_subtitle = Content("all messages" if every else inspector.selected_name)
        if view == "fields":
            self._colours = inspector.plot_colours
            rows.show(inspector.fields)
        elif view == "comparison":
            comparison = inspector.comparison
            self._compared = list(comparison.sources)
            rows.show(comparison.rows)
        else:
            rows.show(inspector.packets)
        self._show_bytes(rows.current if view == "packets" else None)
        self._show_plot()

    def _show_bytes(self, entry: StoredPacket | None) -> None:
        panel = self.query_one("#bytes", Static)
        panel.display = entry is not None
        if entry is not None:
            panel.update(lines.byte_lines(entry.packet, self.rows.content_size.width))

    def _show_plot(self) -> None:
        plot, series = self.query_one("#plot", Static), self._inspector.plot
        if plot.display != bool(series):
            plot.display = bool(series)
            self.app.refresh_bindings()
        size = plot.content_size
        if series and size.width and size.height:
            drawn = plot_lines(series, size.width, size.height, self._inspector.span)
            plot.update(Text("\n", no_wrap=True).join(drawn))

    def _field_line(self, row: FieldRow, width: int) -> Text:
        return lines.field_line(row, width, self._colours.get(row.name))
