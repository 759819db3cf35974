"""Signs of life that tell nothing new are not looked at, and nothing is missed by that."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.services.heartbeat import ComponentLost, ComponentRebooted, Discovery
from mavstack.services.heartbeat.pulse import MOMENT, Pulse
from mavstack.wire import Packet, encode
from tests.services.network import GROUND, START, VEHICLE


def packet(message) -> Packet:
    return Packet(encode(message, system=VEHICLE.system, component=VEHICLE.component), common)


def attitude(seconds: float) -> Packet:
    return packet(common.Attitude(time_boot_ms=round(1000 * seconds)))


def heard() -> Discovery:
    """A discovery that knows a vehicle, which was started 50 s ago."""
    discovery = Discovery(GROUND)
    discovery.receive(packet(common.Heartbeat(type=2, autopilot=3)), START)
    assert discovery.receive(attitude(50), START) is not False
    discovery.events()
    return discovery


@pytest.mark.parametrize(
    ("boot", "later", "goes_on"),
    [
        (50.02, 0.02, True),
        (50.0, 0.05, True),
        (50.02, MOMENT, False),
        (0.3, 0.02, False),
        (58.0, 0.02, False),
    ],
)
def test_what_fits_tells_nothing_new_for_a_moment(boot: float, later: float, goes_on: bool) -> None:
    assert Pulse(50_000, START).goes_on(round(boot * 1000), START + later) is goes_on


def test_a_sign_that_fits_is_told_to_have_changed_nothing() -> None:
    discovery = heard()
    assert discovery.receive(attitude(50.05), START + 0.05) is False
    assert discovery.receive(attitude(50.2), START + 0.2) is not False
    assert discovery.next_timeout() == START + 5


def test_silence_counts_from_the_last_sign_all_the_same() -> None:
    discovery = heard()
    assert discovery.receive(attitude(50.09), START + 0.09) is False
    discovery.handle_timeout(START + 5)
    assert discovery.events() == []
    assert discovery.next_timeout() == START + 5.09
    discovery.handle_timeout(START + 5.09)
    assert [type(event) for event in discovery.events()] == [ComponentLost]
    assert discovery.components[VEHICLE].last_seen == START + 0.09
    assert discovery.receive(attitude(55.1), START + 5.1) is not False  # it is back


def test_a_reboot_between_two_looks_is_seen() -> None:
    discovery = heard()
    for tenth in range(1, 100):
        discovery.receive(attitude(50 + tenth / 100), START + tenth / 100)
    for tenth in range(100):
        discovery.receive(attitude(0.5 + tenth / 100), START + 3 + tenth / 100)
    assert [type(event) for event in discovery.events()] == [ComponentRebooted]
