"""Logs as files."""

from __future__ import annotations

import pytest


@pytest.fixture
def written(tmp_path):
    """Return a function that writes a log and returns its path."""

    def write(data):
        path = tmp_path / "flight.ulg"
        path.write_bytes(bytes(data))
        return path

    return write
