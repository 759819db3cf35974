"""Dashboards in Chromium: every widget, old values, the examples, files of others, the keyboard."""

from __future__ import annotations

import itertools
import re
import socket
import subprocess
import sys
import threading
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.server import ServerConnection, serve

from tests.interop.dashboards import dashboard, region, sending, show, widget
from tests.interop.station import DESKTOP, PHONE, StationPage, near, station_page, web_server
from tests.interop.test_station_serial import SERIAL

if TYPE_CHECKING:
    from collections.abc import Iterator

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium")]

ROOT = Path(__file__).parents[2]
#: The first line of plots, and the arc of gauges, in the dark theme; the second line.
LINE, SECOND_LINE = (86, 180, 233), (230, 159, 0)
SKY = (62, 125, 200)
TWO_DRONES = {"Map": SECOND_LINE, "Altitude above sea level": SECOND_LINE, "Ground speed": SECOND_LINE}
#: The programs of examples, and their ports.
ZERMATT = ("zermatt", (5760, 5761))
CSV_SENDER = ("csv_sender", (5781, 5782, 5790))
#: The titles of examples, their programs, and the colours in some of their widgets.
EXAMPLES = {
    "Two drones near Zermatt": (ZERMATT, {"Drone 1": SKY, "Drone 2": SKY, **TWO_DRONES}),
    "Two drones near Zermatt (CSV)": (CSV_SENDER, {"North": SKY, "South": SKY, **TWO_DRONES}),
    "CanSat": (
        CSV_SENDER,
        {
            "Altitude": LINE,
            "Climb rate": LINE,
            "Map": LINE,
            "Acceleration": SECOND_LINE,
            "Spectrum of az": LINE,
        },
    ),
}


WIDGETS = (
    widget("plot", "alt", width=6),
    widget("gauge", "alt", x=6, maximum=1000),
    widget("value", "alt", x=9),
    widget("text", "mode", "alt", x=9, y=3, text="{1} at {2} m"),
    widget("horizon", "roll", "pitch", y=9),
    widget("compass", "yaw", x=3, y=9),
    widget("attitude", "roll", "pitch", "yaw", x=6, y=9),
    widget("map", "lat", "lon", y=14),
    widget("fft", "alt", x=6, y=14),
    {**widget("value", "no_such", x=9, y=16), "title": "The unknown"},
    {"kind": "value", "title": "The absent", "fields": ["77:NO_SUCH_MESSAGE.field"], "x": 9, "y": 18},
)
KINDS = ("plot", "gauge", "value", "text", "horizon", "compass", "attitude", "map", "fft")
#: Colours of widgets with values, and so many pixels of them.
COLOURS = {
    "plot": (LINE, 60),
    "gauge": (LINE, 60),
    "fft": (LINE, 60),
    "map": (LINE, 60),
    "horizon": (SKY, 300),
}


def has_colour(shown: StationPage, place: Any, colour: tuple[int, int, int], count: int) -> bool:
    """Return whether so many pixels have a colour; the legend below the lines of a plot does not count."""
    lines = place.locator(".chart")
    found = near(shown.pixels(lines if lines.count() else place), colour)
    return found >= count


def differing(one: np.ndarray, other: np.ndarray) -> int:
    """Return how many pixels of two pictures differ; all if their sizes do."""
    if one.shape != other.shape:
        return one.size
    return int((np.abs(one - other) > 40).any(axis=2).sum())


