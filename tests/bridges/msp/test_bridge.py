"""The bridge of a flight controller as a vehicle: identity, telemetry, contact, status texts."""

from __future__ import annotations

import asyncio
from math import degrees, isnan

import pytest

from mavstack.bridges.msp.bridge import MspBridge
from mavstack.dialects import common
from mavstack.errors import ActionUnsupported
from mavstack.links.memory import MemoryNetwork
from mavstack.msp.messages.sensors import Altitude, Attitude
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle.events import VehicleLost, VehicleReturned
from mavstack.vehicle.firmware import Betaflight, Inav
from tests.bridges.msp.fake_controller import FakeController, run
from tests.waiting import wait_until


@pytest.mark.parametrize(("variant", "firmware"), [("BTFL", Betaflight), ("INAV", Inav)])
def test_the_vehicle_is_known_with_its_first_heartbeat(variant, firmware):
    async def scenario(vehicle, controller, bridge):
        assert type(vehicle.firmware) is firmware
        await asyncio.sleep(1.2)
        assert (vehicle.armed, vehicle.mode) == (False, "ACRO")
        version = await vehicle.get_version()
        assert (version.identifier, str(version.flight), version.git_hash) == (variant, "4.5.1", "")
        found = vehicle.capabilities
        assert (found.parameters, found.mission, found.fence, found.ftp) == (
            True,
            variant == "INAV",
            False,
            False,
        )
        assert found.calibrations == ("accelerometer", "compass")
        assert found.flashing is True
        assert vehicle.mav_type == (
            common.MavType.QUADROTOR if variant == "BTFL" else common.MavType.FIXED_WING
        )

    run(scenario, variant=variant)


def test_what_it_lacks_is_unsupported_and_nothing_is_sent():
    async def scenario(vehicle, controller, bridge):
        sent = vehicle.connection.links[0].counters.bytes_out
        for call in (
            lambda: vehicle.takeoff(5),
            vehicle.land,
            lambda: vehicle.goto(47.0, 8.0, 10.0),
            lambda: vehicle.orbit(47.0, 8.0, radius=10),
            lambda: vehicle.set_speed(5),
            vehicle.set_home,
            lambda: vehicle.guided().__aenter__(),
            vehicle.mission.download,
            vehicle.mission.fly,
            vehicle.fence.clear,
            vehicle.rally.download,
            lambda: vehicle.actuators.set_servo(1, 1500),
            lambda: vehicle.actuators.test_motor(1),
            vehicle.actuators.grip,
            vehicle.roi.clear,
            vehicle.transition_to_multicopter,
            lambda: vehicle.calibration.run("gyroscope"),
        ):
            with pytest.raises(ActionUnsupported, match="vehicle 1/1 cannot"):
                await call()
        for name in ("ftp", "logs", "terrain"):
            with pytest.raises(ActionUnsupported):
                getattr(vehicle, name)
        assert vehicle.connection.links[0].counters.bytes_out == sent

    run(scenario)


def test_telemetry():
    async def scenario(vehicle, controller, bridge):
        await vehicle.wait_for_message(common.BatteryStatus)
        await vehicle.wait_for_message(common.ServoOutputRaw)
        attitude = vehicle.attitude
        assert [round(value) for value in (attitude.roll, attitude.pitch, attitude.heading)] == [10, -20, 350]
        assert isnan(vehicle.latest(common.Attitude).rollspeed)
        position = vehicle.position
        assert (position.latitude, position.longitude) == (47.0, 8.0)
        assert (position.altitude, position.relative_altitude) == (500.0, 12.5)
        assert degrees(0) == 0
        assert vehicle.gps.satellites == 11
        assert vehicle.rc.channels[:6] == (1500, 1510, 1100, 1520, 1000, 2000)
        assert vehicle.battery.voltage == pytest.approx(16.21)
        assert vehicle.battery.remaining == 80
        assert vehicle.vfr_hud.climb == 1.5
        assert vehicle.latest(common.ServoOutputRaw).servo4_raw == 1003

    run(scenario)


