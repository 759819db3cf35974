"""Batteries: several of them, and those of other components."""

from __future__ import annotations

from mavstack.dialects import common
from tests.vehicle.telemetry.harness import with_telemetry

NO_CELLS = (0xFFFF,) * 10


def test_several_batteries():
    async def scenario(harness):
        harness.receive(common.BatteryStatus(id=1, voltages=(12_000, *NO_CELLS[1:]), battery_remaining=50))
        harness.receive(
            common.BatteryStatus(id=0, voltages=NO_CELLS, battery_remaining=-1, current_battery=-1)
        )
        harness.receive(common.SysStatus(voltage_battery=16_000, current_battery=100, battery_remaining=80))
        assert [(each.id, each.voltage, each.remaining) for each in harness.vehicle.batteries.values()] == [
            (0, 16.0, 80),  # what its own message leaves open the summary tells
            (1, 12.0, 50),
        ]
        assert harness.vehicle.battery.id == 0

    with_telemetry(scenario)


def test_a_battery_may_be_a_component_but_a_camera_has_its_own():
    async def scenario(harness):
        received = common.BatteryStatus(id=3, voltages=(12_000, *NO_CELLS[1:]))
        harness.receive(received, component=common.MavComponent.CAMERA)
        assert harness.vehicle.batteries == {}
        harness.receive(received, component=common.MavComponent.BATTERY)
        assert list(harness.vehicle.batteries) == [3]
        harness.receive(received.replace(voltages=(11_000, *NO_CELLS[1:])))
        assert harness.vehicle.batteries[3].voltage == 11.0, "the autopilot knows better"

    with_telemetry(scenario)