@pytest.mark.nightly
def test_every_widget_is_drawn_and_shows_old_values(browser: Any, tmp_path: Path) -> None:
    with (
        sending() as sender,
        web_server(tmp_path, sender.url) as server,
        station_page(browser, server.url, DESKTOP) as shown,
    ):
        show(shown, server.url, dashboard(*WIDGETS))
        region(shown, "unknown").get_by_text("\N{EN DASH}").wait_for()
        empty = {kind: shown.pixels(region(shown, kind)) for kind in KINDS}
        altitudes = iter(range(100, 10**6, 3))

        def is_drawn(kind: str) -> bool:
            sender.send(next(altitudes) % 900)
            place = region(shown, kind)
            colour, count = COLOURS.get(kind, (LINE, 0))
            return (
                has_colour(shown, place, colour, count) and differing(shown.pixels(place), empty[kind]) > 60
            )

        for kind in KINDS:
            shown.wait_until(lambda kind=kind: is_drawn(kind))
        sender.send(321.5)
        shown.wait_for("321.5")
        shown.wait_for("FLYING at 321.5 m")
        # Nothing more comes: the values stay, and say that they are old.
        region(shown, "gauge").get_by_text("no value for").wait_for(timeout=20_000)
        assert region(shown, "plot").locator("li.late").is_visible()
        assert "321.5" in region(shown, "gauge").inner_text()
        assert "FLYING at 321.5 m" in region(shown, "text").inner_text()
        # Fields that never came are neither shown as numbers nor told as errors.
        assert "\N{EN DASH}" in region(shown, "unknown").inner_text()
        sender.send(400, "LANDED")
        region(shown, "gauge").get_by_text("no value for").wait_for(state="detached", timeout=20_000)
        shown.wait_for("LANDED at 400.0 m")
        for theme in ("light", "dark"):
            shown.page.emulate_media(color_scheme=theme)
            sender.send(500)
            shown.wait_for("500.0")


def free_ports(count: int) -> list[int]:
    """Return ports that are free now."""
    sockets = [socket.create_server(("127.0.0.1", 0)) for _ in range(count)]
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports


@contextmanager
def running(program: str) -> Iterator[None]:
    """Run the text of an example until the end of the block."""
    command = [sys.executable, "-u", "-c", program]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert "ports" in process.stdout.readline()
        try:
            yield
        finally:
            process.terminate()


@pytest.mark.parametrize("title", EXAMPLES)
def test_the_examples_show_their_sources(title: str, browser: Any, tmp_path: Path) -> None:
    """On other ports than theirs, which other programs of this machine may have."""
    (name, ports), colours = EXAMPLES[title]
    program = (ROOT / "examples" / "dashboards" / f"{name}.py").read_text("utf-8")
    with web_server(tmp_path) as server, station_page(browser, server.url, DESKTOP) as shown:
        shown.page.goto(f"{server.url}#/dashboards")
        shown.page.get_by_role("combobox", name="Dashboards", exact=True).select_option(label=title)
        with shown.page.expect_download() as download:
            shown.button("Save to a file").click()
        text = Path(download.value.path()).read_text("utf-8")
        for theirs, free in zip(ports, free_ports(len(ports)), strict=True):
            program, text = program.replace(str(theirs), str(free)), text.replace(str(theirs), str(free))
        with running(program):
            show(shown, server.url, text)
            shown.button("Add them").click()
            for widget_title, colour in colours.items():
                place = shown.page.get_by_role("region", name=widget_title, exact=True)
                shown.wait_until(lambda place=place, colour=colour: has_colour(shown, place, colour, 30))
            assert shown.page.get_by_text("needs sources").count() == 0
            assert shown.page.get_by_role("alert").count() == 0
            shown.wait_until(lambda: "\N{EN DASH}" not in shown.page.locator(".grid").inner_text())


class Device:
    """A device at a serial port of the page that sends lines of values."""

    def __init__(self) -> None:
        self._server = serve(self._send, "127.0.0.1", 0)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._server.serve_forever)
        self._thread.start()
        self.port = self._server.socket.getsockname()[1]

    def _send(self, client: ServerConnection) -> None:
        client.send(b"")
        for number in itertools.count():
            with suppress(ConnectionClosed):
                client.send(f"$IMU,{number % 90},x\n$GP".encode())
                client.send(b"S,12.5\nnonsense\n")
            if self._ended.wait(0.05):
                return

    def close(self) -> None:
        self._ended.set()
        self._server.shutdown()
        self._thread.join()


