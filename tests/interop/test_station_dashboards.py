"""Dashboards in Chromium: files of others, scripts that try to break out, old values, the keyboard."""

from __future__ import annotations

import json
import re
import socket
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from tests.interop.station import DESKTOP, PHONE, StationPage, chromium, near, station_page, web_server

if TYPE_CHECKING:
    from collections.abc import Iterator

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium")]

#: The first line of plots, and the arc of gauges, in the dark theme.
LINE = (86, 180, 233)
SKY = (62, 125, 200)
COLUMNS = "alt:m,roll:deg,pitch:deg,yaw:deg,lat:deg,lon:deg,mode"
#: Attempts of a script to reach the page, the network or the browser; 1 is a success.
ESCAPES = {
    "globals": """
        const kept = new Set(KEPT), found = [];
        const next = Object.getPrototypeOf;
        for (let owner = globalThis; owner && owner !== Object.prototype; owner = next(owner))
          for (const name of Object.getOwnPropertyNames(owner))
            if (!kept.has(name) && owner[name] !== undefined) found.push(name);
        if (found.length) throw new Error('left: ' + found.join(' '));
        return { found: 0 };""",
    "constructors": """
        let made = 0;
        const all = [() => {}, async () => {}, function* () {}, class {}, Object, Promise.prototype.then];
        for (const each of all) {
          try { each.constructor('return 1')(); made = 1; } catch {}
          try { Object.getPrototypeOf(each).constructor('return 1')(); made = 1; } catch {}
        }
        return { found: made };""",
    "prototypes": """
        Object.prototype.polluted = 1; Array.prototype.map = () => [{ found: 1 }];
        return { found: 0, polluted: 5 };""",
    "answers": """
        return { found: 0, toString() { return 'x'; }, get a() { throw 1; }, "__proto__x": 3 };""",
}
#: Scripts that the station must stop, and what it says.
STOPPED = {
    "endless": ("for (;;) {}", "took longer than"),
    "microtasks": ("(async () => { for (;;) await 0; })(); return {};", "took longer than"),
    "memory": ("state.a ??= []; for (;;) state.a.push(new Array(1e5).fill(1.5));", ""),
    "buffers": ("state.a ??= []; for (;;) state.a.push(new Uint8Array(1e9).fill(1));", ""),
}
ROOT = Path(__file__).parents[2]


class Sender:
    """A program that sends lines of values to the station."""

    def __init__(self) -> None:
        self._server = socket.create_server(("127.0.0.1", 0))
        self._server.settimeout(60)
        self._receiver: socket.socket | None = None
        self.url = f"csv+tcp://127.0.0.1:{self._server.getsockname()[1]}?name=bench&template={COLUMNS}"

    def send(self, altitude: float, mode: str = "FLYING") -> None:
        """Send a line, once the station is there."""
        if self._receiver is None:
            self._receiver, _ = self._server.accept()
        self._receiver.sendall(f"{altitude},10,-5,90,46.0,7.74,{mode}\n".encode())

    def close(self) -> None:
        for each in (self._receiver, self._server):
            if each is not None:
                each.close()


@contextmanager
def closing(sender: Sender) -> Iterator[Sender]:
    try:
        yield sender
    finally:
        sender.close()


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as opened:
        yield opened


def widget(kind: str, *fields: str, **more: Any) -> dict[str, Any]:
    return {"kind": kind, "title": f"The {kind}", "fields": [f"bench:ROW.{each}" for each in fields], **more}


def dashboard(*widgets: dict[str, Any], **more: Any) -> str:
    return json.dumps(
        {"type": "mavstack-dashboard", "version": 1, "title": "Test", "widgets": widgets, **more}
    )


def show(shown: StationPage, url: str, text: str) -> None:
    """Open a dashboard from a file."""
    shown.page.goto(f"{url}#/dashboards")
    file = {"name": "test.json", "mimeType": "application/json", "buffer": text.encode()}
    shown.page.locator(".dashboards input[type=file]").set_input_files(file)


def region(shown: StationPage, kind: str) -> Any:
    return shown.page.get_by_role("region", name=f"The {kind}")


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
    widget("value", "no_such", x=9, y=16, id="unknown"),
)


