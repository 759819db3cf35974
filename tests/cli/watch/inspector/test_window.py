"""The window of the inspector, driven by keys, in virtual time."""

from __future__ import annotations

from contextlib import asynccontextmanager
from typing import TYPE_CHECKING

import pytest
from textual._xterm_parser import XTermParser
from textual.widgets import HelpPanel, Input, Static

from mavstack.cli.watch.inspector.detail_panel import DetailPanel
from mavstack.cli.watch.inspector.row_list import RowList
from mavstack.cli.watch.inspector.window import InspectorWindow
from mavstack.dialects import common
from mavstack.wire import encode
from tests.cli.conftest import setup_signing
from tests.cli.watch.inspector.watched import HEARTBEAT_ID, Watched, stream

if TYPE_CHECKING:
    from textual.pilot import Pilot

pytestmark = pytest.mark.flight
SIZE = (100, 30)


@asynccontextmanager
async def shown(watched: Watched, size: tuple[int, int] = SIZE):
    """Yield a window, which takes pictures only by `redraw`, and its pilot."""
    window = InspectorWindow(watched.inspector, lambda: watched.now, None)
    async with window.run_test(size=size) as pilot:
        await pilot.pause()
        yield window, pilot


async def press(pilot: Pilot[int], *keys: str) -> None:
    """Press keys, each after what the one before has caused."""
    for key in keys:
        await pilot.press(key)
        await pilot.pause()


def flying(**options) -> Watched:
    watched = Watched(**options)
    for source in watched.sources:
        watched.fly(label=source.label)
        watched.fly(5, system=2, label=source.label)
    return watched


def text(window: InspectorWindow, name: str) -> str:
    """Return the text that a list or a line of the window shows."""
    widget = window.query_one(f"#{name}")
    if isinstance(widget, RowList):
        return "\n".join(widget.render_line(y).text.rstrip() for y in range(widget.content_size.height))
    return str(window.query_one(f"#{name}", Static).render())


@pytest.mark.parametrize("size", [(80, 24), (160, 50), (30, 8), (20, 5)])
async def test_everything_is_drawn_at_any_size(size):
    watched = flying(links=2)
    async with shown(watched, size) as (window, pilot):
        for view in "123":
            await press(pilot, view, "t")
            window.redraw()
            await pilot.pause()
        assert "msg/s" in text(window, "status")


async def test_lists_and_the_fields_of_the_selected_message():
    watched = flying()
    async with shown(watched) as (window, pilot):
        assert "lost 0.0 %" in text(window, "status")
        assert "1/1  ARMED LOITER" in text(window, "sources")
        assert "ATTITUDE" in text(window, "messages")
        assert "roll" in text(window, "fields")
        assert "51.6°" in text(window, "fields")
        await press(pilot, "down", "down")
        assert watched.inspector.selected == stream(HEARTBEAT_ID)
        assert "ARDUPILOTMEGA" in text(window, "fields")


async def test_values_change_with_new_packets():
    watched = flying()
    async with shown(watched) as (window, pilot):
        watched.send(common.Attitude(roll=-0.5))
        window.redraw()
        await pilot.pause()
        assert "-28.6°" in text(window, "fields")


async def test_search_and_its_end():
    watched = flying()
    async with shown(watched) as (window, pilot):
        await press(pilot, "slash", *"beat")
        assert "ATTITUDE" not in text(window, "messages")
        await press(pilot, "enter")
        assert not window.query_one("#search", Input).display
        assert watched.inspector.search == "beat"
        await press(pilot, "escape")
        assert watched.inspector.search == ""
        await press(pilot, "slash", "x", "escape")
        assert "ATTITUDE" in text(window, "messages")


async def test_fields_are_plotted_from_the_keyboard():
    watched = flying()
    async with shown(watched) as (window, pilot):
        assert not window.query_one(DetailPanel).has_plot
        await press(pilot, "enter", "down", "t", "down", "down", "enter")
        plot = text(window, "plot")
        assert "1/1 ATTITUDE.roll" in plot
        assert "1/1 ATTITUDE.yaw" in plot
        assert "-30 s" in plot
        await press(pilot, "w")
        assert "-60 s" in text(window, "plot")
        await press(pilot, "x")
        assert not window.query_one(DetailPanel).has_plot


async def test_sources_side_by_side():
    watched = flying(links=2)
    async with shown(watched) as (window, pilot):
        await press(pilot, "2", "enter")
        heading = text(window, "comparison").splitlines()[0]
        assert heading.split() == ["FIELD", "A", "1/1", "A", "2/1", "B", "1/1", "+1", "→"]
        await press(pilot, "right")
        assert "B 2/1" in text(window, "comparison").splitlines()[0]
        await press(pilot, "down", "t")
        assert len(watched.inspector.plot) == 4