def test_a_device_at_a_serial_port_of_the_page(browser: Any, tmp_path: Path) -> None:
    with (
        closing(Device()) as device,
        web_server(tmp_path) as server,
        station_page(browser, server.url, DESKTOP) as shown,
    ):
        shown.page.add_init_script(SERIAL.replace("PORT", str(device.port)))
        shown.page.reload()
        fields = ["bench:IMU.roll", "bench:GPS.speed"]
        shown_values = {"kind": "text", "title": "The text", "fields": fields, "text": "{1} and {2}"}
        show(shown, server.url, dashboard(shown_values))
        shown.button("Sources").click()
        dialog = shown.page.get_by_role("dialog")
        dialog.get_by_label("Name").fill("bench")
        dialog.get_by_label("Columns").fill("$IMU,roll:deg,pitch")
        shown.button("Choose the port").click()
        dialog.get_by_text("rows,").wait_for()
        shown.button("Remove bench").click()
        dialog.get_by_label("Name").fill("bench")
        dialog.get_by_label("Columns").fill("$IMU,roll:deg,_|$GPS,speed:m/s*2,")
        shown.button("Choose the port").click()
        shown.wait_for("is not a column")
        dialog.get_by_label("Columns").fill("$IMU,roll:deg,_|$GPS,speed:m/s*2")
        shown.button("Choose the port").click()
        dialog.get_by_text(re.compile(r"[1-9]\d* rows, [1-9]\d* lines refused")).wait_for()
        shown.page.keyboard.press("Escape")
        region(shown, "text").get_by_text(re.compile(r"\d+\.0 and 25\.0")).wait_for()


def test_files_of_others_do_no_harm(browser: Any, tmp_path: Path) -> None:
    with web_server(tmp_path) as server, station_page(browser, server.url, DESKTOP) as shown:
        hostile = dashboard(
            {"kind": "text", "title": "<img src=x onerror=alert(1)>", "text": "<script>alert(2)</script>"},
            {"kind": "value", "y": 1e12, "height": 1e9, "x": -3, "fields": ["a:B.constructor"]},
            {"kind": "no such"},
            sources=["javascript:alert(3)"],
        )
        show(shown, server.url, hostile)
        shown.wait_for("<script>alert(2)</script>")
        assert shown.page.locator(".grid img").count() == 0
        assert shown.page.evaluate("document.querySelector('.grid').scrollHeight") < 3000
        for text, reason in (
            ("{", "not a dashboard"),
            ("[]", "not a dashboard"),
            (dashboard(version=7), "has the version 7"),
            (
                dashboard(scripts=[{"name": f"s{at}", "code": "1"} for at in range(20)]),
                "20 scripts are too many",
            ),
        ):
            show(shown, server.url, text)
            shown.wait_for(reason)


def test_widgets_are_arranged_by_the_keyboard(browser: Any, tmp_path: Path) -> None:
    with web_server(tmp_path) as server, station_page(browser, server.url, DESKTOP) as shown:
        show(
            shown, server.url, dashboard(widget("value", "alt", id="a"), widget("gauge", "alt", id="b", y=2))
        )
        shown.button("Edit").click()
        handle = shown.page.get_by_role("button", name=re.compile("Move.*The value"))
        handle.focus()
        before = region(shown, "value").bounding_box()
        for key in ("ArrowRight", "Shift+ArrowRight", "ArrowDown", "ArrowDown", "ArrowDown"):
            shown.page.keyboard.press(key)
            # Also after it has changed its place in the document the next key moves it.
            shown.wait_until(lambda: handle.evaluate("each => each === document.activeElement"))
        after = region(shown, "value").bounding_box()
        assert after["x"] > before["x"]
        assert after["width"] > before["width"]
        shown.page.set_viewport_size({"width": PHONE[0], "height": PHONE[1]})
        assert shown.page.evaluate("document.documentElement.scrollWidth") == PHONE[0]
        for name in ("Scripts", "Sources"):
            shown.button(name).click()
            shown.page.get_by_role("dialog").wait_for()
            assert shown.page.evaluate("document.documentElement.scrollWidth") == PHONE[0]
            shown.page.keyboard.press("Escape")
