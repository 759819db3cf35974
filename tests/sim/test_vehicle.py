"""A simulated vehicle that reboots, on the ground and in the air, and whose link is cut."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.services.command import Command
from mavstack.services.mission import MissionItem
from mavstack.sim.simulation import Simulation
from mavstack.wire import Parser
from tests.sim.harness import CMD, RESULT, VehicleHarness, airborne, grounded

FIRMWARES = ["ardupilot", "px4"]


def boot_times(one: VehicleHarness) -> list[int]:
    return [message.time_boot_ms for message in one.received if hasattr(message, "time_boot_ms")]


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("firmware", FIRMWARES)
def test_a_reboot_on_the_ground(firmware) -> None:
    one = grounded("copter", firmware)
    name = "RTL_ALT" if firmware == "ardupilot" else "RTL_RETURN_ALT"
    one.set(**{name: 42})
    one.load(*[waypoint()] * 2)
    one.receiving = True
    one.run(2)
    boots, before = one.vehicle.boots, boot_times(one)
    assert before[-1] > 4000
    one.send(Command.of(CMD.PREFLIGHT_REBOOT_SHUTDOWN, [1], None).to_long(one.vehicle.address))
    one.run(0.2)
    assert [ack.result for ack in one.received_of(common.CommandAck)] == [RESULT.ACCEPTED], (
        "acknowledged before the reboot"
    )
    one.received.clear()
    one.run(0.5)
    assert not one.received, "for a moment it is silent"
    one.run(3)
    assert one.vehicle.boots == boots + 1
    assert boot_times(one)[0] < 2500, "time begins anew"
    assert one.vehicle.parameters[name] == 42
    assert len(one.vehicle.mission.plan(0).items) >= 2
    assert one.received_of(common.Heartbeat), "the link is the same"
    assert one.command(CMD.COMPONENT_ARM_DISARM, 1) == RESULT.ACCEPTED, one.texts


@pytest.mark.parametrize(("firmware", "name"), [("ardupilot", "SYSID_THISMAV"), ("px4", "MAV_SYS_ID")])
def test_another_system_id_counts_from_the_next_boot(firmware, name) -> None:
    simulation = Simulation(rate=20)
    vehicle = simulation.add("copter", firmware)
    vehicle.open_port("ground")
    vehicle.parameters.set(name, 42)
    received = []
    for _ in range(2):
        simulation.advance(simulation.now + 3)
        data = b"".join(data for _, data in vehicle.data_to_send())
        received.append({packet.system for packet in Parser(common).feed(data)})
        vehicle.reboot()
    simulation.advance(simulation.now + 3)
    assert received == [{1}, {42}]


def waypoint() -> MissionItem:
    frame = common.MavFrame.GLOBAL_RELATIVE_ALT
    return MissionItem(CMD.NAV_WAYPOINT, param5=47.4, param6=8.5456, param7=30.0, frame=frame)


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("firmware", FIRMWARES)
def test_a_reboot_in_the_air_stops_the_motors_and_the_vehicle_falls(firmware) -> None:
    one = airborne("copter", firmware)
    refused = {RESULT.FAILED, RESULT.DENIED, RESULT.TEMPORARILY_REJECTED}
    assert one.command(CMD.PREFLIGHT_REBOOT_SHUTDOWN, 1) in refused
    assert one.armed
    one.inject("reboot").run(1.2)
    assert not one.armed
    assert one.height < 18
    one.run(4)
    assert one.vehicle.body.on_ground
    one.run(4)
    assert not list(one.vehicle.profile.arming_problems(one.autopilot))
    assert not one.autopilot.arm()


def test_an_ardupilot_reboots_in_the_air_if_it_is_forced_to() -> None:
    copter = airborne()
    boots = copter.vehicle.boots
    assert copter.command(CMD.PREFLIGHT_REBOOT_SHUTDOWN, 1, 0, 0, 0, 0, 20190226) == RESULT.ACCEPTED
    copter.run(1)
    assert copter.vehicle.boots == boots + 1


def test_faults_outlive_a_reboot() -> None:
    copter = grounded().inject("gps off", "radio off", "reboot").run(4)
    assert copter.vehicle.faults.active == {"gps": "gps off", "radio": "radio off"}
    assert not copter.autopilot.has_position
    assert not copter.autopilot.radio.present
    copter.inject("gps on", "radio on").run(4)
    assert copter.autopilot.has_position
    assert copter.autopilot.radio.present


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("firmware", FIRMWARES)
def test_a_link_that_is_cut_lets_nothing_through_until_it_is_whole(firmware) -> None:
    enabled = {"FS_GCS_ENABLE": 1, "FS_GCS_TIMEOUT": 2} if firmware == "ardupilot" else {
        "NAV_DLL_ACT": 2, "COM_DL_LOSS_T": 2, "COM_FAIL_ACT_T": 0}  # fmt: skip
    one = airborne("copter", firmware, **enabled)
    one.receiving = True
    one.inject("link off")
    one.run(0.1)
    one.received.clear()
    assert one.command(CMD.NAV_LAND) is None
    one.run(3.5)
    assert not one.received
    assert one.mode in ("RTL", "Return"), "the failsafe acts"
    one.inject("link on").run(2)
    assert one.received_of(common.Heartbeat)
    assert one.mode in ("RTL", "Return")
    assert {"GCS Failsafe Cleared", "GCS connection regained"} & set(one.texts)
    assert "link" not in one.vehicle.faults.active
