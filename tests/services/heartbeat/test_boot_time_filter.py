"""Boot time filter: messages that only continue the last one are skipped, and nothing is missed by that."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.services.heartbeat import ComponentLost, ComponentRebooted, Discovery
from mavstack.services.heartbeat.boot_time_filter import INTERVAL, BootTimeFilter
from mavstack.wire import Packet, encode
from tests.services.network import GROUND, START, VEHICLE


def packet(message) -> Packet:
    return Packet(encode(message, system=VEHICLE.system, component=VEHICLE.component), common)


def attitude(seconds: float) -> Packet:
    return packet(common.Attitude(time_boot_ms=round(1000 * seconds)))


def discovery_with_vehicle() -> Discovery:
    """A discovery with one vehicle that booted 50 s ago."""
    discovery = Discovery(GROUND)
    discovery.receive(packet(common.Heartbeat(type=2, autopilot=3)), START)
    assert discovery.receive(attitude(50), START) is not False
    discovery.events()
    return discovery


@pytest.mark.parametrize(
    ("boot", "later", "expected"),
    [
        (50.02, 0.02, True),
        (50.0, 0.05, True),
        (50.02, INTERVAL, False),
        (0.3, 0.02, False),
        (58.0, 0.02, False),
    ],
)
def test_fitting_boot_time_is_expected_until_the_interval_ends(
    boot: float, later: float, expected: bool
) -> None:
    assert BootTimeFilter(50_000, START).is_expected(round(boot * 1000), START + later) is expected


def test_expected_message_reports_no_change() -> None:
    discovery = discovery_with_vehicle()
    assert discovery.receive(attitude(50.05), START + 0.05) is False
    assert discovery.receive(attitude(50.2), START + 0.2) is not False
    assert discovery.next_timeout() == START + 5


def test_silence_counts_from_the_last_skipped_message() -> None:
    discovery = discovery_with_vehicle()
    assert discovery.receive(attitude(50.09), START + 0.09) is False
    discovery.handle_timeout(START + 5)
    assert discovery.events() == []
    assert discovery.next_timeout() == START + 5.09
    discovery.handle_timeout(START + 5.09)
    assert [type(event) for event in discovery.events()] == [ComponentLost]
    assert discovery.components[VEHICLE].last_seen == START + 0.09
    assert discovery.receive(attitude(55.1), START + 5.1) is not False  # it is back


def test_skipped_messages_are_only_looked_up_when_heartbeats_are_missing() -> None:
    discovery, looks = discovery_with_vehicle(), []
    discovery.filters.before_reading = lambda: looks.append(None)
    for second in range(1, 20):
        discovery.receive(packet(common.Heartbeat(type=2, autopilot=3)), START + second)
        discovery.handle_timeout(START + second)
    assert not looks
    discovery.handle_timeout(START + 24)
    assert looks


def test_reboot_between_two_analysed_messages_is_found() -> None:
    discovery = discovery_with_vehicle()
    for tenth in range(1, 100):
        discovery.receive(attitude(50 + tenth / 100), START + tenth / 100)
    for tenth in range(100):
        discovery.receive(attitude(0.5 + tenth / 100), START + 3 + tenth / 100)
    assert [type(event) for event in discovery.events()] == [ComponentRebooted]
