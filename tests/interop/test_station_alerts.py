"""Alerts of the fly view in Chromium: a fence is left, traffic is near, satellites are lost."""

from __future__ import annotations

import socket
from functools import partial
from typing import TYPE_CHECKING, Any

import pytest

from mavstack.dialects import common
from mavstack.sim import BackgroundSimulator
from mavstack.wire import Encoder
from tests.interop.station import DESKTOP, PATIENT, station_page, web_server
from tests.links.test_tcp import free_port

if TYPE_CHECKING:
    from pathlib import Path

    from tests.interop.station import StationPage

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium"), pytest.mark.timeout(240)]

#: By firmware: parameters of a fence below the vehicle, and what the page tells of it.
FENCES = {
    "ardupilot": ({"FENCE_TYPE": 1, "FENCE_ALT_MAX": 5, "FENCE_ENABLE": 1}, "Beyond the fence"),
    "px4": ({"GF_ACTION": 1, "GF_MAX_VER_DIST": 5}, "Geofence: exceeding maximum altitude above Home"),
}
ADSB_COMPONENT = 156
#: Metres above the vehicle.
ABOVE = 60


def show_traffic(shown: StationPage, position: dict[str, float], port: int) -> None:
    """Let a receiver of the vehicle tell an aircraft 330 m north of it, until the page alerts."""
    aircraft = common.AdsbVehicle(
        ICAO_address=42,
        lat=round((position["latitude"] + 0.003) * 1e7),
        lon=round(position["longitude"] * 1e7),
        altitude=round((position["altitude"] + ABOVE) * 1000),
        altitude_type=common.AdsbAltitudeType.GEOMETRIC,
        callsign="HELI42",
        flags=common.AdsbFlags.VALID_COORDS
        | common.AdsbFlags.VALID_ALTITUDE
        | common.AdsbFlags.VALID_CALLSIGN,
    )
    encoder = Encoder(1, ADSB_COMPONENT)
    text = shown.page.get_by_role("region", name="Alerts").get_by_text("Traffic HELI42")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:

        def is_alerted() -> bool:
            receiver.sendto(encoder.encode(aircraft), ("127.0.0.1", port))
            return bool(text.count())

        shown.wait_until(is_alerted)
    assert "60 m above" in text.inner_text()


@pytest.mark.parametrize("firmware", FENCES)
@pytest.mark.flight_cases(1)
def test_a_pilot_is_alerted(firmware: str, browser: Any, tmp_path: Path) -> None:
    simulator = BackgroundSimulator(firmware=firmware, airborne=True)
    parameters, fence = FENCES[firmware]
    port = free_port()
    with simulator:
        sources = (f"udpout://127.0.0.1:{simulator.port}", f"udpin://127.0.0.1:{port}")
        with web_server(tmp_path, *sources) as server, station_page(browser, server.url, DESKTOP) as shown:
            alerts = shown.page.get_by_role("region", name="Alerts")
            shown.page.locator(".column").get_by_text("in the air").wait_for(timeout=PATIENT)
            assert alerts.get_by_text(fence).count() == 0
            vehicle = simulator.vehicle
            for name, value in parameters.items():
                simulator.call(partial(vehicle.parameters.set, name, value))
            alerts.get_by_text(fence).wait_for(timeout=PATIENT)
            show_traffic(shown, server.state()["position"], port)
            simulator.call(lambda: vehicle.faults.inject("gps off"))
            alerts.get_by_text("GPS lost in flight").wait_for(timeout=PATIENT)
