"""Fixtures of the tests of logs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from mavstack import open_log
from tests.logs.flights import flight_tlog

if TYPE_CHECKING:
    from pathlib import Path

    from mavstack.logs import Log


@pytest.fixture
def flight(tmp_path: Path) -> Log:
    """Return the log of a short flight."""
    path = tmp_path / "flight.tlog"
    path.write_bytes(flight_tlog())
    return open_log(path, "common")
