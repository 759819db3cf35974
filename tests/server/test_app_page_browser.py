"""The page in a browser: texts of the bar, conflicts of ids, replays of onboard logs, names of buttons."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from contextlib import ExitStack
from urllib.request import Request, urlopen

import pytest

from mavstack.server.app import STATIC
from mavstack.sim.background import BackgroundSimulator
from tests.logs.test_replay import dataflash
from tests.sharing import shared_until_failure
from tools.compilers import find

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium")]
playwright = pytest.importorskip("playwright.sync_api")

SENDERS = ("udpin 127.0.0.1:40001", "udpin 127.0.0.1:40002")


@shared_until_failure
def station(folder):
    """`mav web` with two simulated copters; its URL."""
    if not (STATIC / "index.html").is_file():
        pytest.skip("the pages are not built")
    (folder / "flight.BIN").write_bytes(dataflash())
    with ExitStack() as steps:
        copters = steps.enter_context(BackgroundSimulator("copter", count=2))
        options = ["--port", "0", "--json", "--no-browser", "--folder", str(folder)]
        command = [sys.executable, "-m", "mavstack", "web", copters.url, *options]
        process = steps.enter_context(subprocess.Popen(command, stdout=subprocess.PIPE, text=True))
        steps.callback(process.terminate)
        yield json.loads(process.stdout.readline())["url"]


@pytest.fixture(scope="module")
def browser():
    path = find("chromium")
    if path is None:
        pytest.skip("no Chromium")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=path, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture
def page(browser, station):
    context = browser.new_context(viewport={"width": 1440, "height": 900}, color_scheme="dark")
    page = context.new_page()
    page.goto(f"{station}#/fly")
    playwright.expect(page.get_by_role("button", name="Choose a vehicle")).to_contain_text(
        "Copter 1", timeout=20_000
    )
    yield page
    context.close()


def act(station: str, path: str) -> None:
    headers = {"Content-Type": "application/json"}
    urlopen(Request(f"{station}api/{path}", b"{}", headers=headers), timeout=30).close()


def test_the_bar_shows_one_vehicle_and_texts_of_before(station, browser, page) -> None:
    act(station, "vehicles/2/arm")
    page.locator("header").get_by_role("button", name="Messages", exact=True).click()
    messages = page.get_by_role("complementary", name="Messages").get_by_role("log")
    playwright.expect(messages).to_contain_text("Arming motors", timeout=20_000)
    # The bar is about copter 1, which may have sent no text yet.
    playwright.expect(page.locator("header .latest", has_text="Arming motors")).to_have_count(0)
    page.get_by_role("button", name="Choose a vehicle").click()
    page.get_by_role("option", name="Copter 2").click()
    playwright.expect(page.locator("header .latest")).to_have_text(re.compile("Arming motors"))
    # A page that is opened later shows them too.
    later = browser.new_context().new_page()
    later.goto(f"{station}#/fly")
    later.locator("header").get_by_role("button", name="Messages", exact=True).click(timeout=20_000)
    playwright.expect(later.get_by_role("complementary", name="Messages").get_by_role("log")).to_contain_text(
        "Arming motors", timeout=20_000
    )
    later.context.close()


def test_every_button_of_the_bar_has_a_name(page) -> None:
    buttons = page.locator("header >> css=button")
    names = [re.search(r'button "(.+?)"', each.aria_snapshot()) for each in buttons.all()]
    assert len(names) >= 4
    assert all(names)


def conflict(chosen: str | None) -> dict:
    senders = [
        {"channel": channel, "type": "quadrotor with ArduPilot", "unique_id": None, "position": None}
        for channel in SENDERS
    ]
    text = f"two vehicles use system id 1: {SENDERS[0]}; {SENDERS[1]}"
    return {"text": text, "differs": ["position"], "senders": senders, "chosen": chosen}


def test_a_conflict_of_ids_refuses_actions_until_a_sender_is_chosen(page) -> None:
    state = {"chosen": None}
    asked = []

    def vehicles(route) -> None:
        answer = route.fetch().json()
        answer[0]["conflict"] = conflict(state["chosen"])
        route.fulfill(json=answer)

    def choose(route) -> None:
        state["chosen"] = route.request.post_data_json["channel"]
        asked.append(route.request.method)
        route.fulfill(json={"system": 1, "capabilities": {}, "conflict": conflict(state["chosen"])})

    page.route("**/api/vehicles", vehicles)
    page.route("**/api/vehicles/1/sender", choose)
    alarm = page.get_by_role("region", name="Alerts")
    playwright.expect(alarm).to_contain_text("Two vehicles use system id 1", timeout=20_000)
    arm = page.get_by_role("button", name="Arm", exact=True)
    playwright.expect(arm).to_be_disabled()
    notice = page.get_by_role("region", name="Two vehicles with one system id")
    playwright.expect(notice).to_contain_text(SENDERS[1])
    notice.get_by_role("button", name="Use this one").nth(1).click()
    playwright.expect(arm).to_be_enabled()
    assert (state["chosen"], asked) == (SENDERS[1], ["POST"])
    playwright.expect(notice).to_contain_text("in use")


def test_an_onboard_log_is_replayed(page, station) -> None:
    page.goto(f"{station}#/logs")
    recorded = page.get_by_role("row", name=re.compile("flight.BIN"))
    recorded.get_by_role("button", name="Replay").click(timeout=20_000)
    bar = page.get_by_role("region", name="Replay of flight.BIN")
    playwright.expect(bar).to_be_visible(timeout=20_000)
    playwright.expect(page.locator("header .facts")).to_contain_text("STABILIZE", timeout=20_000)
    bar.get_by_role("button", name="End the replay").click()
    # A file of this computer.
    files = [{"name": "own.BIN", "mimeType": "", "buffer": dataflash()}]
    page.locator("section.logs input[type=file]").set_input_files(files)
    playwright.expect(page.get_by_role("region", name="Replay of own.BIN")).to_be_visible(timeout=20_000)
