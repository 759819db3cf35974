"""Servos, relays, actuators, motor tests, gripper and winch of simulated vehicles, and their limits."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.errors import (
    ActionInterrupted,
    ActionTimeout,
    ActionUnsupported,
    CommandDenied,
    InvalidArgumentError,
)
from mavstack.sim.vehicle_types import VehicleType
from tests.vehicle.failures.scripted_autopilot import ARDUPILOT as ARDUPILOT_NUMBER
from tests.vehicle.failures.scripted_autopilot import run_scenario
from tests.vehicle.firmware.received_requests import requests_of
from tests.vehicle.world import ARDUPILOT, PX4, fly

COPTER, PX4_COPTER = (VehicleType.COPTER, ARDUPILOT), (VehicleType.COPTER, PX4)


def with_payload(simulated):
    for name in ("GRIP_ENABLE", "WINCH_TYPE"):
        simulated.parameters.set(name, 1)


def test_the_outputs_of_ardupilot():
    async def scenario(world, vehicle):
        outputs, payload = vehicle.actuators, world.simulated.autopilot.payload
        await outputs.set_servo(9, 1900)
        assert payload.servos[9] == 1900
        await outputs.set_relay(1, True)
        assert payload.relays == {1: True}
        await outputs.grip()
        assert payload.gripper_closed
        await outputs.release()
        assert not payload.gripper_closed
        with pytest.raises(ActionUnsupported, match=r"vehicle 1/1 cannot set an actuator: .* use set_servo"):
            await outputs.set_actuator(1, 0.5)

    fly(COPTER, scenario, prepare=with_payload)


def test_the_winch_is_waited_for():
    async def scenario(world, vehicle):
        outputs, payload, now = vehicle.actuators, world.simulated.autopilot.payload, vehicle.connection.now
        began = now()
        await outputs.unwind(4.5, rate=0.5)
        assert payload.winch == pytest.approx(4.5, abs=0.11)
        assert now() - began > 8
        await outputs.unwind(-1.5)
        assert payload.winch == pytest.approx(3.0, abs=0.22)
        await outputs.run_winch(0.5)
        assert vehicle.latest(common.WinchStatus).speed == 0.5
        await outputs.run_winch(0.0)
        assert vehicle.latest(common.WinchStatus).speed == 0.0
        await outputs.unwind(-9.0)
        assert payload.winch == 0.0, "it is wound in completely"
        await outputs.unwind(5.0, wait=False)
        assert payload.winch < 1.0
        await outputs.relax_winch()

    fly(COPTER, scenario, prepare=with_payload)


def test_a_winch_that_stops_or_never_moves():
    async def scenario(world, vehicle):
        outputs, payload = vehicle.actuators, world.simulated.autopilot.payload
        payload.wind = lambda action, length, rate: None
        with pytest.raises(
            ActionTimeout, match=r"running winch 1 of 1/1 failed: no progress for 30 s, 3 m to go"
        ):
            await outputs.unwind(3.0)
        with pytest.raises(ActionTimeout, match="not done in 5 s"):
            await outputs.run_winch(1.0, timeout=5)
        world.simulated.parameters.set("WINCH_TYPE", 0)
        with pytest.raises(CommandDenied):
            await outputs.unwind(3.0)

    fly(COPTER, scenario, prepare=with_payload)


def test_a_winch_that_does_not_report_is_trusted():
    async def scenario(world, vehicle):
        world.simulated.messages.provide(common.WinchStatus, lambda now: None, interval=0.0, now=0.0)
        await vehicle.actuators.unwind(3.0)
        await vehicle.actuators.run_winch(1.0)

    fly(COPTER, scenario, prepare=with_payload)


def test_the_outputs_of_px4():
    async def scenario(world, vehicle):
        outputs, payload = vehicle.actuators, world.simulated.autopilot.payload
        await outputs.set_actuator(2, -1.0)
        assert list(payload.servos.values()) == [1000]
        await outputs.grip()
        assert payload.gripper_closed
        with pytest.raises(ActionUnsupported, match=r"cannot set a servo: .* use set_actuator"):
            await outputs.set_servo(1, 1500)
        with pytest.raises(ActionUnsupported, match="cannot switch a relay: PX4 has none"):
            await outputs.set_relay(0, True)

    fly(PX4_COPTER, scenario)


def test_a_gripper_that_is_not_set_up():
    async def scenario(world, vehicle):
        with pytest.raises(CommandDenied, match="DO_GRIPPER on 1/1 failed: FAILED"):
            await vehicle.actuators.release()

    fly(COPTER, scenario)


@pytest.mark.parametrize("kind", [COPTER, PX4_COPTER], ids=["ardupilot", "px4"])
def test_a_motor_test_ends_when_the_motor_stops(kind):
    async def scenario(world, vehicle):
        payload = world.simulated.autopilot.payload
        testing = asyncio.create_task(vehicle.actuators.test_motor(2, throttle=20, duration=6.5))
        for _ in range(5):
            await asyncio.sleep(1.0)
            assert (payload.motor_tested, payload.motor_throttle) == (2, pytest.approx(0.2))
        begun = world.node.now()
        await testing
        await asyncio.sleep(0.3)
        assert world.node.now() - begun == pytest.approx(1.5, abs=0.8)
        assert payload.motor_tested == 0

    fly(kind, scenario)


@pytest.mark.parametrize("kind", [COPTER, PX4_COPTER], ids=["ardupilot", "px4"])
def test_a_cancelled_motor_test_stops_the_motor(kind):
    async def scenario(world, vehicle):
        payload = world.simulated.autopilot.payload
        testing = asyncio.create_task(vehicle.actuators.test_motor(1, duration=60))
        await asyncio.sleep(1.0)
        assert payload.motor_tested == 1
        testing.cancel()
        await asyncio.sleep(0.5)
        assert payload.motor_tested == 0

    fly(kind, scenario)


def test_a_motor_test_that_the_vehicle_refuses():
    async def scenario(world, vehicle):
        await vehicle.arm()
        with pytest.raises(CommandDenied, match=r"DO_MOTOR_TEST on 1/1 failed: FAILED .*Motor Test"):
            await vehicle.actuators.test_motor(1)

    fly(COPTER, scenario)


def test_arming_interrupts_a_motor_test():
    async def scenario(harness):
        harness.autopilot.arm(False)
        await asyncio.sleep(1.5)
        asyncio.get_running_loop().call_later(4.0, harness.autopilot.arm)
        with pytest.raises(ActionInterrupted, match="test of motor 3 of 1/1 failed: it was armed"):
            await harness.vehicle.actuators.test_motor(3, duration=30)

    run_scenario(scenario)


def test_a_vehicle_that_stays_armed_after_a_motor_test_was_armed():
    """ArduPilot's heartbeat is armed during the test, so that it cannot tell."""

    async def scenario(harness):
        harness.autopilot.arm(False)
        await asyncio.sleep(1.5)
        asyncio.get_running_loop().call_later(1.0, harness.autopilot.arm)
        asyncio.get_running_loop().call_later(8.0, harness.autopilot.arm, False)
        await harness.vehicle.actuators.test_motor(3, duration=6)
        asyncio.get_running_loop().call_later(1.0, harness.autopilot.arm)
        with pytest.raises(ActionInterrupted, match="test of motor 3 of 1/1 failed: it was armed"):
            await harness.vehicle.actuators.test_motor(3, duration=4)

    run_scenario(scenario, autopilot=ARDUPILOT_NUMBER)


