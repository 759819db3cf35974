"""Time limits that also end tests with a running event loop.

pytest-timeout raises its failure from a signal handler. An event loop whose callback is interrupted by it
catches the failure, logs it and runs on: it lets only KeyboardInterrupt and SystemExit pass. Therefore the
failure leaves the test as a KeyboardInterrupt, which becomes the failure again outside of the test.

A test that failed is run again, within the same protocol, and both timers end with the first failure. So each
run sets them again.
"""

from __future__ import annotations

import faulthandler
import signal
import sys
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Generator
    from types import FrameType
    from typing import Any

#: The settings of pytest-timeout for a test.
SETTINGS = pytest.StashKey["Any"]()
#: Seconds after which the exception is raised again, if something caught it.
REPETITION_INTERVAL = 10.0
#: Seconds after the limit of a test at which its process ends.
GRACE = 60.0


class TimeLimitExpired(KeyboardInterrupt):
    """The time limit of a test expired."""


@pytest.hookimpl(wrapper=True)
def pytest_timeout_set_timer(item: pytest.Item, settings: Any) -> Generator[None, object, object]:
    """Start the timer of pytest-timeout with the other exception."""
    item.stash[SETTINGS] = settings
    answer = yield
    fail = signal.getsignal(signal.SIGALRM)
    if settings.method == "signal" and callable(fail):

        def expire(number: int, frame: FrameType | None) -> None:
            try:
                fail(number, frame)
            except pytest.fail.Exception as failure:
                raise TimeLimitExpired(str(failure)) from None

        signal.signal(signal.SIGALRM, expire)
        signal.setitimer(signal.ITIMER_REAL, settings.timeout, REPETITION_INTERVAL)
    return answer


def _failing() -> Generator[None, object, object]:
    try:
        return (yield)
    except TimeLimitExpired as expired:
        signal.setitimer(signal.ITIMER_REAL, 0)
        pytest.fail(str(expired))


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> Generator[None, object, object]:
    """Fail a test whose set-up took too long; set the timers of a test that is run again."""
    if SETTINGS in item.stash:
        settings = item.stash[SETTINGS]
        if getattr(item, "execution_count", 1) > 1:
            item.config.hook.pytest_timeout_set_timer(item=item, settings=settings)
        limit = float(item.config.getini("faulthandler_timeout") or 0)
        if limit > 0:  # also for a test whose own limit is longer
            limit = max(limit, settings.timeout + GRACE)
            faulthandler.dump_traceback_later(limit, exit=True, file=sys.__stderr__ or sys.stderr)
    return (yield from _failing())


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_call() -> Generator[None, object, object]:
    """Fail a test that took too long."""
    return (yield from _failing())


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_teardown() -> Generator[None, object, object]:
    """Fail a test whose tear-down took too long."""
    return (yield from _failing())
