"""The generator form in Chromium: the commands of official dialects and of the user's own file."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any
from zipfile import ZipFile

import pytest

from tests.interop.station import DESKTOP, PATIENT, chromium, station_page, web_server

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("chromium"), pytest.mark.timeout(240)]

DEFINITION = """<mavlink><include>%s</include><version>3</version><messages>
<message id="180" name="MY_VALUE"><description>A value.</description>
<field type="uint8_t" name="value">The value.</field></message></messages></mavlink>"""


def test_commands_and_libraries_are_those_of_the_chosen_file(tmp_path: Path) -> None:
    own, refused = tmp_path / "my_ship.xml", tmp_path / "refused.xml"
    own.write_text(DEFINITION % "minimal.xml", "utf-8")
    refused.write_text(DEFINITION % "/etc/passwd", "utf-8")
    with (
        web_server(tmp_path) as server,
        chromium() as browser,
        station_page(browser, server.url, DESKTOP) as shown,
    ):
        page: Any = shown.page
        page.goto(f"{server.url}#/generator")
        page.get_by_label("C99").check(timeout=PATIENT)
        commands, file = page.locator("pre"), page.locator("input[type=file]")
        commands.get_by_text("mav gen c common -o mavlink").wait_for(timeout=PATIENT)
        file.set_input_files(str(own))
        commands.get_by_text("mav gen c my_ship.xml -o mavlink").wait_for(timeout=PATIENT)
        with page.expect_download(timeout=PATIENT) as waiting:
            page.get_by_role("button", name="Generate").click()
        names = ZipFile(waiting.value.path()).namelist()
        assert any("my_value" in name for name in names), json.dumps(names)

        shown.button("Use an official dialect").click()
        commands.get_by_text("mav gen c common -o mavlink").wait_for(timeout=PATIENT)
        file.set_input_files(str(refused))
        page.get_by_role("alert").get_by_text("only official definitions can be included").wait_for(
            timeout=PATIENT
        )
        assert commands.count() == 0
        assert page.get_by_role("button", name="Generate").is_disabled()
        shown.expect_problems("400 (Bad Request)")
