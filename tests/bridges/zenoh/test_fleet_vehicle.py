"""The states of a vehicle: published when they change, converted only then."""

from __future__ import annotations

from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from mavstack.bridges.core.plain_json import json_bytes
from mavstack.bridges.zenoh import fleet_vehicle
from mavstack.bridges.zenoh.fleet_vehicle import FleetVehicle
from mavstack.bridges.zenoh.keys import VehicleKeys
from mavstack.dialects import Dialect
from mavstack.security.roles import Role

if TYPE_CHECKING:
    import pytest


class Publisher:
    def __init__(self) -> None:
        self.samples: list[bytes] = []

    def put(self, data: bytes, encoding: str) -> None:
        self.samples.append(data)


class Bus:
    """The calls of a bus by which a vehicle declares its endpoints."""

    gateway = "tower"

    def __init__(self) -> None:
        self.states = Publisher()

    def latched_publisher(self, key: str) -> Publisher:
        return self.states

    def __getattr__(self, name: str) -> Any:
        return lambda *arguments: None


def test_a_state_is_converted_and_published_when_it_changes(monkeypatch: pytest.MonkeyPatch) -> None:
    converted: list[object] = []

    def convert(value: object) -> bytes:
        converted.append(value)
        return json_bytes(value)

    monkeypatch.setattr(fleet_vehicle, "json_bytes", convert)
    monkeypatch.setattr(fleet_vehicle, "GROUPS", {"home": lambda vehicle: vehicle.home})
    connection = SimpleNamespace(dialect=Dialect.load("common"))
    vehicle: Any = SimpleNamespace(system=1, connection=connection, home=None)
    bus: Any = Bus()
    fleet = FleetVehicle(vehicle, VehicleKeys("mavstack", "alpha"), bus, Role.OBSERVE, lambda _: None)
    fleet.open()
    for latitude in (None, 47.0, 47.0, 47.1, 47.1, None):
        vehicle.home = None if latitude is None else {"latitude": latitude}
        fleet.publish_states()
    assert bus.states.samples == [b'{"latitude":47.0}', b'{"latitude":47.1}']
    assert len(converted) == 2
