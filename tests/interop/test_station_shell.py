"""The frame of the station's page in Chromium: sources, replay in every view, inspection, the keyboard."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from tests.interop.station import DESKTOP, PATIENT, PHONE, StationPage, station_page, web_server

if TYPE_CHECKING:
    from mavstack.sim import BackgroundSimulator

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium"), pytest.mark.timeout(240)]

#: Returns whether the element with the focus has a text.
FOCUSED = "text => document.activeElement.innerText.includes(text)"


def test_sources_are_added_on_the_page(simulator: BackgroundSimulator, browser: Any, tmp_path: Path) -> None:
    with web_server(tmp_path) as server, station_page(browser, server.url, DESKTOP) as shown:
        shown.button("Add a source").click(timeout=PATIENT)
        dialog = shown.page.get_by_role("dialog", name="Sources of the station")
        dialog.get_by_text("The station has no source yet").wait_for(timeout=PATIENT)
        url = dialog.get_by_label("URL of a link")
        url.fill("nonsense://x")
        url.press("Enter")
        # The reason is inside the dialog, which covers the rest of the page.
        dialog.get_by_role("status").get_by_text("unknown scheme 'nonsense'").wait_for(timeout=PATIENT)
        shown.expect_problems("400 (Bad Request)")
        url.fill(f"udpout://127.0.0.1:{simulator.port}")
        url.press("Enter")
        dialog.get_by_text("Connected").wait_for(timeout=PATIENT)
        shown.page.keyboard.press("Escape")
        dialog.wait_for(state="detached", timeout=PATIENT)
        shown.wait_for("Ready to arm")
        shown.page.keyboard.press("l")
        dialog.get_by_role("button", name="Remove udpout").click(timeout=PATIENT)
        dialog.get_by_text("The station has no source yet").wait_for(timeout=PATIENT)


def test_a_replay_has_its_bar_in_every_view(
    simulator: BackgroundSimulator, browser: Any, tmp_path: Path
) -> None:
    link = f"udpout://127.0.0.1:{simulator.port}"
    with web_server(tmp_path, link) as server, station_page(browser, server.url, DESKTOP) as shown:
        shown.wait_for("Ready to arm")
        name = server.post("recordings")["name"]
        file = tmp_path / name
        shown.wait_until(lambda: file.is_file() and file.stat().st_size > 20_000)
        server.post(f"recordings/{name}/stop")
        shown.page.goto(f"{server.url}#/logs")
        shown.button("Replay").click(timeout=PATIENT)
        position = shown.page.get_by_role("slider", name="Time in the recording")
        for view in ("fly", "inspect", "logs"):
            shown.page.goto(f"{server.url}#/{view}")
            position.wait_for(timeout=PATIENT)
        shown.page.goto(f"{server.url}#/fly")
        shown.wait_for("This is a recorded flight")
        assert shown.button("Arm").is_disabled()
        shown.page.set_viewport_size({"width": PHONE[0], "height": PHONE[1]})
        shown.button("End the replay").click()
        position.wait_for(state="detached", timeout=PATIENT)
        shown.wait_until(lambda: shown.button("Arm").is_enabled())


def check_rates(shown: StationPage) -> None:
    """Compare rates with those that the vehicle was asked for."""
    row = shown.page.get_by_role("option", name="HEARTBEAT")
    shown.wait_until(lambda: "1.0 Hz" in row.inner_text())


def test_inspection_searches_pauses_and_plots(
    simulator: BackgroundSimulator, browser: Any, tmp_path: Path
) -> None:
    link = f"udpout://127.0.0.1:{simulator.port}"
    with web_server(tmp_path, link) as server, station_page(browser, server.url, DESKTOP) as shown:
        shown.wait_for("Ready to arm")
        shown.page.goto(f"{server.url}#/inspect")
        check_rates(shown)
        last = shown.page.get_by_role("option").last
        last.scroll_into_view_if_needed()
        search = shown.page.get_by_role("searchbox", name="Find a message")
        assert search.bounding_box()["y"] >= 0
        search.click(timeout=PATIENT)
        search.fill("attitude")
        shown.page.get_by_role("option", name="ATTITUDE").first.click()
        time = shown.page.locator("tr", has_text="time_boot_ms").locator(".number")
        shown.button("Pause the values").click()
        paused = time.inner_text()
        count = shown.page.get_by_text("messages/s").inner_text
        before = count()
        shown.wait_until(lambda: count() != before)
        assert time.inner_text() == paused
        shown.button("Pause the values").click()
        shown.wait_until(lambda: time.inner_text() != paused)
        for field in ("roll", "time_boot_ms"):
            shown.button(f"Plot {field}").click()
        # Units of different sizes have axes of their own.
        shown.wait_until(lambda: shown.page.locator(".u-axis").count() == 3)
        with shown.page.expect_download() as waiting:
            shown.button("CSV").click()
        heading = Path(waiting.value.path()).read_text("utf-8").splitlines()[0]
        assert heading == "time_s,1/1:ATTITUDE.roll,1/1:ATTITUDE.time_boot_ms"


def check_forced_colours(shown: StationPage) -> None:
    """The present view is another colour than the others, also where the system chooses the colours."""
    shown.page.emulate_media(forced_colors="active")
    colours = [
        shown.page.locator(f"nav a[href='#/{view}']").evaluate(
            "link => getComputedStyle(link).backgroundColor"
        )
        for view in ("fly", "plan")
    ]
    assert colours[0] != colours[1]
    shown.page.emulate_media(forced_colors="none")


def test_menus_give_the_focus_back_and_the_view_is_marked(browser: Any, tmp_path: Path) -> None:
    with web_server(tmp_path) as server, station_page(browser, server.url, DESKTOP) as shown:
        shown.page.goto(f"{server.url}?demo=2")
        picker = shown.page.get_by_role("button", name="Choose a vehicle: Copter 1", exact=True)
        picker.wait_for(timeout=PATIENT)
        picker.focus()
        for key in ("Enter", "ArrowDown", "Escape"):
            shown.page.keyboard.press(key)
        assert shown.page.evaluate(FOCUSED, "Copter 1")
        for key in ("Enter", "ArrowDown", "ArrowDown", "Enter"):
            shown.page.keyboard.press(key)
        shown.wait_until(lambda: shown.page.evaluate(FOCUSED, "VTOL 2"))
        check_forced_colours(shown)
        shown.page.set_viewport_size({"width": PHONE[0], "height": PHONE[1]})
        more = shown.button("More").first
        more.click()
        shown.page.keyboard.press("Escape")
        assert more.get_attribute("aria-expanded") == "false"
