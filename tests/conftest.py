"""Shared test configuration: tiers, property tests without deadlines, and the seeds of randomised tests."""

from __future__ import annotations

import gc
import signal
from collections import Counter, defaultdict
from typing import TYPE_CHECKING

import pytest
from hypothesis import is_hypothesis_test, settings

from tests.seeds import REPORT, Seeds, blocks_of
from tests.sharing import pytest_runtest_makereport  # noqa: F401 (hook)
from tests.tiers import check_that_files_name_tiers
from tests.time_limits import (  # noqa: F401 (hooks)
    pytest_runtest_call,
    pytest_runtest_setup,
    pytest_runtest_teardown,
    pytest_timeout_set_timer,
)
from tools.child_processes import end_children_with_this_process

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

settings.register_profile("fast", deadline=None, max_examples=30)
settings.register_profile("thorough", deadline=None, max_examples=1000)
settings.load_profile("fast")


#: The tier of the cases of a matrix beyond the first ones, by the marker that says how many these are.
TIERS_OF_MATRICES = {"fast_cases": pytest.mark.flight, "flight_cases": pytest.mark.nightly}


def pytest_configure() -> None:
    """Have children end with the tests, and handle SIGINT.

    The programs of a background job of a shell would inherit that SIGINT is ignored.
    """
    end_children_with_this_process(handle_signals=False)
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("seeds")
    group.addoption("--seeds", type=int, default=300, help="how many seeds each randomised test runs")
    group.addoption("--seed", type=int, default=None, help="run randomised tests over this seed alone")


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    if "seeds" in metafunc.fixturenames:
        metafunc.parametrize("seeds", blocks_of(metafunc.config), indirect=True, ids=str)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    counts: Counter[tuple[str, str]] = Counter()
    for item in items:
        for name, later in TIERS_OF_MATRICES.items():
            if marker := item.get_closest_marker(name):
                test = item.nodeid.partition("[")[0]
                counts[name, test] += 1
                if counts[name, test] > marker.args[0]:
                    item.add_marker(later)
        if is_hypothesis_test(getattr(item, "obj", None)):
            item.add_marker(pytest.mark.properties)
        if "seeds" in getattr(item, "fixturenames", ()):
            item.add_marker(pytest.mark.seeds)
        if item.get_closest_marker("interop"):
            # External programs have timeouts in real time, which expire on a busy machine.
            item.add_marker(pytest.mark.flaky(reruns=2))
    check_that_files_name_tiers(items)
    items.sort(key=lambda item: item.get_closest_marker("long") is None)


def pytest_collection_finish() -> None:
    """Keep the garbage collector away from the thousands of collected tests, which live to the end."""
    gc.collect()
    gc.freeze()


def pytest_sessionfinish() -> None:
    """Free what DuckDB made: at exit it reports objects that the collector keeps as leaks."""
    gc.unfreeze()
    gc.collect()


@pytest.fixture(autouse=True, scope="session")
def user_cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Keep the cache folder of the user out of the tests."""
    folder = tmp_path_factory.mktemp("cache")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("mavstack.files.parameter_metadata.cache.cache_directory", lambda: folder)
        yield folder


@pytest.fixture
def seeds(request: pytest.FixtureRequest) -> Seeds:
    return Seeds(request.param, request.node)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    totals: dict[str, list[float]] = defaultdict(lambda: [0, 0.0])
    for report in terminalreporter.getreports("passed"):
        for name, value in report.user_properties:
            if name == REPORT and report.when == "call":
                total = totals[report.nodeid.partition("[")[0]]
                total[0], total[1] = total[0] + value[0], total[1] + value[1]
    for test, (number, seconds) in sorted(totals.items()):
        rate = 60 * number / max(seconds, 1e-9)
        terminalreporter.write_line(f"{test}: {number:.0f} seeds, {rate:,.0f} seeds/minute")
