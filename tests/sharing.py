"""Fixtures that the tests of a module share until one of them fails; a rerun gets a new one."""

from __future__ import annotations

from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterator
    from pathlib import Path

#: Whether the running test has failed.
FAILED = pytest.StashKey[bool]()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Keep whether the set-up or the call of a test failed, for its fixtures."""
    report = yield
    if call.when == "setup":
        item.stash[FAILED] = report.failed
    elif call.when == "call":
        item.stash[FAILED] = item.stash.get(FAILED, False) or report.failed
    return report


class _Shared:
    """A value with the steps that end it."""

    def __init__(self) -> None:
        self.steps = ExitStack()
        self.values: list[Any] = []


def shared_until_failure(make: Callable[[Path], Iterator[Any]]) -> Any:
    """Make a fixture whose value the tests of a module share until one of them fails.

    Args:
        make: A generator that takes an empty folder, and yields the value; its name is that of the fixture.

    Returns:
        The fixture.
    """
    opened, key = contextmanager(make), pytest.StashKey[_Shared]()

    @pytest.fixture(name=make.__name__)
    def share(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
        module = request.node.getparent(pytest.Module)
        shared = module.stash.setdefault(key, _Shared())
        if not shared.values:
            folder = tmp_path_factory.mktemp(make.__name__)
            shared.values.append(shared.steps.enter_context(opened(folder)))
            module.addfinalizer(lambda: _close(shared))
        yield shared.values[0]
        if request.node.stash[FAILED]:
            _close(shared)

    return share


def _close(shared: _Shared) -> None:
    shared.values.clear()
    shared.steps.close()
