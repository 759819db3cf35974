"""A browser ground station with a simulated vehicle, and Chromium that shows its pages."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from base64 import b64decode
from contextlib import contextmanager
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.request import Request, urlopen

import matplotlib.image
import numpy as np
import pytest

import mavstack
from mavstack.sim import BackgroundSimulator
from tests.sim.running import make_ready
from tools.compilers import find

if TYPE_CHECKING:
    from collections.abc import Iterator

#: Width and height of screens, and their pixels in each of a page.
DESKTOP, PHONE = (1440, 900), (390, 844)
#: Chromium tells every refused request; refusals of the vehicle are part of the test.
REFUSED = "409 (Conflict)"
#: Milliseconds for anything that the page waits for.
PATIENT = 60_000
MANUAL_CONTROL = 69
#: Opacity that a drawn pixel exceeds.
HARDLY = 0.5


@dataclass
class StationServer:
    """A running `mav web` with its vehicle."""

    url: str

    def state(self) -> dict[str, Any]:
        """Return the vehicle as the API tells it."""
        state: dict[str, Any] = self.get("vehicles/1")
        return state

    def wait_for_home(self) -> None:
        """Wait until the station has heard the vehicle and the place of its home."""
        end = time.monotonic() + PATIENT / 1000
        while not (self.get("vehicles") and self.state()["home"]):
            assert time.monotonic() < end, "no vehicle with a home was heard"
            time.sleep(0.1)

    def get(self, path: str) -> Any:
        """Return the answer to a request below `/api/`."""
        with urlopen(f"{self.url}api/{path}", timeout=20) as answer:
            return json.load(answer)

    def post(self, path: str, **body: Any) -> Any:
        """Send a request below `/api/`, and return its answer when what it asks for is done."""
        data, kind = json.dumps(body).encode(), {"Content-Type": "application/json"}
        with urlopen(Request(f"{self.url}api/{path}", data, kind), timeout=60) as answer:
            return json.loads(answer.read() or b"null")


@contextmanager
def web_server(folder: Path, *arguments: str, port: int = 0) -> Iterator[StationServer]:
    """Run `mav web` with some more arguments; port 0: a free one."""
    if not (Path(mavstack.__file__).parent / "server" / "static" / "index.html").is_file():
        pytest.skip("the station is not built: make station")
    options = ("--port", str(port), "--json", "--no-browser", "--folder", str(folder))
    command = [sys.executable, "-m", "mavstack", "web", *arguments, *options]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        try:
            yield StationServer(json.loads(process.stdout.readline())["url"])
        finally:
            process.terminate()


@contextmanager
def station_server(folder: Path) -> Iterator[StationServer]:
    """Serve a station with a copter that is ready to fly, twice as fast as real ones."""
    simulator = BackgroundSimulator(speed=2)
    make_ready(simulator.simulation)
    with simulator, web_server(folder, f"udpout://127.0.0.1:{simulator.port}") as server:
        server.wait_for_home()
        yield server


@contextmanager
def chromium() -> Iterator[Any]:
    """Run Chromium, which draws WebGL by software."""
    playwright = pytest.importorskip("playwright.sync_api")
    path = find("chromium")
    if path is None:
        pytest.skip("no Chromium")
    with playwright.sync_playwright() as driver:
        arguments = ["--no-sandbox", "--enable-unsafe-swiftshader"]
        browser = driver.chromium.launch(executable_path=path, args=arguments)
        yield browser
        browser.close()


@dataclass
class StationPage:
    """A page of the station; problems are errors of the console, and requests to other hosts."""

    page: Any
    problems: list[str] = field(default_factory=list)
    #: Parts of problems that are part of the test.
    expected: list[str] = field(default_factory=list)
    #: Numbers of the messages that the page has sent.
    sent: list[int] = field(default_factory=list)

    def button(self, name: str) -> Any:
        return self.page.get_by_role("button", name=name, exact=True)

    def hold(self, name: str) -> None:
        """Hold a guarded button until it acts."""
        self.button(name).hover(timeout=PATIENT)
        self.page.mouse.down()
        held = self.page.locator(".guarded.held")
        held.wait_for(timeout=PATIENT)
        held.wait_for(state="detached", timeout=PATIENT)
        self.page.mouse.up()

    def wait_for(self, text: str) -> None:
        """Wait until the page shows a text."""
        self.page.get_by_text(text).first.wait_for(timeout=PATIENT)

    def wait_until(self, holds: Any) -> None:
        """Wait until a condition holds, while the page goes on."""
        for _ in range(PATIENT // 100):
            if holds():
                return
            self.page.wait_for_timeout(100)
        raise AssertionError("condition not met")

    def expect_problems(self, *parts: str) -> None:
        """Let problems with one of some texts be part of the test: those until now, and those that come."""
        self.expected.extend(parts)
        self.problems[:] = filter(self.is_problem, self.problems)

    def is_problem(self, text: str) -> bool:
        """Return whether a text is no expected one."""
        return not any(part in text for part in self.expected)

    def take_problem(self, text: str) -> None:
        """Keep what the browser tells."""
        if self.is_problem(text):
            self.problems.append(text)

    def pixels(self, locator: Any | None = None) -> np.ndarray:
        """Return a picture of the page, or of a part of it, as colours between 0 and 255."""
        data = (locator or self.page).screenshot()
        return colours(data)

    def drawn(self) -> np.ndarray:
        """Return a picture of the map's vehicles and plans alone: buttons over it may have their colours."""
        canvas = self.page.locator(".map > canvas").first
        return colours(b64decode(canvas.evaluate("(each) => each.toDataURL().split(',')[1]")))


@contextmanager
def station_page(
    browser: Any, url: str, size: tuple[int, int], theme: str = "dark", *, any_certificate: bool = False
) -> Iterator[StationPage]:
    """Show the station; at the end there must be no problems."""
    viewport = {"width": size[0], "height": size[1]}
    context = browser.new_context(viewport=viewport, color_scheme=theme, ignore_https_errors=any_certificate)
    shown = StationPage(context.new_page())
    page = shown.page

    def keep_sent(payload: bytes | str) -> None:
        if isinstance(payload, bytes) and payload[0] == 0xFD:
            shown.sent.append(int.from_bytes(payload[7:10], "little"))

    def keep_error(message: Any) -> None:
        if message.type == "error" and REFUSED not in message.text:
            shown.take_problem(message.text)

    def keep_foreign(request: Any) -> None:
        if not request.url.startswith((url, f"blob:{url}", "data:")):
            shown.take_problem(request.url)

    page.on("console", keep_error)
    page.on("pageerror", lambda error: shown.take_problem(str(error)))
    page.on("websocket", lambda socket: socket.on("framesent", keep_sent))
    page.on("request", keep_foreign)
    try:
        page.goto(url)
        yield shown
    finally:
        context.close()
    assert shown.problems == [], "\n".join(shown.problems)


def colours(png: bytes) -> np.ndarray:
    """Return the colours of a picture between 0 and 255; black where it is hardly opaque."""
    pixels = matplotlib.image.imread(BytesIO(png), format="png")
    return pixels[..., :3] * (255 * (pixels[..., 3:] > HARDLY if pixels.shape[2] > 3 else 1))


def near(pixels: np.ndarray, colour: tuple[int, int, int], tolerance: int = 40) -> int:
    """Return how many pixels have about a colour."""
    return int((np.abs(pixels - np.array(colour)) < tolerance).all(axis=2).sum())
