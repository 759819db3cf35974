"""The window of `mav watch --tui`; its logic is `Inspector`."""

from __future__ import annotations

from time import monotonic
from typing import TYPE_CHECKING, Any, ClassVar, Final

from rich.text import Text
from textual.app import App
from textual.binding import Binding
from textual.containers import Horizontal, Vertical
from textual.content import Content
from textual.widgets import Footer, HelpPanel, Input, Static

from mavstack.cli.common.text import printable
from mavstack.cli.watch.inspector import lines
from mavstack.cli.watch.inspector.detail_panel import DetailPanel
from mavstack.cli.watch.inspector.packet_store import StreamKey
from mavstack.cli.watch.inspector.row_list import RowList
from mavstack.errors import MavstackError

if TYPE_CHECKING:
    from collections.abc import Callable

    from textual.app import ComposeResult
    from textual.binding import BindingType

    from mavstack.cli.watch.inspector.model import Inspector
    from mavstack.cli.watch.inspector.source_rows import SourceRow
    from mavstack.cli.watch.snapshot import MessageRow

#: Seconds between two updates of the window.
REDRAW_INTERVAL: Final = 0.25
#: Minimum height of the terminal for more than one notice.
_TALL: Final = 36
_MIN_SOURCES_HEIGHT: Final = 5
#: Minimum width of the column of sources: the width of its heading.
_MIN_SOURCE_WIDTH: Final = 7


