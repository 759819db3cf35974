"""The views in Chromium, checked by axe-core: desktop and phone, dark and light."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from tests.interop.station import DESKTOP, PATIENT, PHONE, chromium, web_server
from tests.interop.test_station_controls import FIRMWARES, READY, vehicle_of

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium"), pytest.mark.timeout(300)]

AXE = Path(__file__).parents[2] / "web" / "node_modules" / "axe-core" / "axe.min.js"
VIEWS = ("fly", "plan", "setup", "inspect", "logs", "dashboards", "router", "generator", "swarm", "msp")
SECTIONS = (
    "Calibration",
    "Flight modes",
    "Receiver",
    "Battery",
    "Failsafes",
    "Motors and outputs",
    "Tuning",
    "Estimator",
)
#: The forms of a dashboard that is edited.
FORMS = ("Scripts", "Decoders", "Sources")
#: Messages, settings, keyboard shortcuts and sources by their keys.
OVERLAYS = ("m", ",", "?", "l")
VIOLATIONS = """async (rules) => {
  const options = rules === null ? {} : { runOnly: { type: 'rule', values: rules } }
  const { violations } = await axe.run(document, { resultTypes: ['violations'], ...options })
  return violations
    .flatMap(({ id, nodes }) => nodes.map(({ target }) => `${id}: ${target.join(' ')}`))
}"""
#: Maps and instruments that are drawn sixty times a second take the time of the checks.
SLOW_FRAMES = """
requestAnimationFrame = draw => setTimeout(() => draw(performance.now()), 250)
cancelAnimationFrame = clearTimeout
"""
#: Rules whose results depend on the theme.
CONTRAST = ["color-contrast"]


def check_appearances(page: Any, problems: dict[str, list[str]], view: str) -> None:
    """Check what the page shows on both screens in both themes."""
    for size in (DESKTOP, PHONE):
        page.set_viewport_size({"width": size[0], "height": size[1]})
        for theme in ("dark", "light"):
            page.emulate_media(color_scheme=theme)
            page.wait_for_function("theme => document.documentElement.dataset.theme === theme", arg=theme)
            rules = None if theme == "dark" else CONTRAST
            problems[f"{view}, {size[0]} pixels, {theme}"] = page.evaluate(VIOLATIONS, rules)
    page.set_viewport_size({"width": DESKTOP[0], "height": DESKTOP[1]})


def change_parameter(page: Any) -> None:
    """Change the first parameter, so that it has an undo."""
    value = page.locator(".parameter input[type=number]").first
    value.fill(str(float(value.input_value(timeout=PATIENT)) + 1))
    value.press("Enter")
    page.get_by_role("button", name="Undo").wait_for(timeout=PATIENT)


def check_forms(page: Any, problems: dict[str, list[str]]) -> None:
    """Check the forms of a dashboard, each with an entry."""
    page.get_by_role("button", name="Edit", exact=True).click()
    for name in FORMS:
        page.get_by_role("button", name=name, exact=True).click()
        add = page.get_by_role("button", name=re.compile("^Add a (script|decoder)$"))
        if add.count():
            add.click()
        check_appearances(page, problems, name)
        page.get_by_role("button", name="Cancel", exact=True).click()
    page.get_by_role("button", name="Done", exact=True).click()


def open_checked_page(browser: Any, url: str, ready: str) -> Any:
    """Return a page with axe that shows a vehicle."""
    if not AXE.is_file():
        pytest.skip("axe-core is not installed: npm ci in web")
    # Colours that change slowly would be measured half way.
    page = browser.new_context(bypass_csp=True, reduced_motion="reduce").new_page()
    page.add_init_script(SLOW_FRAMES)
    page.goto(url)
    page.locator(ready).first.wait_for(timeout=PATIENT)
    page.add_script_tag(path=str(AXE))
    return page


@pytest.mark.nightly
@pytest.mark.parametrize("firmware", FIRMWARES)
def test_all_sections_with_a_station_have_no_violations(firmware: str, tmp_path: Path) -> None:
    """The pages that only a station has, and the panels of payloads."""
    problems: dict[str, list[str]] = {}
    with vehicle_of(firmware) as vehicle, web_server(tmp_path, vehicle.url) as server, chromium() as browser:
        page = open_checked_page(browser, f"{server.url}#/fly", READY)
        for closed in page.locator("main button[aria-expanded=false]").all()[::-1]:
            closed.click()
        check_appearances(page, problems, "fly")
        page.goto(f"{server.url}#/setup")
        sections = page.get_by_role("navigation", name="Set-up").get_by_role("button")
        sections.first.wait_for(timeout=PATIENT)
        for name in sections.all_inner_texts():
            page.set_viewport_size({"width": DESKTOP[0], "height": DESKTOP[1]})
            sections.get_by_text(name, exact=True).click()
            page.wait_for_load_state("networkidle")
            check_appearances(page, problems, name)
    assert {place: found for place, found in problems.items() if found} == {}


@pytest.mark.nightly
def test_views_have_no_violations(tmp_path: Path) -> None:
    problems: dict[str, list[str]] = {}
    with web_server(tmp_path) as server, chromium() as browser:
        # The vehicle with the lowest system id is selected, whichever is heard first.
        page = open_checked_page(
            browser, f"{server.url}?demo=2", "button:has-text('Choose a vehicle: Copter 1')"
        )
        picker = page.get_by_role("button", name="Choose a vehicle: Copter 1", exact=True)
        for view in VIEWS:
            page.goto(f"{server.url}?demo=2#/{view}")
            page.locator(f"nav a[href='#/{view}'][aria-current=page]").first.wait_for(timeout=PATIENT)
            page.wait_for_load_state("networkidle")
            check_appearances(page, problems, view)
            if view == "setup":
                change_parameter(page)
                problems["a changed parameter"] = page.evaluate(VIOLATIONS)
            for section in SECTIONS if view == "setup" else ():
                page.get_by_role("button", name=section, exact=True).click()
                problems[section] = page.evaluate(VIOLATIONS)
            if view == "dashboards":
                check_forms(page, problems)
        for key in OVERLAYS:
            page.keyboard.press(key)
            problems[f"key {key}"] = page.evaluate(VIOLATIONS)
            page.keyboard.press("Escape")
        picker.click()
        problems["vehicles"] = page.evaluate(VIOLATIONS)
    assert {place: found for place, found in problems.items() if found} == {}