def test_the_number_of_an_actuator_selects_its_set():
    async def scenario(harness):
        await harness.vehicle.actuators.set_actuator(8, 0.25)
        rest = ["nan"] * 4
        assert requests_of(harness) == [("long", "DO_SET_ACTUATOR", "nan", 0.25, *rest, 1)]

    run_scenario(scenario)


def test_arguments_out_of_range_send_nothing():
    async def scenario(harness):
        outputs = harness.vehicle.actuators
        harness.autopilot.arm(False)
        for wrong in (
            lambda: outputs.set_servo(0, 1500),
            lambda: outputs.set_servo(1, 2501),
            lambda: outputs.set_relay(-1, True),
            lambda: outputs.set_actuator(1, 1.5),
            lambda: outputs.test_motor(0),
            lambda: outputs.test_motor(1.5),
            lambda: outputs.test_motor(1, throttle=101),
            lambda: outputs.test_motor(1, duration=601),
            lambda: outputs.unwind(float("nan")),
            lambda: outputs.unwind(1, rate=-1),
            lambda: outputs.grip(0),
            lambda: harness.vehicle.set_ekf_source(4),
        ):
            with pytest.raises(InvalidArgumentError):
                await wrong()
        assert requests_of(harness) == []

    run_scenario(scenario)


def test_beep_sends_a_tune():
    async def scenario(harness):
        tunes = []
        harness.autopilot.add_listener(common.PlayTuneV2, lambda message: tunes.append(message.tune))
        await harness.vehicle.actuators.beep()
        await harness.vehicle.actuators.beep("L8ABC")
        await asyncio.sleep(1)
        assert tunes == ["MFT200L16CCC", "L8ABC"]
        for wrong in ("", "A" * 249, "\u266a"):
            with pytest.raises(InvalidArgumentError):
                await harness.vehicle.actuators.beep(wrong)

    run_scenario(scenario)
