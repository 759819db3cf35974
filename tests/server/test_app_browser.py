"""The pages of the station in a browser: messages, trends, dashboards, recordings and their replay."""

from __future__ import annotations

import asyncio
import json
import re
import runpy
import subprocess
import sys
import threading
from contextlib import ExitStack, contextmanager
from pathlib import Path
from queue import Queue
from urllib.request import Request, urlopen

import pytest

from mavstack.server.app import STATIC
from mavstack.sim.background import BackgroundSimulator
from tests.sharing import shared_until_failure
from tools.compilers import find

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium")]
playwright = pytest.importorskip("playwright.sync_api")

ROOT = Path(__file__).parents[2]
COLUMNS = "time:s,lat:deg,lon:deg,alt:m,roll:deg,pitch:deg,yaw:deg,speed:m/s,battery:V"
#: Pixels of a canvas in the colour of the first line of a plot in the dark theme.
LINE_PIXELS = """canvas => {
  const {width, height} = canvas, data = canvas.getContext('2d').getImageData(0, 0, width, height).data
  let count = 0
  for (let at = 0; at < data.length; at += 4)
    if (Math.abs(data[at] - 86) + Math.abs(data[at + 1] - 180) + Math.abs(data[at + 2] - 233) < 40) count++
  return count
}"""


@contextmanager
def csv_senders():
    """Run the senders of the example; yield the ports of its two drones."""
    example = runpy.run_path(str(ROOT / "examples" / "dashboards" / "csv_sender.py"))
    started: Queue[tuple[asyncio.AbstractEventLoop, asyncio.Event, list[int]]] = Queue()

    async def run() -> None:
        servers = [await example["serve"](example[name], 0) for name in ("north", "south")]
        stop = asyncio.Event()
        ports = [server.sockets[0].getsockname()[1] for server in servers]
        started.put((asyncio.get_running_loop(), stop, ports))
        await stop.wait()
        for server in servers:
            server.close()

    thread = threading.Thread(target=asyncio.run, args=[run()])
    thread.start()
    loop, stop, ports = started.get(timeout=10)
    try:
        yield ports
    finally:
        loop.call_soon_threadsafe(stop.set)
        thread.join()


@shared_until_failure
def station(folder):
    """`mav web` with two simulated copters and two drones that send CSV; its URL."""
    if not (STATIC / "index.html").is_file():
        pytest.skip("the pages are not built")
    with ExitStack() as steps:
        copters = steps.enter_context(BackgroundSimulator("copter", count=2))
        ports = steps.enter_context(csv_senders())
        names = zip(("north", "south"), ports, strict=True)
        rows = [f"csv+tcp://127.0.0.1:{port}?name={name}&template={COLUMNS}" for name, port in names]
        options = ["--port", "0", "--json", "--no-browser", "--folder", str(folder)]
        command = [sys.executable, "-m", "mavstack", "web", copters.url, *rows, *options]
        process = steps.enter_context(subprocess.Popen(command, stdout=subprocess.PIPE, text=True))
        steps.callback(process.terminate)
        yield json.loads(process.stdout.readline())["url"]


@shared_until_failure
def page(_folder):
    """A page of the station, whose console must be empty in the end."""
    path = find("chromium")
    if path is None:
        pytest.skip("no Chromium")
    problems = []
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=path, args=["--no-sandbox"])
        context = browser.new_context(viewport={"width": 1440, "height": 900}, color_scheme="dark")
        page = context.new_page()
        page.on("console", lambda each: problems.append(each.text) if each.type == "error" else None)
        page.on("pageerror", lambda error: problems.append(str(error)))
        yield page
        browser.close()
    assert problems == []


def number_of(widget, label: str) -> float:
    """Return the newest value of a line of a plot."""
    texts = widget.locator("li", has_text=label)
    playwright.expect(texts.locator("b")).to_have_text(re.compile("[0-9]"), timeout=20_000)
    return float(texts.locator("b").inner_text())


def test_messages_and_trends(page, station) -> None:
    page.goto(f"{station}#/inspect")
    page.get_by_role("button", name="1/1", exact=False).first.click(timeout=20_000)
    page.locator("[role=option][data-name=ATTITUDE]").click(timeout=20_000)
    time = page.get_by_role("row", name="time_boot_ms").locator("td").first
    before = time.inner_text()
    playwright.expect(time).not_to_have_text(before)
    page.get_by_label("Plot yaw", exact=True).click()
    canvas = page.get_by_role("img", name="Trends of 1/1:ATTITUDE.yaw").locator("canvas")
    canvas.wait_for()
    page.wait_for_function(f"canvas => ({LINE_PIXELS})(canvas) > 40", arg=canvas.element_handle())
    page.get_by_role("tab", name="Packet").click()
    playwright.expect(page.get_by_text("bytes from 1/1")).to_be_visible()


def test_dashboards_show_both_drones(page, station) -> None:
    page.goto(f"{station}#/dashboards")
    choice = page.get_by_role("combobox", name="Dashboards")
    choice.select_option("zermatt")
    altitude = page.get_by_role("region", name="Altitude above sea level")
    assert number_of(altitude, "Drone 1") > 0
    assert number_of(altitude, "Drone 2") > 0
    choice.select_option("zermatt-csv")
    assert number_of(altitude, "North") == pytest.approx(1850, abs=20)
    assert number_of(altitude, "South") == pytest.approx(1790, abs=20)


def test_the_generator_makes_a_library(page, station) -> None:
    page.goto(f"{station}#/generator")
    page.get_by_label("Lua", exact=False).first.check()
    page.get_by_label("Only these messages").fill("NO_SUCH")
    playwright.expect(page.get_by_role("alert")).to_contain_text("no message matches")
    page.get_by_label("Only these messages").fill("HEARTBEAT")
    with page.expect_download() as download:
        page.get_by_role("button", name="Generate and download").click()
    assert Path(download.value.path()).read_bytes()[:2] == b"PK"


def test_a_flight_is_recorded_and_replayed(page, station) -> None:
    page.goto(f"{station}#/logs")
    page.get_by_role("button", name="Record", exact=True).click()
    # Some seconds of flight: a short replay would be at its end before its time is read.
    playwright.expect(page.get_by_text("packets")).to_contain_text(re.compile(r"\d\D?\d{3}"), timeout=60_000)
    page.get_by_role("button", name="Stop").click()
    page.get_by_role("button", name="Replay", exact=True).click()
    bar = page.get_by_role("slider", name="Time in the recording")
    bar.wait_for()
    page.get_by_role("button", name="End the replay").wait_for()
    before = bar.input_value()
    page.wait_for_function("([bar, before]) => bar.value !== before", arg=[bar.element_handle(), before])


def test_rows_are_in_the_api(station) -> None:
    with urlopen(Request(f"{station}api/rows"), timeout=10) as answer:
        rows = json.loads(answer.read())
    assert {each["source"] for each in rows} == {"north", "south"}
