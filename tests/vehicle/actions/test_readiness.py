"""Readiness of vehicles that do not report their checks, as ArduCopter 4.0.5 reported it in SITL."""

from __future__ import annotations

import asyncio
from functools import partial

import pytest

from mavstack.dialects import ardupilotmega, common
from mavstack.errors import ActionRefused, HealthTimeout
from mavstack.vehicle.actions.preconditions import check_preconditions
from tests.vehicle.failures.scripted_autopilot import ARDUPILOT, run_scenario

EKF = ardupilotmega.EkfStatusFlags
#: The flags that ArduCopter 4.0.5 reports until its estimator uses GPS, and from then on.
WAITING_FOR_GPS = EKF.ATTITUDE | EKF.VELOCITY_VERT | EKF.POS_VERT_ABS | EKF.CONST_POS_MODE
USING_GPS = EKF(0b1100111111)


def report_sensors(script):
    """Let a scripted vehicle report its sensors, but no pre-arm check."""
    script._status = lambda now: common.SysStatus(
        onboard_control_sensors_present=common.MavSysStatusSensor.SENSOR_3D_GYRO,
        onboard_control_sensors_enabled=common.MavSysStatusSensor.SENSOR_3D_GYRO,
        onboard_control_sensors_health=common.MavSysStatusSensor.SENSOR_3D_GYRO,
    )
    script.publish(common.SysStatus, script._status, interval=0.5)


def report_estimator(script, flags):
    """Let a scripted vehicle report the last flags of a list as those of its estimator."""
    script.publish(
        ardupilotmega.EkfStatusReport,
        lambda now: ardupilotmega.EkfStatusReport(flags=flags[-1]),
        interval=1,
    )


def report_like_4_0(script, flags):
    """Let a scripted vehicle report its sensors and the flags in a list, but no pre-arm check."""
    report_sensors(script)
    report_estimator(script, flags)


def test_a_vehicle_without_a_pre_arm_bit_is_ready_once_it_reports_no_problem():
    async def scenario(harness):
        flags = [WAITING_FOR_GPS]
        report_like_4_0(harness.autopilot, flags)
        await asyncio.sleep(2)
        waiting = asyncio.create_task(harness.vehicle.wait_until_ready(timeout=120))
        await asyncio.sleep(20)
        assert not waiting.done()
        flags.append(USING_GPS)
        harness.send_statustext("PreArm: Compass not calibrated")
        await asyncio.sleep(30)
        assert not waiting.done()
        assert "Compass not calibrated" in str(harness.vehicle.health)
        health = await asyncio.wait_for(waiting, 20)
        assert health.ready is None
        assert str(health) == "readiness not reported"

    run_scenario(scenario, autopilot=ARDUPILOT)


def test_its_timeout_contains_the_problem():
    async def scenario(harness):
        report_like_4_0(harness.autopilot, [WAITING_FOR_GPS])
        await asyncio.sleep(2)
        with pytest.raises(HealthTimeout, match="horizontal position is not estimated"):
            await harness.vehicle.wait_until_ready(timeout=15)

    run_scenario(scenario, autopilot=ARDUPILOT)


def test_a_mode_without_a_position_does_not_wait_for_the_estimator():
    async def scenario(harness):
        report_like_4_0(harness.autopilot, [WAITING_FOR_GPS])
        await asyncio.sleep(2)
        assert (await harness.vehicle.wait_until_ready(mode="STABILIZE", timeout=15)).ready is None

    run_scenario(scenario, autopilot=ARDUPILOT)


def test_a_vehicle_that_boots_is_not_ready_before_its_estimator_reports():
    """As ArduRover 4.1 on a busy machine, which then refused GUIDED for a minute."""

    async def scenario(harness):
        report_sensors(harness.autopilot)
        waiting = asyncio.create_task(harness.vehicle.wait_until_ready(timeout=120))
        await asyncio.sleep(8)
        assert not waiting.done()
        flags = [WAITING_FOR_GPS]
        report_estimator(harness.autopilot, flags)
        await asyncio.sleep(30)
        assert not waiting.done()
        flags.append(USING_GPS)
        await asyncio.wait_for(waiting, 20)

    run_scenario(scenario, autopilot=ARDUPILOT)


def test_a_vehicle_whose_estimator_never_reports_is_ready_without_it():
    async def scenario(harness):
        report_sensors(harness.autopilot)
        assert (await harness.vehicle.wait_until_ready(timeout=30)).ready is None

    run_scenario(scenario, autopilot=ARDUPILOT)


def report_gps(script, fixes):
    """Let a scripted vehicle report the last fix of a list."""
    script.publish(
        common.GpsRawInt, lambda now: common.GpsRawInt(fix_type=fixes[-1], satellites_visible=9), interval=1
    )


def test_a_submarine_with_a_fix_waits_for_its_position():
    """A real ArduSub with a fix refuses GUIDED, without a text, until its estimator uses the fix."""

    async def scenario(harness):
        flags, fixes = [WAITING_FOR_GPS], [common.GpsFixType.NO_FIX]
        report_estimator(harness.autopilot, flags)
        report_gps(harness.autopilot, fixes)
        await asyncio.sleep(2)
        assert (await harness.vehicle.wait_until_ready(timeout=15)).ready
        fixes.append(common.GpsFixType._3D_FIX)
        await asyncio.sleep(2)
        waiting = asyncio.create_task(harness.vehicle.wait_until_ready(timeout=120))
        await asyncio.sleep(30)
        assert not waiting.done()
        assert (await harness.vehicle.wait_until_ready(mode="ALT_HOLD", timeout=15)).ready
        flags.append(USING_GPS)
        await asyncio.wait_for(waiting, 20)

    run_scenario(scenario, autopilot=ARDUPILOT, kind=common.MavType.SUBMARINE)


def test_a_submarine_without_a_fix_is_ready_and_goes_nowhere():
    async def scenario(harness):
        flags = [WAITING_FOR_GPS]
        report_like_4_0(harness.autopilot, flags)
        report_gps(harness.autopilot, [common.GpsFixType.NO_FIX])
        await asyncio.sleep(2)
        vehicle = harness.vehicle
        with pytest.raises(HealthTimeout, match="horizontal position is not estimated"):
            await vehicle.wait_until_ready(mode="GUIDED", timeout=15)
        check = partial(check_preconditions, vehicle, "goto", "moving")
        with pytest.raises(ActionRefused, match="position is not estimated; wait_until_ready"):
            check()
        flags.append(USING_GPS)
        await asyncio.sleep(3)
        check()

    run_scenario(scenario, autopilot=ARDUPILOT, kind=common.MavType.SUBMARINE, armed=True)
