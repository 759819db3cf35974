"""Floods of forged heartbeats must not keep a genuine vehicle from being found."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.services import Address
from mavstack.services.heartbeat import ComponentFound, Discovery
from mavstack.services.heartbeat.admission import MAX_COMPONENTS
from mavstack.wire import Packet, encode
from tests.services.network import GROUND, START, VEHICLE

HEARTBEAT = common.Heartbeat(type=common.MavType.QUADROTOR, autopilot=common.MavAutopilot.PX4)
FORGED = [Address(system, component) for system in range(2, 255) for component in range(2, 252)]


class Station:
    """The discovery of a ground station with several channels."""

    def __init__(self, verified=frozenset()) -> None:
        self.channel = ""
        self.discovery = Discovery(
            GROUND, channel_name=lambda: self.channel, is_verified=lambda address: address in verified
        )

    def receive(self, source: Address, now: float, channel: str = "udpin 10.0.0.9:1") -> None:
        self.channel = channel
        raw = encode(HEARTBEAT, system=source.system, component=source.component)
        self.discovery.receive(Packet(raw, common), now)
        self.discovery.handle_timeout(now)

    def found(self) -> list[Address]:
        events = self.discovery.events()
        return [event.component.address for event in events if isinstance(event, ComponentFound)]

    def alive(self, address: Address) -> bool:
        info = self.discovery.components.get(address)
        return info is not None and info.alive


def test_a_flood_before_a_vehicle_comes():
    station = Station()
    for number in range(MAX_COMPONENTS):
        station.receive(FORGED[number], START + number / 8192)
    station.receive(VEHICLE, START + 1.5)
    assert station.alive(VEHICLE)


@pytest.mark.parametrize("seconds", [12])
def test_a_flood_that_continues_over_another_channel(seconds):
    station = Station()
    found_at = None
    for number in range(seconds * 1000):
        now = START + number / 1000
        station.receive(FORGED[number % len(FORGED)], now)
        if number % 1000 == 500:
            station.receive(VEHICLE, now, "udpin 10.0.0.1:1")
            found_at = found_at or (now if station.alive(VEHICLE) else None)
        if found_at:
            assert station.alive(VEHICLE)
    assert found_at == START + 0.5
    assert len(station.discovery.components) <= MAX_COMPONENTS


def test_a_full_table_of_living_forged_components_makes_room():
    station = Station()
    for number in range(MAX_COMPONENTS):
        station.receive(FORGED[number], START + number / 4096, f"udpin 10.0.0.9:{number // 200}")
    assert len(station.discovery.components) == MAX_COMPONENTS
    station.receive(VEHICLE, START + 1.5, "udpin 10.0.0.1:1")
    assert station.alive(VEHICLE)


def test_verified_and_known_components_stay():
    station = Station(verified={VEHICLE})
    other = Address(1, 2)
    station.receive(VEHICLE, START, "cable")
    for second in range(4):
        station.receive(other, START + second, "radio")
    for number in range(3 * MAX_COMPONENTS):
        station.receive(FORGED[number], START + 4 + number / 65536, f"udpin 10.0.0.9:{number // 200}")
    assert {VEHICLE, other} <= set(station.discovery.components)


def test_the_rate_of_new_components_is_limited():
    station = Station()
    for number in range(5000):
        station.receive(FORGED[number], START + number / 5000)
    assert 250 < len(station.found()) < 500