async def test_escape_and_a_digit_that_arrive_together():
    watched = flying()
    async with shown(watched) as (window, pilot):
        for digit, view in (("3", "packets"), ("2", "comparison"), ("1", "fields")):
            parser = XTermParser()
            events = [*parser.feed(f"\x1b{digit}"), *parser.feed("")]  # the second says that no more comes
            await press(pilot, *(event.key for event in events))
            assert window.query_one(DetailPanel).view == view


async def test_raw_packets():
    watched = flying()
    async with shown(watched) as (window, pilot):
        await press(pilot, "3")
        raw = watched.inspector.packets[0].packet.raw
        assert "ATTITUDE" in text(window, "packets")
        assert bytes.fromhex("".join(line[5:] for line in text(window, "bytes").split("\n"))) == raw
        await press(pilot, "a")
        assert "HEARTBEAT" in text(window, "packets")


async def test_no_secret_is_shown():
    watched = Watched()
    source = watched.sources[0]
    watched.inspector.receive("", source.observer.receive(source.title, setup_signing(), 0.0), 0.0, 0.0)
    watched.inspector.update(0.0)
    async with shown(watched) as (window, pilot):
        assert "(hidden)" in text(window, "fields")
        await press(pilot, "3")
        assert text(window, "bytes") == "(hidden)"
        assert bytes(range(100, 132)).hex() not in text(window, "packets")


async def test_pause():
    watched = flying()
    async with shown(watched) as (window, pilot):
        await press(pilot, "p")
        watched.send(common.VfrHud())
        window.redraw()
        assert "PAUSED" in text(window, "status")
        assert "VFR_HUD" not in text(window, "messages")
        await press(pilot, "p")
        assert "VFR_HUD" in text(window, "messages")


async def test_one_source_only():
    watched = flying()
    async with shown(watched) as (window, pilot):
        window.query_one("#sources").focus()
        await press(pilot, "down", "down", "enter")
        assert "1/1" not in text(window, "messages")
        assert "of 2/1" in str(window.query_one("#messages").border_title)
        await press(pilot, "escape")
        assert "1/1" in text(window, "messages")


async def test_export(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    watched = flying()
    async with shown(watched) as (window, pilot):
        await press(pilot, "e", "enter")
        assert len((tmp_path / "ATTITUDE-1-1.csv").read_text().splitlines()) == 11
        assert not window.query_one("#path", Input).display
        await press(pilot, "e", "escape")
        assert len(list(tmp_path.iterdir())) == 1


async def test_orders_keys_and_the_end():
    watched = flying()
    async with shown(watched) as (window, pilot):
        await press(pilot, "s")
        assert "by rate" in str(window.query_one("#messages").border_title)
        await press(pilot, "question_mark")
        assert window.screen.query(HelpPanel)
        shown_keys = {
            binding.key for _, binding, _, _ in window.screen.active_bindings.values() if not binding.system
        }
        assert {"1", "2", "3"} <= shown_keys
        assert not {"inverted_exclamation_mark", "trade_mark_sign", "pound_sign"} & shown_keys
        await press(pilot, "question_mark")
        await press(pilot, "q")
    assert window.return_code == 0


async def test_texts_from_the_wire_move_no_cursor():
    watched = Watched()
    watched.send(common.Statustext(text="\x1b[2Jevil [bold]"))
    watched.inspector.update(0.0)
    async with shown(watched) as (window, _pilot):
        assert "\x1b" not in text(window, "fields") + text(window, "notices")
        assert "evil [bold]" in text(window, "fields")
        assert "evil [bold]" in text(window, "notices")


async def test_without_packets():
    async with shown(Watched()) as (window, pilot):
        await press(pilot, "1", "t", "e", "2", "t", "3", "t", "enter", "down", "p", "p", "1")
        assert text(window, "fields").split() == ["FIELD", "VALUE", "COURSE"]


async def test_an_unknown_message():
    watched = Watched()
    raw = bytearray(encode(common.Attitude(), system=1, component=1))
    source = watched.sources[0]
    raw[7:10] = (60_000).to_bytes(3, "little")
    packets = source.observer.receive(source.title, bytes(raw), 0.0)
    packets = [*packets, *source.observer.flush(source.title, 0.0)]
    watched.inspector.receive("", packets, 0.0, 0.0)
    watched.inspector.update(0.0)
    async with shown(watched) as (window, pilot):
        await press(pilot, "2", "3", "1", "t", "e")
        assert "(" not in text(window, "fields")
