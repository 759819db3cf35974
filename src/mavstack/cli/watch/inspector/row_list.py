"""A list of rows with a heading and a cursor, which renders only the rows that are seen.

It is drawn several times a second while a busy link is parsed, so its cost depends on the height of the
terminal, not on the number of rows. The cursor stays on its row when rows are added or sorted again.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

from rich.text import Text
from textual.binding import Binding
from textual.geometry import Size
from textual.message import Message
from textual.scroll_view import ScrollView
from textual.strip import Strip

from mavstack.cli.common.text import printable

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Sequence

    from rich.style import Style
    from textual import events
    from textual.binding import BindingType

Row = TypeVar("Row")


class RowList(ScrollView, Generic[Row], can_focus=True):
    """A list of rows.

    Args:
        heading: Returns the heading for a width.
        line: Returns the text of a row for a width.
        key: Returns the identity of a row.
        id: Name of the widget.
        newest_first: True if new rows come first.
    """

    DEFAULT_CSS = """
    RowList { overflow-x: hidden; border: round $foreground 25%; }
    RowList { border-title-color: $foreground; border-subtitle-color: $foreground; }
    RowList:focus { border: round $accent; }
    RowList > .rows--heading { color: $text-muted; text-style: bold; }
    RowList > .rows--cursor { background: $surface-lighten-2; text-style: bold; }
    RowList:focus > .rows--cursor { background: $primary; color: $text; text-style: bold; }
    """
    COMPONENT_CLASSES: ClassVar[set[str]] = {"rows--heading", "rows--cursor"}
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("up,k", "move(-1)", "Up", show=False),
        Binding("down,j", "move(1)", "Down", show=False),
        Binding("pageup", "page(-1)", "Page up", show=False),
        Binding("pagedown", "page(1)", "Page down", show=False),
        Binding("home", "move(-1000000)", "First", show=False),
        Binding("end", "move(1000000)", "Last", show=False),
        Binding("left", "app.shift(-1)", "Previous source", show=False),
        Binding("right", "app.shift(1)", "Next source", show=False),
        Binding("enter", "choose", "Choose", show=False),
    ]

    class Moved(Message):
        """The user moved the cursor to another row."""

        def __init__(self, rows: RowList[Any]) -> None:
            super().__init__()
            self.rows = rows

        @property
        def control(self) -> RowList[Any]:
            """The list."""
            return self.rows

    class Chosen(Moved):
        """The user pressed Enter on a row, or clicked twice."""

    def __init__(
        self,
        heading: Callable[[int], Text],
        line: Callable[[Row, int], Text],
        key: Callable[[Row], Hashable],
        *,
        id: str,  # noqa: A002 (as textual calls it)
        newest_first: bool = False,
    ) -> None:
        super().__init__(id=id)
        self._heading = heading
        self._line = line
        self._key = key
        self._newest_first = newest_first
        self.rows: Sequence[Row] = ()
        self.cursor = 0

    @property
    def current(self) -> Row | None:
        """The row of the cursor; None if there are no rows."""
        return self.rows[self.cursor] if self.cursor < len(self.rows) else None

    def show(self, rows: Sequence[Row]) -> None:
        """Show rows; the cursor stays on the row with the same identity, otherwise it goes to the first row.

        In a list with the newest row first, a cursor on the first row stays there, and one whose row is gone
        stays where it was.
        """
        current, seen_at = self.current, self.cursor - self.scroll_offset.y
        self.rows = rows
        if current is not None and not (self._newest_first and self.cursor == 0):
            found = self.put_cursor(self._key(current))
            self.cursor = self.cursor if found or self._newest_first else 0
        self.cursor = max(min(self.cursor, len(rows) - 1), 0)
        size = Size(self.scrollable_content_region.width, len(rows) + 1)
        if size != self.virtual_size:
            self.virtual_size = size
        if (
            0 <= seen_at < self.scrollable_content_region.height
            and self.cursor != self.scroll_offset.y + seen_at
        ):
            self.scroll_to(y=self.cursor - seen_at, animate=False)
        self.refresh()

    def put_cursor(self, key: Hashable) -> bool:
        """Put the cursor on the row with an identity; return whether there is one."""
        for index, row in enumerate(self.rows):
            if self._key(row) == key:
                self.cursor = index
                return True
        return False

    def render_line(self, y: int) -> Strip:
        """Render one line of the widget: the heading, then the rows that are scrolled into view."""
        width = self.scrollable_content_region.width
        index = self.scroll_offset.y + y - 1
        if y == 0:
            return self._strip(self._heading(width), width, self.get_component_rich_style("rows--heading"))
        if index >= len(self.rows):
            return Strip.blank(width, self.rich_style)
        line = self._line(self.rows[index], width)
        if index == self.cursor:
            # a row under the cursor has only one text colour, which is readable on the cursor's background
            return self._strip(Text(line.plain), width, self.get_component_rich_style("rows--cursor"))
        return self._strip(line, width, self.rich_style)

    def action_move(self, rows: int) -> None:
        """Move the cursor by some rows."""
        self._move_to(self.cursor + rows)

    def action_page(self, pages: int) -> None:
        """Move the cursor by the rows that are seen."""
        self._move_to(self.cursor + pages * max(self.scrollable_content_region.height - 2, 1))

    def action_choose(self) -> None:
        """Choose the row of the cursor."""
        if self.current is not None:
            self.post_message(self.Chosen(self))

    def on_click(self, event: events.Click) -> None:
        """Move the cursor to the row that is clicked; a double click chooses it."""
        offset = event.get_content_offset(self)
        if offset is None or offset.y < 1:
            return
        self._move_to(self.scroll_offset.y + offset.y - 1)
        if event.chain == 2:
            self.action_choose()

    def _move_to(self, index: int) -> None:
        index = max(min(index, len(self.rows) - 1), 0)
        if index == self.cursor:
            return
        self.cursor = index
        self._scroll_to_cursor()
        self.refresh()
        self.post_message(self.Moved(self))

    def _scroll_to_cursor(self) -> None:
        top, seen = self.scroll_offset.y, self.scrollable_content_region.height - 1
        if self.cursor < top:
            self.scroll_to(y=self.cursor, animate=False)
        elif self.cursor >= top + seen:
            self.scroll_to(y=self.cursor - seen + 1, animate=False)

    def _strip(self, text: Text, width: int, style: Style) -> Strip:
        if not text.plain.isprintable():
            text.plain = printable(text.plain)
        text.no_wrap = True
        text.truncate(width, overflow="ellipsis", pad=True)
        text.end = ""
        return Strip(text.render(self.app.console), width).apply_style(style)
