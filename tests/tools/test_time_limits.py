"""Time limits end tests whatever runs in them."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

pytest_plugins = ["pytester"]

HEAD = "import asyncio, time, pytest\npytestmark = pytest.mark.timeout(0.3)\n"
HOOKS = """
from tests.time_limits import (
    pytest_runtest_call, pytest_runtest_setup, pytest_runtest_teardown, pytest_timeout_set_timer
)
"""
TESTS = {
    "a callback of a loop whose test waits": """
def test_it():
    async def wait():
        loop = asyncio.get_running_loop()
        def again():
            time.sleep(0.01)
            loop.call_soon(again)
        again()
        await loop.create_future()
    asyncio.run(wait())
""",
    "a task beside the test": """
def test_it():
    async def spin():
        while True:
            time.sleep(0.01)
            await asyncio.sleep(0)
    async def wait():
        task = asyncio.create_task(spin())
        await asyncio.get_running_loop().create_future()
    asyncio.run(wait())
""",
    "an exception that is caught": """
def test_it():
    while True:
        try:
            time.sleep(5)
        except Exception:
            pass
""",
    "a fixture": """
@pytest.fixture
def slow():
    time.sleep(5)
def test_it(slow):
    pass
""",
}
OPTIONS = ("-p", "no:cacheprovider", "-p", "no:xdist", "-p", "no:asyncio")


@pytest.mark.parametrize("program", TESTS.values(), ids=TESTS)
def test_a_test_fails_at_its_limit_and_the_next_one_runs(
    pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch, program: str
) -> None:
    pytester.makeconftest(HOOKS)
    pytester.makepyfile(HEAD + program + "\ndef test_next():\n    pass\n")
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parents[2]), prepend=os.pathsep)
    result = pytester.runpytest_subprocess(*OPTIONS)
    outcomes = result.parseoutcomes()
    assert outcomes.get("passed") == 1
    assert outcomes.get("failed", 0) + outcomes.get("errors", 0) == 1
    result.stdout.fnmatch_lines(["*Timeout*"])


def test_a_test_that_is_run_again_has_its_limit_again(
    pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytester.makeconftest(HOOKS)
    pytester.makepyfile(HEAD + "def test_it():\n    time.sleep(30)\n")
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parents[2]), prepend=os.pathsep)
    result = pytester.runpytest_subprocess(*OPTIONS, "--reruns", "1", timeout=60)
    assert result.parseoutcomes() == {"failed": 1, "rerun": 1}


def test_a_longer_limit_of_a_test_outlasts_the_limit_of_the_process(
    pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytester.makeconftest(HOOKS)
    pytester.makeini("[pytest]\nfaulthandler_timeout = 0.2\nfaulthandler_exit_on_timeout = true\n")
    pytester.makepyfile("import time, pytest\n@pytest.mark.timeout(9)\ndef test_it():\n    time.sleep(0.5)\n")
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parents[2]), prepend=os.pathsep)
    result = pytester.runpytest_subprocess(*OPTIONS, timeout=60)
    assert result.parseoutcomes() == {"passed": 1}