def test_every_widget_is_drawn_and_shows_old_values(browser: Any, tmp_path: Path) -> None:
    with (
        closing(Sender()) as sender,
        web_server(tmp_path, sender.url) as server,
        station_page(browser, server.url, DESKTOP) as shown,
    ):
        show(shown, server.url, dashboard(*WIDGETS))
        shown.wait_for("Test")
        sent = iter(range(100, 10**6, 3))

        def feed() -> None:
            sender.send(next(sent) % 900)

        def is_drawn(kind: str, colour: tuple[int, int, int], pixels: int) -> bool:
            feed()
            return near(shown.pixels(region(shown, kind)), colour) > pixels

        for kind, colour, pixels in (
            ("plot", LINE, 60),
            ("gauge", LINE, 60),
            ("fft", LINE, 60),
            ("map", LINE, 60),
            ("horizon", SKY, 300),
        ):
            shown.wait_until(lambda kind=kind, colour=colour, pixels=pixels: is_drawn(kind, colour, pixels))
        assert region(shown, "attitude").locator("canvas").is_visible()
        assert region(shown, "compass").locator("canvas").is_visible()
        sender.send(321.5)
        shown.wait_for("321.5")
        shown.wait_for("FLYING at 321.5 m")
        # Nothing more comes: the values stay, and say that they are old.
        region(shown, "gauge").get_by_text("no value for").wait_for(timeout=20_000)
        assert region(shown, "plot").locator("li.late").is_visible()
        assert "321.5" in region(shown, "gauge").inner_text()
        sender.send(400, "LANDED")
        region(shown, "gauge").get_by_text("no value for").wait_for(state="detached", timeout=20_000)
        shown.wait_for("LANDED at 400.0 m")
        for theme in ("light", "dark"):
            shown.page.emulate_media(color_scheme=theme)
            sender.send(500)
            shown.wait_for("500.0")


def test_scripts_cannot_leave_their_sandbox(browser: Any, tmp_path: Path) -> None:
    with (
        closing(Sender()) as sender,
        web_server(tmp_path, sender.url) as server,
        station_page(browser, server.url, DESKTOP) as shown,
    ):
        kept = re.search(
            r"const KEPT = \[(.*?)\]",
            (ROOT / "web/src/lib/scripts/sandbox.ts").read_text("utf-8"),
            re.DOTALL,
        )
        assert kept is not None
        scripts = [
            {
                "name": name,
                "inputs": {"a": "bench:ROW.alt"},
                "code": code.replace("KEPT", f"[{kept[1]}]"),
            }
            for name, code in ESCAPES.items()
        ]
        shown_results = [
            {"kind": "value", "title": f"The {name}", "fields": [f"script:{name}:OUT.found"], "y": 3 * at}
            for at, name in enumerate(ESCAPES)
        ]
        show(shown, server.url, dashboard(*shown_results, scripts=scripts))
        for name in ESCAPES:

            def is_known(name: str = name) -> bool:
                sender.send(1)
                return "0.0" in region(shown, name).inner_text()

            shown.wait_until(is_known)
        assert shown.page.get_by_role("alert").count() == 0
        assert shown.page.evaluate("({}).polluted === undefined && [1].map(each => each)[0] === 1")


@pytest.mark.parametrize("name", STOPPED)
def test_a_script_that_hangs_or_grows_is_stopped(name: str, browser: Any, tmp_path: Path) -> None:
    code, reason = STOPPED[name]
    with (
        closing(Sender()) as sender,
        web_server(tmp_path, sender.url) as server,
        station_page(browser, server.url, DESKTOP) as shown,
    ):
        script = {"name": name, "inputs": {"a": "bench:ROW.alt"}, "code": code}
        show(shown, server.url, dashboard(widget("value", "alt"), scripts=[script]))
        alert = shown.page.get_by_role("alert").filter(has_text=reason or f"{name}")

        def is_stopped() -> bool:
            sender.send(7)
            return bool(alert.count())

        shown.wait_until(is_stopped)
        # The page goes on.
        sender.send(8)
        shown.wait_for("8.0")


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
