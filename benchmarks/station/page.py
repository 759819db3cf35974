"""The page of the ground station with many vehicles: frames a second, and work per frame.

    python -m benchmarks.station.page [--vehicles 100] [--seconds 10] [--turns 3]

`flights.py` sends the packets of the vehicles to `mav web`; Chromium without a screen shows the page at
1440 x 900 and draws WebGL by software, on the processor that all programs share. Frames are those in which
the page could draw; the work per frame is that of the page's main thread. `growth.py` measures the memory.
"""

from __future__ import annotations

import argparse
from contextlib import contextmanager
from statistics import median
from typing import TYPE_CHECKING, NamedTuple

from benchmarks.station.__main__ import HOST, process, station
from tools.compilers import find

if TYPE_CHECKING:
    from collections.abc import Iterator

    from playwright.sync_api import Page as PlaywrightPage
    from playwright.sync_api import ViewportSize

SIZE: ViewportSize = {"width": 1440, "height": 900}
#: Seconds until all vehicles are there and the map shows them.
SETTLING_TIME = 12
THROTTLING = 4
#: Place of the mouse above the map, and how far it drags the map.
MAP, DRAG = (700, 300), 120
MEGABYTE = 1e6
COUNT_FRAMES = """() => {
  window.frames_drawn = 0;
  const count = () => { window.frames_drawn += 1; requestAnimationFrame(count); };
  requestAnimationFrame(count);
}"""


class Figures(NamedTuple):
    """The figures of one turn: frames a second, and milliseconds of the main thread per frame."""

    rate: float
    work: float


class Page:
    """The page in Chromium, with the protocol of its developer tools."""

    def __init__(self, page: PlaywrightPage) -> None:
        self.page = page
        self.tools = page.context.new_cdp_session(page)
        self.tools.send("Performance.enable")

    def measure(self, seconds: float, *, drags: bool = False) -> Figures:
        """Return the figures of some seconds; `drags` moves the map all the time."""
        before, frames = self._state()
        if drags:
            self._drag(before["Timestamp"] + seconds)
        else:
            self.page.wait_for_timeout(seconds * 1000)
        after, last = self._state()
        count, elapsed = last - frames, after["Timestamp"] - before["Timestamp"]
        return Figures(count / elapsed, (after["TaskDuration"] - before["TaskDuration"]) * 1000 / count)

    def throttle(self, factor: float) -> None:
        """Make the page's processor slower by a factor."""
        self.tools.send("Emulation.setCPUThrottlingRate", {"rate": factor})

    def counts(self) -> dict[str, float]:
        """Return memory (objects and buffers, MB), nodes and listeners after a garbage collection."""
        for _ in range(2):
            self.tools.send("HeapProfiler.collectGarbage")
        usage = self.tools.send("Runtime.getHeapUsage")
        metrics, _ = self._state()
        memory = float(usage["usedSize"] + usage.get("backingStorageSize", 0)) / MEGABYTE
        return {"page MB": memory, "nodes": metrics["Nodes"], "listeners": metrics["JSEventListeners"]}

    def _state(self) -> tuple[dict[str, float], int]:
        metrics = self.tools.send("Performance.getMetrics")["metrics"]
        return {each["name"]: each["value"] for each in metrics}, self.page.evaluate("window.frames_drawn")

    def _drag(self, end: float) -> None:
        mouse, (x, y) = self.page.mouse, MAP
        mouse.move(x, y)
        mouse.down()
        while self._state()[0]["Timestamp"] < end:
            for place in (x + DRAG, x):
                mouse.move(place, y, steps=30)
        mouse.up()


@contextmanager
def shown(url: str) -> Iterator[Page]:
    """Show a page of the station."""
    from playwright.sync_api import sync_playwright

    path = find("chromium")
    if path is None:
        raise SystemExit("Chromium is missing: python -m tools.compilers chromium")
    with sync_playwright() as driver:
        arguments = ["--no-sandbox", "--enable-unsafe-swiftshader"]
        browser = driver.chromium.launch(executable_path=path, args=arguments)
        page = browser.new_context(viewport=SIZE).new_page()
        page.goto(url)
        page.evaluate(COUNT_FRAMES)
        page.wait_for_timeout(SETTLING_TIME * 1000)
        yield Page(page)
        browser.close()


def measure(vehicles: int, seconds: float) -> dict[str, Figures]:
    """Return the figures of one turn by the way in which the page is used."""
    with (
        station() as (_, port, source),
        process("benchmarks.station.flights", source, vehicles),
        shown(f"http://{HOST}:{port}/#/fly") as page,
    ):
        found = {"watched": page.measure(seconds), "map dragged": page.measure(seconds, drags=True)}
        page.throttle(THROTTLING)
        found[f"watched, processor {THROTTLING} times slower"] = page.measure(seconds)
        return found


def main() -> None:
    """Measure frames in turns."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.station.page")
    parser.add_argument("--vehicles", type=int, default=100)
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--turns", type=int, default=3)
    options = parser.parse_args()
    turns = [measure(options.vehicles, options.seconds) for _ in range(options.turns)]
    print(
        f"{options.vehicles} vehicles at 10 Hz: frames a second, milliseconds of the main thread per frame\n"
    )
    for way in turns[0]:
        rates, works = zip(*(turn[way] for turn in turns), strict=True)
        print(
            f"{way:34} {median(rates):5.1f} ({min(rates):.1f} to {max(rates):.1f})  {median(works):6.2f} ms"
        )


if __name__ == "__main__":
    main()
