"""The set-up view in Chromium, with a simulated vehicle that a test handles meanwhile."""

from __future__ import annotations

import json
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any
from urllib.request import urlopen

from mavstack.sim import BackgroundSimulator
from mavstack.sim.background_controller import BackgroundFlightController
from tests.interop.station import DESKTOP, PATIENT, StationPage, StationServer, station_page, web_server
from tests.sim.running import make_ready

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

#: Simulated seconds per second.
SPEED = 2.0


@dataclass
class SetupPage:
    """The set-up view of one vehicle.

    Attributes:
        shown: The page.
        server: The station.
        simulator: The vehicle, or the flight controller.
    """

    shown: StationPage
    server: StationServer
    simulator: Any

    @property
    def page(self) -> Any:
        return self.shown.page

    def open(self, section: str) -> None:
        """Show a section."""
        sections = self.page.get_by_role("navigation", name="Set-up")
        sections.get_by_role("button", name=section, exact=True).click(timeout=PATIENT)

    def sections(self) -> list[str]:
        """Return the sections that the vehicle has."""
        sections = self.page.get_by_role("navigation", name="Set-up")
        found: list[str] = sections.get_by_role("button").all_inner_texts()
        return found

    def value(self, name: str) -> float:
        """Return the value of a parameter that the vehicle holds."""
        with urlopen(f"{self.server.url}api/vehicles/1/parameters/{name}", timeout=20) as answer:
            return float(json.load(answer)["value"])

    def wait_for_parameters(self) -> None:
        """Wait until parameters and metadata are there."""
        self.open("Parameters")
        self.page.locator(".parameter").first.wait_for(timeout=PATIENT)
        self.page.get_by_label("Downloading parameters").wait_for(state="detached", timeout=PATIENT)


@contextmanager
def set_up(
    browser: Any, simulator: Any, folder: Path, size: tuple[int, int] = DESKTOP, theme: str = "dark"
) -> Iterator[SetupPage]:
    """Show the set-up view of a simulated vehicle, or flight controller."""
    with ExitStack() as stack:
        stack.enter_context(simulator)
        is_controller = isinstance(simulator, BackgroundFlightController)
        link = simulator.url if is_controller else f"udpout://127.0.0.1:{simulator.port}"
        server = stack.enter_context(web_server(folder, link))
        shown = stack.enter_context(station_page(browser, server.url, size, theme))
        shown.page.set_default_timeout(PATIENT)
        shown.page.goto(f"{server.url}#/setup")
        yield SetupPage(shown, server, simulator)


def ready_vehicle(vehicle_type: str, firmware: str = "ardupilot") -> BackgroundSimulator:
    """Return a vehicle that is ready to fly, faster than real ones."""
    simulator = BackgroundSimulator(vehicle_type, firmware, speed=SPEED)
    make_ready(simulator.simulation)
    return simulator
