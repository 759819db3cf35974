"""Payloads are reported once, whichever of autopilot and payload is received first."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from mavstack.dialects import common
from mavstack.services import Address
from mavstack.services.heartbeat import ComponentFound, ComponentInfo
from mavstack.vehicle import PayloadFound, VehicleFound
from mavstack.vehicle.vehicle_tracker import VehicleTracker

AUTOPILOT, CAMERA = Address(1, 1), Address(1, 100)


def found(address: Address) -> ComponentFound:
    types = {AUTOPILOT: common.MavType.QUADROTOR, CAMERA: common.MavType.CAMERA}
    firmware = common.MavAutopilot.PX4 if address == AUTOPILOT else common.MavAutopilot.INVALID
    heartbeat = common.Heartbeat(type=types[address], autopilot=firmware)
    return ComponentFound(ComponentInfo.from_heartbeat(address, heartbeat, 0.0))


def tracker_of(*addresses: Address) -> VehicleTracker:
    """Return a tracker of components that were all received before their events are handled."""
    components = {address: found(address).component for address in addresses}
    return VehicleTracker(components, lambda address: SimpleNamespace(address=address, system=address.system))


@pytest.mark.parametrize("order", [(AUTOPILOT, CAMERA), (CAMERA, AUTOPILOT)], ids=["vehicle", "payload"])
def test_heartbeats_that_arrive_together(order) -> None:
    tracker = tracker_of(AUTOPILOT, CAMERA)
    events = [event for address in order for event in tracker.receive(found(address))]
    assert [type(event) for event in events] == [VehicleFound, PayloadFound]


def test_a_payload_that_was_removed_is_found_again() -> None:
    tracker = tracker_of(AUTOPILOT, CAMERA)
    assert [*tracker.receive(found(CAMERA))] == []
    camera = tracker._components.pop(CAMERA)
    assert [type(event) for event in tracker.receive(found(AUTOPILOT))] == [VehicleFound]
    tracker._components[CAMERA] = camera  # type: ignore[index]
    assert [type(event) for event in tracker.receive(found(CAMERA))] == [PayloadFound]
