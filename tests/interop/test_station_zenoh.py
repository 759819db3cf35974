"""The station in Chromium on a fleet that a gateway shows on Zenoh."""

from __future__ import annotations

import subprocess
import sys
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

import pytest

from tests.bridges.ros2.running import free_port, zenoh_router
from tests.interop.station import DESKTOP, PATIENT, station_page, web_server

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = [
    pytest.mark.interop,
    pytest.mark.nightly,
    pytest.mark.xdist_group("chromium"),
    pytest.mark.timeout(300),
]
COUNT = 4


def test_the_page_shows_the_whole_fleet_and_flies_it(browser: Any, tmp_path: Path) -> None:
    with ExitStack() as stack:
        router, port = stack.enter_context(zenoh_router()), free_port()
        for words in (
            ("zenoh", f"udpin://127.0.0.1:{port}", "--connect", f"tcp/127.0.0.1:{router}", "--allow-control"),
            ("--count", str(COUNT), "--out", f"udpout://127.0.0.1:{port}"),
        ):
            command = [sys.executable, "-m", "mavstack", "bridge" if words[0] == "zenoh" else "sim", *words]
            process = stack.enter_context(subprocess.Popen(command, stdout=subprocess.DEVNULL))
            stack.callback(process.terminate)
        server = stack.enter_context(web_server(tmp_path, f"zenoh://127.0.0.1:{router}"))
        shown = stack.enter_context(station_page(browser, server.url, DESKTOP))
        cards = [shown.page.get_by_text(f"Copter {each}", exact=True).last for each in range(1, COUNT + 1)]
        for card in cards:
            card.wait_for(timeout=PATIENT)
        cards[2].click()
        shown.button("Choose a vehicle: Copter 3").wait_for(timeout=PATIENT)
        shown.page.get_by_text("Ready to arm").first.wait_for(timeout=PATIENT)
        shown.hold("Arm")
        shown.button("Disarm").wait_for(timeout=PATIENT)
        armed = [each["system"] for each in server.get("vehicles") if each["armed"]]
        assert armed == [3]
