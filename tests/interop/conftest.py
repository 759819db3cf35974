"""The browser and the station of the tests of pages."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from mavstack.sim import BackgroundSimulator
from tests.interop.station import StationServer, chromium, station_server
from tests.sharing import shared_until_failure
from tests.sim.running import make_ready

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """A browser of the module: one that has shown many pages is slower."""
    with chromium() as opened:
        yield opened


@pytest.fixture
def simulator() -> Iterator[BackgroundSimulator]:
    """A copter that is ready to fly."""
    running = BackgroundSimulator()
    make_ready(running.simulation)
    with running:
        yield running


@pytest.fixture
def server(tmp_path: Path) -> Iterator[StationServer]:
    """A station with a simulated copter that is ready to fly, for a test that changes the vehicle."""
    with station_server(tmp_path) as running:
        yield running


@shared_until_failure
def seen_server(folder: Path) -> Iterator[StationServer]:
    """A station with a simulated copter, for tests that leave the vehicle as it is."""
    with station_server(folder) as running:
        yield running
