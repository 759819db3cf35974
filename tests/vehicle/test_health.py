"""Health of a vehicle: ready to arm, or the reasons against it."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import ardupilotmega, common
from mavstack.errors import CommandDenied, HealthTimeout, RemoteTimeout
from mavstack.sim.vehicle_types import VehicleType
from tests.sim.running import reduce_telemetry
from tests.vehicle.failures.scripted_autopilot import run_scenario as scripted_readiness
from tests.vehicle.telemetry.harness import ARDUPILOT as AP
from tests.vehicle.telemetry.harness import PX4 as PX
from tests.vehicle.telemetry.harness import with_telemetry
from tests.vehicle.telemetry.health_messages import BIT, EKF, NOT_READY, READY, status, texts_of
from tests.vehicle.world import ALL, ARDUPILOT, PX4, fly, kind_name

COPTERS = [(VehicleType.COPTER, ARDUPILOT), (VehicleType.COPTER, PX4)]


# Simulated vehicles


@pytest.mark.fast_cases(4)
@pytest.mark.parametrize("kind", ALL, ids=kind_name)
def test_every_vehicle_gets_ready_by_itself(kind):
    async def scenario(world, vehicle):
        before = vehicle.health
        assert not before.ready
        health = await vehicle.wait_until_ready(timeout=30)
        assert health.ready is True
        assert vehicle.health == health
        await vehicle.arm()

    fly(kind, scenario, ready=False)


@pytest.mark.parametrize("kind", COPTERS, ids=kind_name)
def test_a_starting_vehicle_reports_that_it_starts(kind):
    async def scenario(world, vehicle):
        with pytest.raises(HealthTimeout) as caught:
            await vehicle.wait_until_ready(timeout=0.5)
        text = str(caught.value)
        assert text.startswith("waiting for the readiness of 1/1 failed: not in 0.5 s: ")
        expected = "System not initialised" if kind[1] == ARDUPILOT else "ekf2 missing data"
        assert expected in text

    fly(kind, scenario, ready=False)


FAULTS = [
    (ARDUPILOT, "gps off", ["GPS 1: Bad fix", "Need Position Estimate", "GPS has no 3D fix (0 satellites)"]),
    (ARDUPILOT, "compass 120", ["Compass 1 not healthy"]),
    (ARDUPILOT, "radio off", ["radio control receiver is not healthy", "Throttle below failsafe"]),
    (ARDUPILOT, "battery 5", ["Battery 1 low voltage failsafe"]),
    (PX4, "gps off", ["No valid global position estimate", "GPS has no 3D fix (0 satellites)"]),
    (PX4, "compass 120", ["heading estimate invalid", "compass contradicts the estimate"]),
    (PX4, "battery 10", ["battery 0 is low (10 %)"]),
    (PX4, "battery 6", ["battery 0 is critically low (6 %)"]),
    (PX4, "battery 2", ["battery 0 is almost empty (2 %)"]),
]


def quiet_with_battery_limits(simulated):
    reduce_telemetry(simulated)
    if simulated.firmware == ARDUPILOT:
        simulated.parameters.set("BATT_LOW_VOLT", 15.5)


@pytest.mark.flight_cases(2)
@pytest.mark.fast_cases(1)
@pytest.mark.parametrize(("firmware", "fault", "reasons"), FAULTS, ids=[f"{f}-{n}" for f, n, _ in FAULTS])
def test_a_fault_is_a_problem_until_it_ends(firmware, fault, reasons):
    async def scenario(world, vehicle):
        await vehicle.wait_until_ready(timeout=30)
        if firmware == ARDUPILOT:
            await vehicle.set_mode("GUIDED")
        world.simulated.faults.inject(fault)
        await world.wait_until(lambda: vehicle.health.ready is False)
        with pytest.raises(HealthTimeout) as caught:
            await vehicle.wait_until_ready(timeout=12)
        found = texts_of(vehicle.health)
        assert set(reasons) <= set(found)
        assert len(found) == len(set(found))
        for reason in reasons:
            assert reason in str(caught.value)
        kind, _, _ = fault.partition(" ")
        world.simulated.faults.inject(
            {"compass": "compass 0", "battery": "battery 100"}.get(kind, f"{kind} on")
        )
        assert (await vehicle.wait_until_ready(timeout=60)).ready
        await world.wait_until(lambda: not set(reasons) & set(texts_of(vehicle.health)), timeout=3)

    fly((VehicleType.COPTER, firmware), scenario, prepare=quiet_with_battery_limits)


@pytest.mark.parametrize("kind", COPTERS, ids=kind_name)
def test_it_becomes_ready_over_a_lossy_link(kind):
    async def scenario(world, vehicle):
        assert (await vehicle.wait_until_ready(timeout=60)).ready

    fly(kind, scenario, ready=False, loss=0.3, latency=0.2, seed=3)


@pytest.mark.flight
def test_a_silent_vehicle_is_reported_as_silent():
    async def scenario(world, vehicle):
        await vehicle.wait_until_ready(timeout=30)
        world.simulated.faults.inject("link off")
        await asyncio.sleep(20)
        health = vehicle.health
        assert health.ready is None
        assert texts_of(health)[-1].startswith("it is silent for ")
        with pytest.raises(RemoteTimeout, match=r"readiness not reported; .*it is silent"):
            await vehicle.wait_until_ready(timeout=5)

    fly(COPTERS[0], scenario)


@pytest.mark.flight
def test_a_refused_arming_leaves_its_reason_as_a_problem():
    async def scenario(world, vehicle):
        world.simulated.faults.inject("battery 2")
        await asyncio.sleep(20)
        with pytest.raises(CommandDenied):
            await vehicle.arm()
        assert vehicle.health.ready is False

    fly(COPTERS[1], scenario)


# ScriptedAutopilot: each message by itself


@pytest.mark.parametrize(
    ("autopilot", "message", "ready"),
    [
        (AP, NOT_READY, False),
        (AP, READY, True),
        (AP, status(enabled=0), None),
        (PX, status(enabled=0), False),
        (PX, status(enabled=0, health=BIT.PREARM_CHECK), True),
        (common.MavAutopilot.GENERIC, status(enabled=0), None),
    ],
)
def test_ready_follows_the_prearm_bit(autopilot, message, ready):
    async def scenario(harness):
        assert harness.vehicle.health.ready is None
        harness.heartbeat(autopilot)
        assert harness.vehicle.health.ready is None
        harness.receive(message)
        assert harness.vehicle.health.ready is ready

    with_telemetry(scenario)


def test_reports_from_before_the_readiness_are_no_warnings():
    async def scenario(harness):
        harness.heartbeat(PX)
        harness.receive(NOT_READY, common.GpsRawInt(fix_type=1, satellites_visible=0))
        await asyncio.sleep(1)
        assert "GPS has no 3D fix (0 satellites)" in texts_of(harness.vehicle.health)
        harness.receive(READY)
        health = harness.vehicle.health
        assert (health.ready, health.problems, health.warnings) == (True, (), ())
        harness.receive(common.GpsRawInt(fix_type=1, satellites_visible=0))
        assert [str(each) for each in harness.vehicle.health.warnings] == ["GPS has no 3D fix (0 satellites)"]

    with_telemetry(scenario)


def test_old_messages_do_not_count():
    async def scenario(harness):
        harness.heartbeat()
        harness.receive(READY)
        for _ in range(40):
            await asyncio.sleep(1)
            harness.heartbeat()
        assert harness.vehicle.health.ready is None

    with_telemetry(scenario)


@pytest.mark.parametrize("kind", COPTERS[:1], ids=kind_name)
def test_messages_from_before_a_reboot_do_not_count(kind):
    async def scenario(world, vehicle):
        await vehicle.wait_until_ready()
        assert vehicle.health.ready
        await vehicle.reboot()
        assert not vehicle.health.ready
        await vehicle.wait_until_ready()
        await vehicle.set_mode("GUIDED")
        await vehicle.arm()

    fly(kind, scenario)


# Readiness in the mode to be flown


@pytest.mark.parametrize("flag", [EKF.POS_HORIZ_ABS, EKF.PRED_POS_HORIZ_ABS, EKF.POS_HORIZ_REL])
def test_ardupilot_is_ready_once_its_position_is_estimated(flag):
    async def scenario(harness):
        flags = [EKF.ATTITUDE]
        harness.autopilot.publish(
            ardupilotmega.EkfStatusReport,
            lambda now: ardupilotmega.EkfStatusReport(flags=flags[0]),
            interval=1,
        )
        waiting = asyncio.create_task(harness.vehicle.wait_until_ready())
        await harness.vehicle.wait_until_ready(mode="ALT_HOLD", timeout=2)
        await asyncio.sleep(15)
        assert not waiting.done()
        health = harness.vehicle.health
        assert health.ready
        assert not health.problems
        assert "horizontal position is not estimated" in map(str, health.warnings)
        flags[0] |= flag
        await asyncio.wait_for(waiting, 3)

    scripted_readiness(scenario, autopilot=AP)


def test_ardupilot_without_an_estimator_report_is_ready_by_its_pre_arm_bit():
    async def scenario(harness):
        await harness.vehicle.wait_until_ready(timeout=10)

    scripted_readiness(scenario, autopilot=AP)


@pytest.mark.parametrize(("mode", "after"), [("POSCTL", "LOITER"), ("OFFBOARD", "OFFBOARD")])
def test_px4_without_radio_control_leaves_a_mode_that_needs_sticks(mode, after):
    async def scenario(harness):
        autopilot = harness.autopilot
        autopilot.enter(mode)
        autopilot.arm(False)

        def report(now):
            ready = harness.vehicle.mode == "LOITER"
            return common.SysStatus(
                onboard_control_sensors_present=BIT.SENSOR_RC_RECEIVER,
                onboard_control_sensors_enabled=BIT.SENSOR_RC_RECEIVER,
                onboard_control_sensors_health=BIT.PREARM_CHECK if ready else 0,
            )

        autopilot._status = report
        autopilot.publish(common.SysStatus, report, interval=0.5)
        await asyncio.sleep(2)
        if after == "LOITER":
            await harness.vehicle.wait_until_ready(timeout=30)
        else:
            with pytest.raises(HealthTimeout, match="radio control receiver is not healthy"):
                await harness.vehicle.wait_until_ready(timeout=12)
        assert harness.vehicle.mode == after

    scripted_readiness(scenario, autopilot=PX)