def test_a_requested_rate_is_polled_and_sent():
    async def scenario(vehicle, controller, bridge):
        await vehicle.set_message_rate(common.Attitude, 100)
        await asyncio.sleep(1)
        before, count = controller.polls[Attitude], 0

        def received(_):
            nonlocal count
            count += 1

        vehicle.add_listener(common.Attitude, received)
        await asyncio.sleep(5)
        assert count == pytest.approx(500, abs=15)
        assert controller.polls[Attitude] - before == pytest.approx(500, abs=15)

    run(scenario)


def test_polls_leave_a_share_of_a_slow_line_free(monkeypatch):
    monkeypatch.setattr("tests.bridges.msp.fake_controller.ANSWER_TIME", 0.05)

    async def scenario(vehicle, controller, bridge):
        await vehicle.set_message_rate(common.Attitude, 100)
        before = sum(controller.polls.values())
        await asyncio.sleep(10)
        assert sum(controller.polls.values()) - before == pytest.approx(160, abs=5)  # 80 % of 200

    run(scenario)


def test_a_silent_controller_is_lost_and_returns_as_rebooted():
    async def scenario(vehicle, controller, bridge):
        await asyncio.sleep(2)
        async with vehicle.connection.events(VehicleLost, VehicleReturned) as events:
            controller.silent = True
            assert isinstance(await anext(events), VehicleLost)
            assert not vehicle.alive
            controller.silent = False
            assert isinstance(await anext(events), VehicleReturned)
        await vehicle.wait_for_message(common.SystemTime)
        assert vehicle.latest(common.SystemTime).time_boot_ms < 3000
        await vehicle.wait_for_message(common.Attitude, timeout=2)

    run(scenario)


def test_reasons_not_to_arm_are_the_health():
    async def scenario(vehicle, controller, bridge):
        await vehicle.wait_until_ready()  # no signal, but the bridge sends channels when it arms
        controller.reasons = 1 << 8 | 1 << 13
        await asyncio.sleep(3)
        health = vehicle.health
        assert health.ready is False
        texts = {problem.text for problem in health.problems}
        assert {"not level (ANGLE)", "CLI is open (CLI)"} <= texts
        controller.reasons = 0
        await asyncio.sleep(3)
        assert vehicle.health.ready is True

    run(scenario)


def test_without_an_msp_receiver_a_missing_signal_is_a_reason():
    async def scenario(vehicle, controller, bridge):
        await asyncio.sleep(3)
        assert vehicle.health.ready is False
        assert "no RC signal (RX_FAILSAFE)" in {problem.text for problem in vehicle.health.problems}

    run(scenario, receives_msp=False)


def test_reasons_are_repeated():
    async def scenario(vehicle, controller, bridge):
        count = 0

        def received(message):
            nonlocal count
            count += message.text.startswith("PreArm")

        vehicle.add_listener(common.Statustext, received)
        controller.reasons = 1 << 8
        await asyncio.sleep(65)
        assert count == 3

    run(scenario)


def test_an_altitude_that_the_messages_cannot_hold():
    async def scenario(vehicle, controller, bridge):
        controller.messages[Altitude] = Altitude(21_474_836.47, 1.5, 12.0)
        await asyncio.sleep(2)
        position = await vehicle.wait_for_message(common.GlobalPositionInt)
        assert position.relative_alt == 0x7FFF_FFFF

    run(scenario)


def test_a_bridge_whose_part_failed_shows_the_vehicle_lost():
    async def scenario(vehicle, controller, bridge):
        reported = []
        asyncio.get_running_loop().set_exception_handler(lambda _, context: reported.append(context))
        async with vehicle.connection.events(VehicleLost) as events:
            bridge._poller._intervals = lambda: 1 / 0
            await anext(events)
        assert [type(context["exception"]) for context in reported] == [ZeroDivisionError]

    run(scenario)


def test_a_bridge_whose_opening_is_cancelled_is_closed():
    async def work():
        controller, network = FakeController(variant="INAV"), MemoryNetwork()
        bridge = MspBridge(controller, network.link())
        bridge_opens = asyncio.create_task(bridge.__aenter__())
        await wait_until(lambda: bridge.node.is_open, "the node is open", interval=0.001)
        bridge_opens.cancel()
        await asyncio.gather(bridge_opens, return_exceptions=True)
        assert not bridge.node.is_open

    run_virtually(work())
