from __future__ import annotations

import sys

import pytest
from textual.widgets import Button, Input, RichLog, SelectionList, Static

from mavstack.cli.gen.window import GenerationWindow
from mavstack.codegen.form import GenerationForm

pytestmark = pytest.mark.usefixtures("plugins")
SIZE = (110, 44)


def results(app: GenerationWindow) -> str:
    """Return the results without line breaks."""
    return " ".join(word for line in app.query_one("#results", RichLog).lines for word in line.text.split())


async def test_a_library_is_generated_from_the_keyboard(tmp_path):
    app = GenerationWindow(GenerationForm("minimal"))
    async with app.run_test(size=SIZE) as pilot:
        assert app.query_one("#generate", Button).disabled
        app.query_one("#folder", Input).value = str(tmp_path)
        app.query_one("#choice", SelectionList).select("text")
        await pilot.pause()
        assert app.form == GenerationForm("minimal", ("text",), str(tmp_path))
        assert str(app.query_one("#commands", Static).render()) == f"mav gen text minimal -o {tmp_path}"
        await pilot.press("ctrl+g")
        await app.workers.wait_for_complete()
        await pilot.pause()
        assert "2 files, 3 changed" in results(app)
        await pilot.click("#check")
        await app.workers.wait_for_complete()
        await pilot.pause()
        assert "up to date" in results(app)
    assert (tmp_path / "README.md").is_file()


async def test_problems_are_beside_their_entries():
    app = GenerationWindow(GenerationForm("comon", ("text",), "out", only="HEARTBEAT"))
    async with app.run_test(size=SIZE) as pilot:
        assert "comon" in str(app.query_one("#dialect-problem", Static).render())
        assert not app.query_one("#only-problem", Static).display
        await pilot.press("ctrl+g")
        assert results(app) == ""
        app.query_one("#dialect", Input).value = "common"
        app.query_one("#only", Input).value = "NO_SUCH"
        await pilot.pause()
        assert not app.query_one("#dialect-problem", Static).display
        assert "no message matches" in str(app.query_one("#only-problem", Static).render())


async def test_errors_are_results(tmp_path):
    (tmp_path / "README.md").write_text("mine")
    app = GenerationWindow(GenerationForm("minimal", ("text",), str(tmp_path)))
    async with app.run_test(size=SIZE) as pilot:
        await pilot.click("#generate")
        await app.workers.wait_for_complete()
        await pilot.pause()
        assert "was not generated: choose another folder" in results(app)


def test_the_form_needs_a_terminal(mav):
    result = mav("gen", "--ui")
    assert (result.code, result.err) == (2, "mav gen: --ui needs a terminal\n")


def test_without_textual_the_extra_is_named(mav, monkeypatch):
    monkeypatch.setitem(sys.modules, "mavstack.cli.gen.window", None)
    for stream in (sys.stdin, sys.stdout):
        monkeypatch.setattr(stream, "isatty", lambda: True, raising=False)
    result = mav("gen", "--ui")
    assert "pip install 'mavstack[tui]'" in result.err
