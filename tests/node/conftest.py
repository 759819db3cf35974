"""Fixtures of the node tests."""

from __future__ import annotations

import pytest

from tests.node.signed_pair import START


@pytest.fixture
def clock(monkeypatch):
    """Set the time at which nodes are opened from then on."""
    times = {"now": START}
    monkeypatch.setattr("mavstack.node.driver.time", lambda: times["now"])
    return lambda now: times.update(now=now)
