"""All calibrations of simulated ArduPilot vehicles: their steps, results, failures and cancellations."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import ardupilotmega, common
from mavstack.errors import (
    ActionInterrupted,
    ActionTimeout,
    ActionUnsupported,
    CommandDenied,
    InvalidArgumentError,
)
from mavstack.sim.ardupilot.motor_calibration import compass_motor_of
from mavstack.sim.ardupilot.sensor_calibration import calibrations_of
from mavstack.sim.vehicle_types import VehicleType
from mavstack.vehicle import CalibrationKind, CalibrationTask, Pose
from tests.vehicle.calibration.pilot import calibrate
from tests.vehicle.failures.scripted_autopilot import ARDUPILOT as ARDUPILOT_NUMBER
from tests.vehicle.failures.scripted_autopilot import CMD, RESULT, run_scenario
from tests.vehicle.world import ARDUPILOT, fly

COPTER, PLANE = (VehicleType.COPTER, ARDUPILOT), (VehicleType.PLANE, ARDUPILOT)
TASK = CalibrationTask
POSES = [Pose.LEVEL, Pose.LEFT, Pose.RIGHT, Pose.NOSE_DOWN, Pose.NOSE_UP, Pose.BACK]


@pytest.mark.parametrize("kind", ["gyroscope", "level", "barometer"])
def test_sensors_at_rest(kind):
    async def scenario(world, vehicle):
        steps = []
        result = await vehicle.calibration.run(kind, on_step=steps.append)
        assert result.kind == kind
        assert not result.reboot_needed
        assert {step.task for step in steps} == {TASK.HOLD_STILL}
        assert max(step.progress or 0 for step in steps) > 40

    fly(COPTER, scenario)


def test_the_airspeed_of_a_plane():
    async def scenario(world, vehicle):
        steps, _ = await calibrate(vehicle, "airspeed")
        assert steps[0].task is TASK.SHIELD_PITOT
        assert CalibrationKind.ESC not in vehicle.calibration.kinds
        with pytest.raises(ActionUnsupported, match="cannot run the compass-motor calibration"):
            vehicle.calibration.start("compass-motor")

    fly(PLANE, scenario)


def test_the_accelerometer_in_six_poses():
    async def scenario(world, vehicle):
        for _ in range(2):  # during the second calibration the result of the first arrives again
            steps, result = await calibrate(vehicle, "accelerometer")
            placed = [step for step in steps if step.task is TASK.PLACE]
            assert [step.pose for step in placed] == POSES
            assert [step.progress for step in placed] == [0, 16, 33, 50, 66, 83]
            assert all(step.needs_confirmation for step in placed)
            assert result.reboot_needed
        assert calibrations_of(world.simulated.autopilot).position == 0

    fly(COPTER, scenario)


def test_a_pose_is_waited_for():
    async def scenario(world, vehicle):
        async with vehicle.calibration.start("accelerometer") as session:
            assert (await anext(session)).pose is Pose.LEVEL
            await asyncio.sleep(40)  # longer than a vehicle without a sign of progress may take
            await session.confirm()
            assert (await anext(session)).task is TASK.HOLD_STILL
            assert (await anext(session)).pose is Pose.LEFT

    fly(COPTER, scenario)


def test_the_compass():
    async def scenario(world, vehicle):
        steps, result = await calibrate(vehicle, "compass")
        assert {step.task for step in steps} == {TASK.ROTATE}
        assert max(step.progress for step in steps) > 80
        (fit,) = result.compasses
        assert (fit.id, fit.saved, result.reboot_needed) == (0, True, True)

    fly(COPTER, scenario)


def test_leaving_the_block_cancels_the_compass():
    async def scenario(world, vehicle):
        async with vehicle.calibration.start("compass") as session:
            await anext(session)
            assert calibrations_of(world.simulated.autopilot).compass_started is not None
        assert calibrations_of(world.simulated.autopilot).compass_started is None
        assert session.result is None

    fly(COPTER, scenario)


def test_another_programs_compass_calibration_is_cancelled():
    async def scenario(world, vehicle):
        await vehicle.command(ardupilotmega.MavCmd.DO_START_MAG_CAL)
        await vehicle.calibration.cancel("compass")
        assert calibrations_of(world.simulated.autopilot).compass_started is None

    fly(COPTER, scenario)


def test_compass_and_motors():
    async def scenario(world, vehicle):
        steps, _ = await calibrate(vehicle, "compass-motor")
        assert {step.task for step in steps} == {TASK.RAISE_THROTTLE}
        assert "% interference" in steps[-1].text
        assert compass_motor_of(world.simulated.autopilot).started is None

    fly(COPTER, scenario)


def test_compass_and_motors_without_throttle():
    async def scenario(world, vehicle):
        compass_motor_of(world.simulated.autopilot).tick = lambda now: None  # the pilot does nothing
        async with vehicle.calibration.start("compass-motor") as session:
            await anext(session)
            await session.confirm()
            with pytest.raises(ActionInterrupted, match="the throttle was not raised enough"):
                async for _ in session:
                    pass

    fly(COPTER, scenario)


def test_compass_and_motors_are_refused_with_an_open_throttle():
    async def scenario(world, vehicle):
        world.simulated.autopilot.radio.move(3, 1200)
        with pytest.raises(CommandDenied, match="Throttle not zero"):
            await calibrate(vehicle, "compass-motor")
        world.simulated.autopilot.radio.move(3, 1000)
        world.simulated.parameters.set("COMPASS_ENABLE", 0)
        with pytest.raises(CommandDenied, match="Compass disabled"):
            await calibrate(vehicle, "compass-motor")

    fly(COPTER, scenario)


def test_what_the_vehicle_can_cancel():
    async def scenario(world, vehicle):
        calibration = vehicle.calibration
        cancellable = {str(kind) for kind in calibration.kinds if calibration.can_cancel(kind)}
        assert cancellable == {"compass", "compass-motor", "esc", "radio"}
        with pytest.raises(InvalidArgumentError):
            calibration.can_cancel("clock")

    fly(COPTER, scenario)


def test_the_escs_are_calibrated_at_power_up():
    async def scenario(world, vehicle):
        steps, result = await calibrate(vehicle, "esc")
        assert [step.task for step in steps] == [TASK.CONNECT_BATTERY]
        assert result.reboot_needed
        assert world.simulated.boots == 2
        assert world.simulated.parameters["ESC_CALIBRATION"] == 0

    fly(COPTER, scenario)


def test_leaving_the_block_resets_the_esc_parameter():
    async def scenario(world, vehicle):
        async with vehicle.calibration.start("esc") as session:
            await anext(session)
        await asyncio.sleep(10)
        assert world.simulated.boots == 1
        assert world.simulated.parameters["ESC_CALIBRATION"] == 0

    fly(COPTER, scenario)


def test_an_armed_vehicle_refuses():
    async def scenario(world, vehicle):
        await vehicle.arm()
        with pytest.raises(CommandDenied, match=r"PREFLIGHT_CALIBRATION on 1/1 failed: .*Disarm to allow"):
            await vehicle.calibration.run("gyroscope")

    fly(COPTER, scenario)


def test_a_failed_compass():
    async def scenario(harness):
        harness.autopilot.arm(False)
        harness.autopilot.commands.server.support(
            ardupilotmega.MavCmd.DO_START_MAG_CAL, lambda request: RESULT.ACCEPTED
        )
        report = common.MagCalReport(compass_id=0, cal_mask=3, cal_status=common.MagCalStatus.SUCCESS)

        async def report_calibration() -> None:
            await asyncio.sleep(2)
            harness.autopilot.send(report)  # of an earlier calibration
            for compass in (0, 1):
                harness.autopilot.send(
                    ardupilotmega.MagCalProgress(compass_id=compass, cal_mask=3, completion_pct=50)
                )
            await asyncio.sleep(1)
            harness.autopilot.send(report)
            await asyncio.sleep(2)
            harness.autopilot.send(
                report.replace(compass_id=1, cal_status=common.MagCalStatus.FAILED_ORIENTATION)
            )

        reporting = asyncio.create_task(report_calibration())
        with pytest.raises(ActionInterrupted) as failed:
            await harness.vehicle.calibration.run("compass")
        assert str(failed.value) == "compass calibration of 1/1 failed: compass 1: FAILED_ORIENTATION"
        await reporting

    run_scenario(scenario, autopilot=ARDUPILOT_NUMBER)


@pytest.mark.parametrize(
    ("kind", "reports"),
    [
        ("compass", [ardupilotmega.MagCalProgress(compass_id=0, cal_mask=1, completion_pct=0)]),
        ("radio", [common.RcChannels(chan1_raw=65535)]),
    ],
)
def test_reports_without_progress(kind, reports):
    """A vehicle that is not turned, or has no receiver, reports that for ever."""

    async def scenario(harness):
        harness.autopilot.arm(False)
        harness.autopilot.commands.server.support(
            ardupilotmega.MavCmd.DO_START_MAG_CAL, lambda request: RESULT.ACCEPTED
        )
        for report in reports:
            harness.autopilot.publish(type(report), lambda now: report, interval=0.5)  # noqa: B023
        with pytest.raises(ActionTimeout, match=f"{kind} calibration of 1/1 failed: no progress for 120 s"):
            await calibrate(harness.vehicle, kind)

    run_scenario(scenario, autopilot=ARDUPILOT_NUMBER)


def test_a_failed_accelerometer():
    async def scenario(harness):
        harness.autopilot.arm(False)
        harness.autopilot.commands.server.support(CMD.PREFLIGHT_CALIBRATION, lambda request: RESULT.ACCEPTED)

        async def report_calibration() -> None:
            position = common.CommandLong(command=ardupilotmega.MavCmd.ACCELCAL_VEHICLE_POS)
            for number in (ardupilotmega.AccelcalVehiclePos.SUCCESS, 1):  # the first is an earlier result
                await asyncio.sleep(1)
                harness.autopilot.send(position.replace(param1=float(number)))
            await asyncio.sleep(4)
            harness.autopilot.send(position.replace(param1=float(ardupilotmega.AccelcalVehiclePos.FAILED)))

        harness.autopilot.commands.server.support(
            ardupilotmega.MavCmd.ACCELCAL_VEHICLE_POS, lambda request: RESULT.ACCEPTED
        )
        reporting = asyncio.create_task(report_calibration())
        with pytest.raises(ActionInterrupted, match="could not calibrate from these poses"):
            await calibrate(harness.vehicle, "accelerometer")
        await reporting

    run_scenario(scenario, autopilot=ARDUPILOT_NUMBER)


def test_run_cannot_confirm():
    async def scenario(harness):
        harness.autopilot.received.clear()
        with pytest.raises(InvalidArgumentError, match="use start"):
            await harness.vehicle.calibration.run("accelerometer")
        with pytest.raises(InvalidArgumentError, match="there is no calibration 'nose'; there are accelero"):
            harness.vehicle.calibration.start("nose")
        assert harness.autopilot.requests() == []

    run_scenario(scenario, autopilot=ARDUPILOT_NUMBER)
