"""Fixtures that are shared until a test fails."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pytest

pytest_plugins = ["pytester"]

CONFTEST = "from tests.sharing import pytest_runtest_makereport\n"
TESTS = """
import pytest
from tests.sharing import shared_until_failure

made, ended = [], []

@shared_until_failure
def world(folder):
    assert not list(folder.iterdir())
    made.append(folder)
    yield len(made)
    ended.append(len(made))

def test_first(world):
    assert world == 1

@pytest.mark.flaky(reruns=1)
def test_second_fails_once(world):
    assert world == 2

def test_third_shares_the_new_one(world):
    assert (world, ended) == (2, [1])
"""
THEN = """
from test_shared import ended

def test_the_module_ended():
    assert ended == [1, 2]
"""


def test_a_failure_ends_what_is_shared(pytester: pytest.Pytester) -> None:
    pytester.makeconftest(CONFTEST)
    pytester.makepyfile(test_shared=TESTS, test_then=THEN)
    result = pytester.runpytest_inprocess("-p", "no:xdist", "-p", "no:asyncio")
    result.assert_outcomes(passed=4)
    assert "1 rerun" in result.stdout.str()
