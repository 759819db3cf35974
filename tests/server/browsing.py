"""Stations and pages in Chromium, for tests of the page."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import pytest

from mavstack.server.app import STATIC
from tools.compilers import find

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

DESKTOP = {"width": 1440, "height": 900}
PHONE = {"width": 390, "height": 844}
#: Milliseconds: a busy machine draws slowly.
PATIENT = 30_000


@contextmanager
def web_station(folder: Path, *words: str) -> Iterator[str]:
    """Run `mav web` with these sources and options; yield its URL."""
    if not (STATIC / "index.html").is_file():
        pytest.skip("the pages are not built")
    options = ["--port", "0", "--json", "--no-browser", "--folder", str(folder)]
    command = [sys.executable, "-m", "mavstack", "web", *words, *options]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            yield json.loads(process.stdout.readline())["url"]
        finally:
            process.terminate()


#: Refused requests, which Chromium logs as errors.
REFUSED = re.compile("status of (400|409)")


def is_problem(message: Any, refused: re.Pattern[str] = REFUSED) -> bool:
    """Return whether a line of the console is an error that the test does not expect."""
    return bool(message.type == "error") and not refused.search(message.text)


@contextmanager
def open_pages(refused: re.Pattern[str] = REFUSED) -> Iterator[Any]:
    """Run Chromium; yield a function that opens a page, whose consoles must be free of errors in the end.

    Args:
        refused: Errors of the console that the test expects.
    """
    path = find("chromium")
    if path is None:
        pytest.skip("no Chromium")
    playwright = pytest.importorskip("playwright.sync_api")
    problems: list[str] = []
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=path, args=["--no-sandbox"])

        def new_page(url: str, *, phone: bool = False, dark: bool = True) -> Any:
            scheme = "dark" if dark else "light"
            page = browser.new_context(
                viewport=PHONE if phone else DESKTOP, color_scheme=scheme, has_touch=phone
            ).new_page()
            page.on("console", lambda each: problems.append(each.text) if is_problem(each, refused) else None)
            page.on("pageerror", lambda error: problems.append(str(error)))
            page.set_default_timeout(PATIENT)
            page.goto(url)
            return page

        yield new_page
        browser.close()
    assert problems == [], "\n".join(problems)


def hold(page: Any, button: Any, milliseconds: int = 900) -> None:
    """Hold a button that must be held."""
    button.scroll_into_view_if_needed()
    button.focus()
    page.keyboard.down("Enter")
    page.wait_for_timeout(milliseconds)
    page.keyboard.up("Enter")
