"""The states of a vehicle: published when they change, converted only then; seldom without a subscriber."""

from __future__ import annotations

import asyncio
from collections import Counter
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from mavstack.bridges.core.plain_json import json_bytes
from mavstack.bridges.zenoh import fleet_vehicle, gateway
from mavstack.bridges.zenoh.fleet_vehicle import FleetVehicle
from mavstack.bridges.zenoh.gateway import Gateway, GatewayOptions
from mavstack.bridges.zenoh.keys import VehicleKeys
from mavstack.dialects import Dialect
from mavstack.security.roles import Role
from mavstack.sim.virtual import run_virtually

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine

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
        self.matching: dict[str, Callable[[bool], None]] = {}
        self.queries: dict[str, Callable[[Any], Coroutine[Any, Any, None]]] = {}
        self.zenoh = SimpleNamespace(KeyExpr=str)

    def publisher(self, key: str, matching: Callable[[bool], None]) -> None:
        self.matching[key] = matching

    def queryable(self, key: str, answer: Callable[[Any], Coroutine[Any, Any, None]]) -> None:
        self.queries[key] = answer

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
    fleet, vehicle, bus = _fleet(monkeypatch)
    for latitude in (None, 47.0, 47.0, 47.1, 47.1, None):
        vehicle.home = None if latitude is None else {"latitude": latitude}
        fleet.publish_states()
    assert bus.states.samples == [b'{"latitude":47.0}', b'{"latitude":47.1}']
    assert len(converted) == 2


def test_a_subscriber_and_a_query_get_the_present_state(monkeypatch: pytest.MonkeyPatch) -> None:
    fleet, vehicle, bus = _fleet(monkeypatch)
    vehicle.home = {"latitude": 1.0}
    bus.matching["mavstack/alpha/state/*"](True)
    assert fleet.is_watched
    assert bus.states.samples == [b'{"latitude":1.0}']
    vehicle.home = {"latitude": 2.0}
    bus.matching["mavstack/alpha/state/*"](False)
    assert not fleet.is_watched
    assert len(bus.states.samples) == 1
    replies: list[bytes] = []
    query = SimpleNamespace(
        key_expr=SimpleNamespace(intersects=lambda key: True),
        reply=lambda key, data, encoding: replies.append(data),
    )
    asyncio.run(bus.queries["mavstack/alpha/state/*"](query))
    assert replies == [b'{"latitude":2.0}']


def test_states_without_a_subscriber_are_published_less_often() -> None:
    calls: Counter[int] = Counter()
    seconds = 10 * gateway.UNWATCHED_DIVISOR

    def member(system: int, *, is_watched: bool) -> Any:
        return SimpleNamespace(
            vehicle=SimpleNamespace(system=system),
            is_watched=is_watched,
            publish_states=lambda: calls.update([system]),
        )

    async def scenario() -> None:
        connection: Any = SimpleNamespace()
        bus: Any = Bus()
        tower = Gateway(connection, bus, GatewayOptions(state_rate=1.0))
        tower.vehicles.update({1: member(1, is_watched=True), 2: member(2, is_watched=False)})
        task = asyncio.get_running_loop().create_task(tower._publish_states())
        await asyncio.sleep(seconds + 0.1)
        task.cancel()

    run_virtually(scenario())
    assert calls == {1: seconds, 2: seconds // gateway.UNWATCHED_DIVISOR}


def _fleet(monkeypatch: pytest.MonkeyPatch) -> tuple[FleetVehicle, Any, Bus]:
    monkeypatch.setattr(fleet_vehicle, "GROUPS", {"home": lambda vehicle: vehicle.home})
    connection = SimpleNamespace(dialect=Dialect.load("common"))
    vehicle: Any = SimpleNamespace(system=1, connection=connection, home=None)
    bus = Bus()
    used: Any = bus
    fleet = FleetVehicle(vehicle, VehicleKeys("mavstack", "alpha"), used, Role.OBSERVE, lambda _: None)
    fleet.open()
    return fleet, vehicle, bus
