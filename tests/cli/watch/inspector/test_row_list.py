"""A list of rows with a cursor."""

from __future__ import annotations

from contextlib import asynccontextmanager

from rich.text import Text
from textual.app import App

from mavstack.cli.watch.inspector.row_list import RowList


class ListApp(App[None]):
    def __init__(self, *, newest_first: bool = False) -> None:
        super().__init__()
        self.rows = RowList(
            lambda width: Text("HEADING"),
            lambda row, width: Text(f"row {row}", "red"),
            lambda row: row,
            id="rows",
            newest_first=newest_first,
        )
        self.moves: list[int | None] = []
        self.chosen: list[int | None] = []

    def compose(self):
        yield self.rows

    def on_row_list_moved(self, event: RowList.Moved) -> None:
        self.moves.append(event.rows.current)

    def on_row_list_chosen(self, event: RowList.Chosen) -> None:
        self.chosen.append(event.rows.current)


@asynccontextmanager
async def listed(rows, **options):
    app = ListApp(**options)
    async with app.run_test(size=(20, 8)) as pilot:
        app.rows.focus()
        app.rows.show(rows)
        await pilot.pause()
        yield app, pilot


def seen(app: ListApp) -> list[str]:
    return [app.rows.render_line(y).text.strip() for y in range(app.rows.content_size.height)]


async def test_the_cursor_scrolls_the_list_below_the_heading():
    async with listed(range(100)) as (app, pilot):
        assert seen(app) == ["HEADING", *(f"row {index}" for index in range(5))]
        await pilot.press("down", "end")
        assert app.moves == [1, 99]
        assert seen(app) == ["HEADING", *(f"row {index}" for index in range(95, 100))]
        await pilot.press("pageup")
        assert app.rows.current == 95
        await pilot.press("up", "home", "enter")
        assert (app.rows.current, app.chosen) == (0, [0])


async def test_the_cursor_stays_on_its_row():
    async with listed([1, 2, 3]) as (app, pilot):
        await pilot.press("down")
        app.rows.show([0, 3, 2, 1])
        assert app.rows.current == 2
        app.rows.show([7])
        assert app.rows.current == 7
        app.rows.show([])
        assert app.rows.current is None
        await pilot.press("down", "enter")
        assert app.chosen == []


async def test_the_cursor_goes_to_the_first_row_when_its_row_is_gone():
    async with listed(range(10)) as (app, pilot):
        await pilot.press("down", "down", "down")
        app.rows.show([1, 2, 4, 5, 6])
        assert app.rows.current == 1


async def test_the_cursor_on_the_newest_row_stays_there():
    async with listed([3, 2, 1], newest_first=True) as (app, pilot):
        app.rows.show([4, 3, 2, 1])
        assert app.rows.current == 4
        await pilot.press("down")
        app.rows.show([5, 4, 3, 2, 1])
        assert app.rows.current == 3


async def test_clicks():
    async with listed(range(100)) as (app, pilot):
        await pilot.click(app.rows, offset=(3, 4))
        assert app.rows.current == 2
        await pilot.click(app.rows, offset=(3, 4), times=2)
        assert app.chosen == [2]
        await pilot.click(app.rows, offset=(3, 1))
        assert app.rows.current == 2
