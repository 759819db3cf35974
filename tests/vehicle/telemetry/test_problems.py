"""Reasons why a vehicle is not ready, from each message that reports one."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import ardupilotmega, common
from mavstack.services.statustext import chunks_of
from tests.vehicle.telemetry.harness import PX4 as PX
from tests.vehicle.telemetry.harness import with_telemetry
from tests.vehicle.telemetry.health_messages import BIT, EKF, ESTIMATED, NOT_READY, READY, status, texts_of

PROBLEMS = [
    (status(BIT.PREARM_CHECK), "its checks before arming fail, and it has not reported which", "SYS_STATUS"),
    (
        status(BIT.SENSOR_3D_MAG | BIT.SENSOR_3D_GYRO, BIT.SENSOR_3D_GYRO),
        "compass is not healthy",
        "SYS_STATUS",
    ),
    (
        status(0, onboard_control_sensors_enabled_extended=1),
        "parachute is not healthy",
        "SYS_STATUS",
    ),
    (common.GpsRawInt(fix_type=2, satellites_visible=5), "GPS has no 3D fix (5 satellites)", "GPS_RAW_INT"),
    (common.GpsRawInt(fix_type=1, satellites_visible=255), "GPS has no 3D fix", "GPS_RAW_INT"),
    (common.GpsRawInt(fix_type=0), "no GPS receiver is connected", "GPS_RAW_INT"),
    (
        ardupilotmega.EkfStatusReport(ESTIMATED & ~EKF.POS_HORIZ_ABS),
        "horizontal position is not estimated",
        "EKF_STATUS_REPORT",
    ),
    (
        ardupilotmega.EkfStatusReport(EKF.UNINITIALIZED),
        "the estimator is not initialised",
        "EKF_STATUS_REPORT",
    ),
    (ardupilotmega.EkfStatusReport(ESTIMATED | EKF.GPS_GLITCHING), "GPS glitches", "EKF_STATUS_REPORT"),
    (
        ardupilotmega.EkfStatusReport(ESTIMATED, compass_variance=1.5),
        "compass contradicts the estimate",
        "EKF_STATUS_REPORT",
    ),
    (common.EstimatorStatus(flags=ESTIMATED | 1024), "GPS glitches", "ESTIMATOR_STATUS"),
    (
        common.EstimatorStatus(flags=ESTIMATED | 2048),
        "the estimator rejects the accelerometer",
        "ESTIMATOR_STATUS",
    ),
    (
        common.EstimatorStatus(flags=ESTIMATED, mag_ratio=2),
        "compass contradicts the estimate",
        "ESTIMATOR_STATUS",
    ),
    (common.BatteryStatus(charge_state=2, battery_remaining=14), "battery 0 is low (14 %)", "BATTERY_STATUS"),
    (common.BatteryStatus(id=1, fault_bitmask=4), "battery 1 reports a fault", "BATTERY_STATUS"),
    (
        common.Heartbeat(2, 3, system_status=common.MavState.CALIBRATING),
        "it is calibrating",
        "HEARTBEAT",
    ),
    (common.Statustext(text="PreArm: RC not calibrated"), "RC not calibrated", "STATUSTEXT"),
    (common.Statustext(text="Arm: Throttle too high"), "Throttle too high", "STATUSTEXT"),
    (common.Statustext(text="Preflight Fail: Gyro 0 fault"), "Gyro 0 fault", "STATUSTEXT"),
    (common.Statustext(text="Arming denied: not landed"), "not landed", "STATUSTEXT"),
]


@pytest.mark.parametrize(("message", "text", "source"), PROBLEMS, ids=[text for _, text, _ in PROBLEMS])
def test_the_problems_of_each_message(message, text, source):
    async def scenario(harness):
        harness.heartbeat()
        harness.receive(message)
        problems = harness.vehicle.health.problems
        assert [(problem.text, problem.source) for problem in problems] == [(text, source)]
        assert text in str(harness.vehicle.health)

    with_telemetry(scenario)


def test_a_healthy_vehicle_has_no_problems():
    async def scenario(harness):
        harness.heartbeat(system_status=common.MavState.STANDBY)
        harness.receive(
            status(BIT.PREARM_CHECK | BIT.SENSOR_GPS, BIT.PREARM_CHECK | BIT.SENSOR_GPS),
            common.GpsRawInt(fix_type=3, satellites_visible=12),
            ardupilotmega.EkfStatusReport(ESTIMATED, 0.1, 0.1, 0.1, 0.1),
            common.BatteryStatus(charge_state=1, battery_remaining=90),
            common.Statustext(text="EKF3 IMU0 is using GPS"),
        )
        health = harness.vehicle.health
        assert (health.ready, health.problems, str(health)) == (True, (), "ready")

    with_telemetry(scenario)


def test_a_vehicle_without_gps_has_no_gps_problem():
    async def scenario(harness):
        harness.heartbeat()
        harness.receive(status(BIT.PREARM_CHECK, BIT.PREARM_CHECK), common.GpsRawInt(fix_type=0))
        assert harness.vehicle.health.problems == ()

    with_telemetry(scenario)


def test_a_lost_fix_is_one_problem():
    async def scenario(harness):
        harness.heartbeat()
        harness.receive(status(BIT.SENSOR_GPS | BIT.SENSOR_3D_MAG), common.GpsRawInt(fix_type=1))
        assert texts_of(harness.vehicle.health) == [
            "GPS has no 3D fix (0 satellites)",
            "compass is not healthy",
        ]

    with_telemetry(scenario)


def test_failure_flags_of_high_latency():
    async def scenario(harness):
        harness.receive(common.HighLatency2(type=2, autopilot=PX, failure_flags=1 | 128))
        health = harness.vehicle.health
        assert health.ready is None
        assert texts_of(health) == ["GPS is not healthy", "battery is not healthy"]
        assert {problem.source for problem in health.problems} == {"HIGH_LATENCY2"}

    with_telemetry(scenario)


def send_texts(harness, *texts, component=1):
    harness.receive(*(common.Statustext(text=text) for text in texts), component=component)


def test_ardupilots_failed_checks_arrive_in_one_run():
    async def scenario(harness):
        harness.heartbeat()
        harness.receive(NOT_READY)
        send_texts(harness, "PreArm: one", "PreArm: two")
        await asyncio.sleep(29)
        harness.heartbeat()
        harness.receive(NOT_READY)
        assert texts_of(harness.vehicle.health) == ["one", "two"]
        send_texts(harness, "PreArm: two")
        assert texts_of(harness.vehicle.health) == ["two"]
        await asyncio.sleep(50)
        harness.heartbeat()
        harness.receive(NOT_READY)
        unknown = "its checks before arming fail, and it has not reported which"
        assert texts_of(harness.vehicle.health) == [unknown]

    with_telemetry(scenario)


def test_px4s_failed_checks_count_until_it_is_ready():
    async def scenario(harness):
        harness.heartbeat(PX)
        harness.receive(NOT_READY)
        send_texts(harness, "Preflight Fail: one")
        harness.receive(*chunks_of("Arming denied: Resolve system health failures first", 2, 1))
        await asyncio.sleep(20)
        send_texts(harness, "Preflight Fail: two")
        await asyncio.sleep(300)
        harness.heartbeat(PX)
        harness.receive(NOT_READY)
        assert texts_of(harness.vehicle.health) == ["one", "two"]
        send_texts(harness, "Preflight Fail: late")
        await asyncio.sleep(1)
        harness.receive(READY)
        assert harness.vehicle.health.problems == ()
        await asyncio.sleep(1)
        harness.receive(NOT_READY)
        send_texts(harness, "Preflight Fail: three")
        assert texts_of(harness.vehicle.health) == ["three"]

    with_telemetry(scenario)


def test_a_cameras_status_text_is_no_failed_check():
    async def scenario(harness):
        harness.heartbeat()
        harness.receive(NOT_READY)
        send_texts(harness, "PreArm: no film", component=common.MavComponent.CAMERA)
        assert "no film" not in texts_of(harness.vehicle.health)

    with_telemetry(scenario)
