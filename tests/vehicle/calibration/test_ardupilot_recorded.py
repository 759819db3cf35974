"""The conversations of real ArduPilot vehicles (4.1-dev, in their own simulation) with the client."""

from __future__ import annotations

import asyncio
from contextlib import nullcontext

import pytest

from mavstack.dialects import ardupilotmega, common
from mavstack.errors import ActionInterrupted
from mavstack.vehicle import CalibrationTask, Pose
from tests.vehicle.calibration.pilot import calibrate
from tests.vehicle.failures.scripted_autopilot import ARDUPILOT, CMD, RESULT, run_scenario

POSITION, SUCCESS = ardupilotmega.MavCmd.ACCELCAL_VEHICLE_POS, ardupilotmega.AccelcalVehiclePos.SUCCESS
STATUS = ardupilotmega.MagCalStatus
#: Seconds and percent of the progress, of all three compasses; the second step begins after 18 seconds.
COMPASS_PROGRESS = ((0.5, 1), (7.5, 20), (12.0, 32), (18.0, 33), (20.0, 40), (41.0, 98))
#: The fitness of each compass, in milligauss, in the order of the reports.
FITNESS = {1: 0.034, 0: 0.036, 2: 0.035}


def test_accelerometer():
    """A text asks for the first pose only; each pose is requested until a second after its confirmation."""

    async def scenario(harness):
        autopilot = harness.autopilot
        autopilot.arm(False)
        position = [0]

        def confirmed(request):
            asyncio.get_running_loop().call_later(1.1, measured)
            return RESULT.ACCEPTED if request.command.param1 == position[0] else RESULT.FAILED

        def measured():
            position[0] = position[0] + 1 if position[0] < 6 else SUCCESS
            if position[0] == SUCCESS:
                harness.send_statustext("Calibration successful")

        def started(request):
            position[0] = 1
            harness.send_statustext("Place vehicle level and press any key.")
            return RESULT.ACCEPTED

        autopilot.commands.server.support(CMD.PREFLIGHT_CALIBRATION, started)
        autopilot.commands.server.support(POSITION, confirmed)
        autopilot.publish(
            common.CommandLong,
            lambda now: common.CommandLong(command=POSITION, param1=position[0]) if position[0] else None,
            interval=1.0,
        )
        steps, result = await calibrate(harness.vehicle, "accelerometer")
        poses = [step.pose for step in steps if step.task is CalibrationTask.PLACE]
        assert poses == [Pose.LEVEL, Pose.LEFT, Pose.RIGHT, Pose.NOSE_DOWN, Pose.NOSE_UP, Pose.BACK]
        assert result.reboot_needed

    run_scenario(scenario, autopilot=ARDUPILOT)


@pytest.mark.parametrize("end", ["Airspeed 1 calibrated", "Airspeed 1 unhealthy", None])
def test_airspeed_of_a_plane(end):
    """ArduPlane 4.1-dev acknowledged the start; its text reported the end after 3.7 s."""

    async def scenario(harness):
        harness.autopilot.arm(False)

        def started(request):
            harness.send_statustext("Airspeed 1 calibration started", common.MavSeverity.INFO)
            if end is not None:
                harness.send_statustext(end, common.MavSeverity.INFO, after=3.7)
            return RESULT.ACCEPTED

        harness.autopilot.commands.server.support(CMD.PREFLIGHT_CALIBRATION, started)
        begun = harness.connection.now()
        failure = pytest.raises(ActionInterrupted, match="airspeed sensor 1 is unhealthy")
        with failure if end == "Airspeed 1 unhealthy" else nullcontext():
            await harness.vehicle.calibration.run("airspeed")
        duration = harness.connection.now() - begun
        assert duration == pytest.approx(15 if end is None else 3.7, abs=0.6)

    run_scenario(scenario, autopilot=ARDUPILOT, kind=common.MavType.FIXED_WING)


def test_three_compasses():
    """The last report came half a second after the first; all are repeated."""

    async def scenario(harness):
        autopilot = harness.autopilot
        autopilot.arm(False)
        autopilot.commands.server.support(
            ardupilotmega.MavCmd.DO_START_MAG_CAL, lambda request: RESULT.ACCEPTED
        )

        def progress(percent: int) -> None:
            step = STATUS.RUNNING_STEP_ONE if percent < 33 else STATUS.RUNNING_STEP_TWO
            for compass in (1, 2, 0):
                autopilot.send(
                    ardupilotmega.MagCalProgress(
                        compass_id=compass, cal_mask=7, cal_status=step, attempt=1, completion_pct=percent
                    )
                )

        def report(compass: int) -> None:
            autopilot.send(
                common.MagCalReport(
                    compass_id=compass,
                    cal_mask=7,
                    cal_status=STATUS.SUCCESS,
                    autosaved=1,
                    fitness=FITNESS[compass],
                )
            )

        loop = asyncio.get_running_loop()
        for seconds, percent in COMPASS_PROGRESS:
            loop.call_later(1.0 + seconds, progress, percent)
        for seconds, compass in ((42.5, 1), (42.5, 0), (43.0, 1), (43.0, 0), (43.0, 2)):
            loop.call_later(seconds, report, compass)
        steps, result = await calibrate(harness.vehicle, "compass")
        assert [step.progress for step in steps] == [percent for _, percent in COMPASS_PROGRESS]
        assert [(fit.id, fit.saved) for fit in result.compasses] == [(0, True), (1, True), (2, True)]

    run_scenario(scenario, autopilot=ARDUPILOT)
