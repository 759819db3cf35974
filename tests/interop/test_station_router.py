"""The router view in Chromium: endpoints, rates and routes of a router that runs beside the station."""

from __future__ import annotations

import re
import subprocess
import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import pytest

from mavstack.sim import BackgroundSimulator
from tests.interop.station import DESKTOP, PATIENT, station_page, web_server
from tests.links.test_tcp import free_port

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium"), pytest.mark.timeout(240)]


@contextmanager
def router(control: int, *endpoints: str) -> Iterator[subprocess.Popen[bytes]]:
    """Run `mav route` with endpoints, and its control API at a port."""
    words = [word for endpoint in endpoints for word in ("-e", endpoint)]
    command = [sys.executable, "-m", "mavstack", "route", "--control", f"127.0.0.1:{control}", *words]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        try:
            yield process
        finally:
            process.terminate()


def test_a_router_is_shown_until_it_ends(browser: Any, tmp_path: Path) -> None:
    control, station, port = free_port(), free_port(), free_port()
    vehicle, ground = f"udpin://127.0.0.1:{port}", f"udpout://127.0.0.1:{station}"
    arguments = (f"udpin://127.0.0.1:{station}", "--router", f"127.0.0.1:{control}")
    with (
        BackgroundSimulator(link=f"udpout://127.0.0.1:{port}"),
        router(control, vehicle, ground) as process,
        web_server(tmp_path, *arguments) as server,
        station_page(browser, server.url, DESKTOP) as shown,
    ):
        shown.page.goto(f"{server.url}#/router")
        endpoints = shown.page.get_by_role("table", name="Endpoints")
        for url in (vehicle, ground):
            endpoints.get_by_text(url).wait_for(timeout=PATIENT)
        routes = shown.page.get_by_role("table", name="Routes")
        routes.get_by_text("1/1", exact=True).wait_for(timeout=PATIENT)
        shown.wait_until(lambda: re.search(r"[1-9][\d.]*/s", endpoints.inner_text()))
        process.terminate()
        process.wait(30)
        shown.wait_for("The router does not answer")
        shown.expect_problems("Failed to load resource")
