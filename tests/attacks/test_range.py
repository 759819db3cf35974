"""The range of the attack suite: packets that should come are waited for."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from tools.attacks.range import Range


@pytest.fixture
def field():
    """A range whose vehicle gets a command, nothing for a while, and another command with a heartbeat."""
    command, heartbeat = SimpleNamespace(name="COMMAND_LONG"), SimpleNamespace(name="HEARTBEAT")
    arrivals = iter([[command], [], [command, heartbeat]])
    made = object.__new__(Range)
    made.vehicle = SimpleNamespace(receive=lambda: next(arrivals))
    return made


def test_expected_packets_that_come_late_are_counted(field):
    assert field.passed(2) == 2


def test_nothing_more_is_waited_for_where_no_packet_should_come(field):
    assert field.passed() == 1