class InspectorWindow(App[int]):
    """Lists of sources and messages, the selected message in three views, and a plot.

    Args:
        inspector: The model.
        clock: Returns the time on a monotonic clock, in seconds.
        interval: Seconds between two pictures; None: only `redraw` takes one.
    """

    TITLE = "mav watch"
    ENABLE_COMMAND_PALETTE = False
    HORIZONTAL_BREAKPOINTS = [(0, "-narrow"), (110, "-wide")]  # noqa: RUF012
    CSS = """
    #status { height: 1; background: $panel; }
    #lists { width: 38; }
    .-wide #lists { width: 2fr; max-width: 72; }
    #detail { width: 1fr; }
    .-wide #detail { width: 3fr; }
    #messages { height: 1fr; }
    #notices { height: auto; max-height: 4; color: $text-warning; }
    """
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("slash", "search", "Search", key_display="/"),
        Binding("p", "pause", "Pause"),
        Binding("s", "sort", "Sort"),
        Binding("v", "next_view", "View"),
        Binding("t", "plot", "Plot"),
        Binding("w", "span", "Span"),
        Binding("x", "clear", "Clear plot", show=False),
        Binding("a", "all_packets", "All"),
        Binding("e", "export", "Export"),
        Binding("question_mark", "keys", "Keys", key_display="?"),
        Binding("q", "quit", "Quit"),
        Binding("ctrl+c,ctrl+q", "quit", "Quit", show=False, priority=True),
        Binding("escape", "back", "Back", show=False),
        # Over a slow connection, Escape and a digit may arrive together, which means Alt and the digit.
        # Textual reports some of these as the character that Alt and the digit produce on some keyboards.
        Binding("1,alt+1", "view('fields')", "Fields", show=False),
        Binding("2,alt+2", "view('comparison')", "Compare", show=False),
        Binding("3,alt+3", "view('packets')", "Packets", show=False),
        # `system=True` hides a binding from the help panel of keys.
        Binding("inverted_exclamation_mark", "view('fields')", show=False, system=True),
        Binding("trade_mark_sign", "view('comparison')", show=False, system=True),
        Binding("pound_sign", "view('packets')", show=False, system=True),
    ]

    def __init__(
        self,
        inspector: Inspector,
        clock: Callable[[], float] = monotonic,
        interval: float | None = REDRAW_INTERVAL,
    ) -> None:
        super().__init__()
        self.inspector = inspector
        self._clock = clock
        self._interval = interval
        self._source_width = _MIN_SOURCE_WIDTH

    def compose(self) -> ComposeResult:
        """Yield the parts of the window."""
        yield Static(id="status")
        with Horizontal():
            with Vertical(id="lists"):
                yield RowList(lines.source_heading, self._source_line, lambda row: row.key, id="sources")
                yield RowList(
                    lambda width: lines.message_heading(width, self._source_width),
                    lambda row, width: lines.message_line(row, width, self._source_width),
                    _message_key,
                    id="messages",
                )
                yield Input(placeholder="part of a name, or GPS*", id="search", compact=True)
            yield DetailPanel(self.inspector)
        yield Input(id="path", compact=True)
        yield Static(id="notices")
        yield Footer(compact=True)

    def on_mount(self) -> None:
        """Draw the first picture, and start to redraw."""
        for name in ("#search", "#path"):
            self.query_one(name).display = False
        self._list("messages").focus()
        self.redraw()
        if self._interval is not None:
            self.set_interval(self._interval, self.redraw)

    def on_resize(self) -> None:
        """Fit everything to the size of the terminal."""
        self.call_after_refresh(self.show)

    # drawing

    def redraw(self) -> None:
        """Take a picture and show it."""
        self.inspector.update(self._clock())
        self.show()

    def show(self) -> None:
        """Show the last picture."""
        inspector = self.inspector
        self.query_one("#status", Static).update(lines.status_line(inspector, self.size.width))
        self._show_sources()
        self._show_messages()
        self._detail.show()
        notices = inspector.picture.whole.texts[-(4 if self.size.height >= _TALL else 1) :]
        text = Text("\n".join(map(printable, notices)), no_wrap=True, overflow="ellipsis")
        self.query_one("#notices", Static).update(text)

    def _show_sources(self) -> None:
        sources = self._list("sources")
        sources.border_title = "Sources"
        sources.show(self.inspector.sources)
        sources.styles.height = min(len(sources.rows) + 3, max(self.size.height // 3, _MIN_SOURCES_HEIGHT))

    def _show_messages(self) -> None:
        messages, rows = self._list("messages"), self.inspector.messages
        messages.border_title = Content(f"Messages by {self.inspector.sort}{self._narrowing()}")
        self._source_width = max([len(row.source) + 1 for row in rows] + [_MIN_SOURCE_WIDTH])
        messages.show(rows)

    def _narrowing(self) -> str:
        """Return which messages are listed; empty for all."""
        inspector = self.inspector
        scope = f" of {inspector.scope.address}" if inspector.scope is not None else ""
        return f"{scope} /{inspector.search}" if inspector.search else scope

    def _source_line(self, row: SourceRow, width: int) -> Text:
        scope = self.inspector.scope
        line = lines.source_line(row, width)
        if scope is not None and scope.key == row.key:
            line.stylize("reverse")
        return line

    def check_action(self, action: str, _parameters: tuple[object, ...]) -> bool | None:
        """Offer the keys of the plot and of the packets only where they do something."""
        if action in ("span", "clear"):
            return any(panel.has_plot for panel in self.query(DetailPanel))
        if action == "all_packets":
            return any(panel.view == "packets" for panel in self.query(DetailPanel))
        return True

    # events

    def on_row_list_moved(self, event: RowList.Moved) -> None:
        """Select the message that the cursor is on, or show the packet."""
        if event.rows.id == "messages":
            self._select_current()
        elif event.rows.id == "packets":
            self.show()

    def on_row_list_chosen(self, event: RowList.Chosen) -> None:
        """Show only a source, go to the view of a message, or plot a field."""
        if event.rows.id == "sources":
            self.inspector.toggle_scope(self._list("sources").current)
            self.show()
        elif event.rows.id == "messages":
            self._select_current()
            self._detail.rows.focus()
        else:
            self.action_plot()

    def on_input_changed(self, event: Input.Changed) -> None:
        """Search while the user types."""
        if event.input.id == "search":
            self.inspector.search = event.value.strip()
            self.show()

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Keep the search, or write the file."""
        if event.input.id == "path":
            self._export(event.value)
        self._close(event.input)

    # actions

    def action_search(self) -> None:
        """Ask for a part of a name."""
        self._ask("search", self.inspector.search)

    def action_pause(self) -> None:
        """Pause, or go on."""
        self.inspector.toggle_pause()
        self.redraw()

    def action_sort(self) -> None:
        """Change the order of the messages."""
        self.inspector.next_sort()
        self.show()

    def action_span(self) -> None:
        """Change the seconds that the plot shows."""
        self.inspector.next_span()
        self.show()

    def action_clear(self) -> None:
        """Plot no field."""
        self.inspector.clear_plot()
        self.show()

    def action_view(self, name: str) -> None:
        """Show another view of the selected message."""
        self._detail.view = name
        self.refresh_bindings()
        self.show()

    def action_next_view(self) -> None:
        """Show the next view of the selected message."""
        self.action_view(self._detail.next_view)

    def action_all_packets(self) -> None:
        """List the packets of all messages, or of the selected one."""
        self.inspector.lists_all_packets = not self.inspector.lists_all_packets
        self.show()

    def action_shift(self, columns: int) -> None:
        """Show the next or the previous sources side by side."""
        self._detail.shift(columns)
        self.show()

    def action_plot(self) -> None:
        """Plot the field of the cursor, of all sources if they are compared, or end that."""
        view, row = self._detail.view, self._detail.rows.current
        if row is None or view == "packets":
            return
        try:
            self.inspector.toggle_plot(row.name, everywhere=view == "comparison")
        except MavstackError as error:
            self._report(error)
        self.show()
        # show again after the layout: only then the size of the plot is known
        self.call_after_refresh(self.show)

    def action_export(self) -> None:
        """Ask for the file that the selected message is written to."""
        try:
            self._ask("path", self.inspector.default_export_path())
        except MavstackError as error:
            self._report(error)

    def action_keys(self) -> None:
        """Show all keys, or hide them."""
        if self.screen.query(HelpPanel):
            self.action_hide_help_panel()
        else:
            self.action_show_help_panel()

    async def action_back(self) -> None:
        """End a question; otherwise end the search, or the choice of a source."""
        asked = next((each for each in self.query(Input) if each.has_focus), None)
        if asked is not None:
            self._close(asked)
        if asked is None and not self.inspector.search:
            self.inspector.scope = None
        elif asked is None or asked.id == "search":
            self.inspector.search = self.query_one("#search", Input).value = ""
        self.show()

    # details

    @property
    def _detail(self) -> DetailPanel:
        return self.query_one(DetailPanel)

    def _list(self, name: str) -> RowList[Any]:
        return self.query_one(f"#{name}", RowList)

    def _select_current(self) -> None:
        row = self._list("messages").current
        if row is not None:
            self.inspector.select(_message_key(row))
            self.show()

    def _ask(self, name: str, text: str) -> None:
        asked = self.query_one(f"#{name}", Input)
        asked.value = text
        asked.display = True
        asked.focus()

    def _close(self, asked: Input) -> None:
        asked.display = False
        self._list("messages").focus()

    def _export(self, path: str) -> None:
        try:
            count = self.inspector.export(path)
        except (MavstackError, OSError) as error:
            self._report(error)
        else:
            self.notify(f"{count} packets written to {path}", markup=False)

    def _report(self, error: Exception) -> None:
        self.notify(str(error), severity="error", markup=False)


def _message_key(row: MessageRow) -> StreamKey:
    return StreamKey(row.label, row.system, row.component, row.message_id)
