"""Vehicles that the page in Chromium reaches by itself: by a WebSocket, and through a relay."""

from __future__ import annotations

import json
import subprocess
import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import pytest

from mavstack.cli.main import main
from mavstack.sim import BackgroundSimulator
from tests.interop.station import DESKTOP, PATIENT, StationPage, station_page, web_server
from tests.links.certificates import certificates  # noqa: F401 - a fixture
from tests.links.test_tcp import free_port
from tests.sim.running import make_ready

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium"), pytest.mark.timeout(240)]


@contextmanager
def relay(key: Path) -> Iterator[str]:
    """Run `mav relay serve`; yields its URL."""
    command = [
        sys.executable,
        "-m",
        "mavstack",
        "relay",
        "serve",
        "--tickets",
        str(key),
        "--port",
        "0",
        "--json",
    ]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        try:
            yield json.loads(process.stdout.readline())["url"]
        finally:
            process.terminate()


@contextmanager
def vehicle(link: str) -> Iterator[BackgroundSimulator]:
    simulator = BackgroundSimulator(link=link)
    make_ready(simulator.simulation)
    with simulator:
        yield simulator


def connect(shown: StationPage, address: str) -> None:
    shown.button("Connect by itself").click(timeout=PATIENT)
    shown.page.get_by_label("Address of a vehicle or a relay").fill(address)
    shown.button("Connect").click()


def fly(shown: StationPage) -> None:
    """Arm the vehicle through the page."""
    shown.button("Choose a vehicle: Copter 1").wait_for(timeout=PATIENT)
    shown.hold("Arm")
    shown.button("Disarm").wait_for(timeout=PATIENT)


def test_a_vehicle_behind_a_relay_is_flown_without_a_station(
    browser: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    key = tmp_path / "relay.key"
    key.write_text("a key of tickets")
    with relay(key) as url, web_server(tmp_path) as server:
        assert main(["relay", "invite", "boat", url, "--tickets", str(key), "--json"]) == 0
        found = json.loads(capsys.readouterr().out)
        with vehicle(found["host"]), station_page(browser, server.url, DESKTOP) as shown:
            connect(shown, found["guest"])
            fly(shown)
            assert "secret" not in shown.page.content()


@pytest.mark.nightly
def test_a_vehicle_with_a_websocket_is_flown_without_a_station(browser: Any, tmp_path: Path) -> None:
    port = free_port()
    link = f"wsin://127.0.0.1:{port}?origin=*&token=open"
    with vehicle(link), web_server(tmp_path) as server, station_page(browser, server.url, DESKTOP) as shown:
        connect(shown, "udpin://0.0.0.0:14550")
        shown.wait_for("must begin with wss://")
        shown.page.get_by_label("Address of a vehicle or a relay").fill(f"ws://127.0.0.1:{port}?token=open")
        shown.button("Connect").click()
        fly(shown)


@pytest.mark.nightly
def test_a_vehicle_with_tls_is_flown_without_a_station(
    browser: Any,
    tmp_path: Path,
    certificates: Path,  # noqa: F811
) -> None:
    port = free_port()
    keys = f"cert={certificates}/cert.pem&key={certificates}/key.pem"
    with (
        vehicle(f"wssin://127.0.0.1:{port}?{keys}&origin=*&token=open"),
        web_server(tmp_path) as server,
        station_page(browser, server.url, DESKTOP, any_certificate=True) as shown,
    ):
        connect(shown, f"wss://127.0.0.1:{port}?token=open")
        fly(shown)
