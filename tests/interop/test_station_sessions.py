"""The station in Chromium: roles, tickets, logs, a report, a vehicle by MSP, a restarted server."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

import pytest

from mavstack.sim.background_controller import BackgroundFlightController
from tests.interop.station import DESKTOP, PATIENT, StationPage, StationServer, station_page, web_server

if TYPE_CHECKING:
    from mavstack.sim import BackgroundSimulator

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium"), pytest.mark.timeout(240)]

PASSWORDS = "observe may only watch\noperate may also fly\n"
#: Returns the status of a request for arming.
ARM = "fetch('api/vehicles/1/arm', {method: 'POST'}).then(({ status }) => status)"
#: Returns whether a WebSocket opens with a ticket of a wrong signature.
FORGED = """new Promise((resolve) => {
  const ticket = `v2|gs.mavlink_ws|1|31|${'0'.repeat(32)}|${'0'.repeat(64)}`
  const socket = new WebSocket(new URL('ws', location.href), ['ados-ws-ticket', ticket, 'mavstack.raw.1'])
  socket.onopen = () => resolve(true)
  socket.onerror = () => resolve(false)
})"""


def drop_refusals(shown: StationPage) -> None:
    """Drop what Chromium tells of refused requests and lost connections, which are part of the test."""
    shown.expect_problems("Failed to load resource", "WebSocket connection")


def test_observers_and_forged_tickets_are_refused(
    simulator: BackgroundSimulator, browser: Any, tmp_path: Path
) -> None:
    passwords = tmp_path / "passwords.txt"
    passwords.write_text(PASSWORDS, "utf-8")
    link = f"udpout://127.0.0.1:{simulator.port}"
    with (
        web_server(tmp_path, link, "--password", str(passwords)) as server,
        station_page(browser, server.url, DESKTOP) as shown,
    ):
        password = shown.page.get_by_role("textbox", name="Password")
        password.fill("guessed")
        password.press("Enter")
        shown.page.get_by_role("dialog").get_by_role("alert").wait_for(timeout=PATIENT)
        password.fill("may only watch")
        password.press("Enter")
        shown.wait_for("You may watch only")
        assert shown.button("Arm").is_disabled()
        assert shown.page.evaluate(ARM) == 403
        assert shown.page.evaluate(FORGED) is False
        check_set_up_of_observers(shown, server.url)
        drop_refusals(shown)


def check_set_up_of_observers(shown: StationPage, url: str) -> None:
    """Look at the set-up: it says that its values cannot be changed, and no control changes one."""
    shown.page.goto(f"{url}#/setup")
    shown.wait_for("You may look at the set-up, not change it: that needs the role administer.")
    shown.page.get_by_label("Search names and descriptions").fill("RTL_ALT")
    value = shown.page.get_by_label("RTL_ALT", exact=True)
    value.wait_for(timeout=PATIENT)
    assert value.is_disabled()
    sections = shown.page.get_by_role("navigation", name="Set-up")
    sections.get_by_role("button", name="Calibration", exact=True).click()
    start = shown.button("Start: Gyroscope")
    start.wait_for(timeout=PATIENT)
    assert start.is_disabled()


def check_log(shown: StationPage, server: StationServer) -> None:
    """Download the log of a short flight from the vehicle, and open its report."""
    for action in ("arm", "disarm"):
        server.post(f"vehicles/1/{action}")
    shown.page.goto(f"{server.url}#/logs")
    shown.button("List them").click()
    with shown.page.expect_download(timeout=PATIENT) as waiting:
        shown.page.get_by_role("button", name="Download log").first.click(timeout=PATIENT)
    assert Path(waiting.value.path()).read_bytes()[:2] == b"\xa3\x95"
    shown.page.get_by_role("button", name="Report of log").first.click(timeout=PATIENT)
    frame = shown.page.frame_locator("iframe[title^='Report of vehicle-1-log']")
    frame.get_by_text("dataflash").first.wait_for(timeout=PATIENT)
    shown.button("Close").first.click()


def check_report(shown: StationPage, server: StationServer) -> None:
    """Record some seconds and open their report."""
    shown.button("Record").click()
    shown.wait_until(
        lambda: any(each["running"] and each["size"] > 20_000 for each in server.get("recordings"))
    )
    shown.button("Stop").click()
    shown.button("Report").first.click(timeout=PATIENT)
    frame = shown.page.frame_locator("iframe[title^='Report of']")
    frame.locator("h1, h2").first.wait_for(timeout=PATIENT)
    shown.button("Close").first.click()


def check_msp(shown: StationPage, url: str) -> None:
    """Select the vehicle that speaks MSP: nothing that MSP lacks is shown."""
    shown.page.get_by_role("button", name="Choose a vehicle").click()
    shown.page.get_by_role("option", name="Copter 2").click(timeout=PATIENT)
    shown.page.goto(f"{url}#/setup")
    sections = shown.page.get_by_role("navigation", name="Set-up").get_by_role("button")
    shown.wait_until(lambda: "Parameters" in sections.all_inner_texts())
    assert not {"Flight modes", "Failsafes", "Estimator"} & set(sections.all_inner_texts())
    shown.page.goto(f"{url}#/fly")
    shown.wait_for("MSP has no commands for flight")
    assert shown.button("Arm").count() == 0


def test_logs_a_report_msp_and_a_restart(
    simulator: BackgroundSimulator, browser: Any, tmp_path: Path
) -> None:
    with BackgroundFlightController() as controller, ExitStack() as pages:
        links = (f"udpout://127.0.0.1:{simulator.port}", f"{controller.url}?system=2")
        with web_server(tmp_path, *links) as server:
            shown = pages.enter_context(station_page(browser, server.url, DESKTOP))
            shown.wait_for("Ready to arm")
            check_log(shown, server)
            check_report(shown, server)
            check_msp(shown, server.url)
        shown.page.locator(".link:not(.open)").wait_for(timeout=PATIENT)
        with web_server(tmp_path, *links, port=urlsplit(server.url).port or 0):
            shown.page.locator(".link.open").wait_for(timeout=PATIENT)
            shown.page.locator(".picker .dot:not(.lost)").wait_for(timeout=PATIENT)
            shown.wait_for("MSP has no commands for flight")
        drop_refusals(shown)
