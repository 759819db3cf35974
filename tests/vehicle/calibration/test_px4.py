"""All calibrations of simulated PX4 vehicles, and the texts of a real one."""

from __future__ import annotations

import asyncio
from itertools import groupby

import pytest

from mavstack.dialects import common
from mavstack.errors import ActionInterrupted, ActionTimeout, ActionUnsupported, CommandDenied
from mavstack.sim.px4.calibration import SIDES
from mavstack.sim.vehicle_types import VehicleType
from mavstack.vehicle import CalibrationTask, Pose
from tests.vehicle.calibration.pilot import calibrate
from tests.vehicle.failures.scripted_autopilot import CMD, RESULT, run_scenario
from tests.vehicle.world import PX4, fly

COPTER, PLANE = (VehicleType.COPTER, PX4), (VehicleType.PLANE, PX4)
TASK = CalibrationTask
POSES = [Pose.NOSE_UP, Pose.NOSE_DOWN, Pose.LEFT, Pose.RIGHT, Pose.BACK, Pose.LEVEL]


@pytest.mark.parametrize("kind", ["gyroscope", "level", "barometer"])
def test_sensors_at_rest(kind):
    async def scenario(world, vehicle):
        steps = []
        await vehicle.calibration.run(kind, on_step=steps.append)
        assert {step.task for step in steps} == {TASK.HOLD_STILL}
        if kind != "barometer":
            assert [step.progress for step in steps] == [None, *range(0, 101, 10)]

    fly(COPTER, scenario)


def test_one_calibration_directly_after_another():
    async def scenario(world, vehicle):
        for kind in ("gyroscope", "level", "barometer"):
            await vehicle.calibration.run(kind)

    fly(COPTER, scenario)


@pytest.mark.flight_cases(1)
@pytest.mark.flight
@pytest.mark.parametrize(("kind", "task"), [("accelerometer", TASK.HOLD_STILL), ("compass", TASK.ROTATE)])
def test_the_vehicle_detects_the_side_that_is_down(kind, task):
    async def scenario(world, vehicle):
        steps = []
        await vehicle.calibration.run(kind, on_step=steps.append)
        detected = list(dict.fromkeys(step.pose for step in steps if step.pose is not None))
        assert detected == POSES
        assert {step.task for step in steps if step.pose is not None} == {task}
        placed = [step.pending for step in steps if step.task is TASK.PLACE]
        assert set(placed) == {tuple(POSES[index:]) for index in range(6)}
        assert steps[-1].progress == 100

    fly(COPTER, scenario)


def test_the_airspeed_of_a_plane():
    async def scenario(world, vehicle):
        steps = []
        await vehicle.calibration.run("airspeed", on_step=steps.append)
        tasks = list(dict.fromkeys(step.task for step in steps))
        assert tasks == [TASK.HOLD_STILL, TASK.SHIELD_PITOT, TASK.BLOW_PITOT]

    fly(PLANE, scenario)


def test_the_escs():
    async def scenario(world, vehicle):
        steps, _ = await calibrate(vehicle, "esc")
        assert [step.task for step in steps] == [TASK.WAIT, TASK.CONNECT_BATTERY]
        assert "propellers" in steps[0].text
        with pytest.raises(ActionUnsupported, match="cannot run the compass-motor calibration"):
            await vehicle.calibration.run("compass-motor")

    fly(COPTER, scenario)


def test_leaving_the_block_cancels():
    async def scenario(world, vehicle):
        async with vehicle.calibration.start("accelerometer") as session:
            while (await anext(session)).pose is not Pose.LEFT:
                pass
        await asyncio.sleep(0.5)
        assert world.simulated.autopilot.profile.state.calibrating == ""
        assert vehicle.status_texts[-1].text == "[cal] calibration cancelled"
        await vehicle.calibration.run("gyroscope")

    fly(COPTER, scenario)


def test_a_calibration_that_another_program_cancels():
    async def scenario(world, vehicle):
        running = asyncio.create_task(vehicle.calibration.run("compass"))
        await asyncio.sleep(3)
        await vehicle.calibration.cancel("compass")
        with pytest.raises(ActionInterrupted, match="compass calibration of 1/1 failed: it was cancelled"):
            await running

    fly(COPTER, scenario)


def test_one_at_a_time():
    async def scenario(world, vehicle):
        running = asyncio.create_task(vehicle.calibration.run("compass"))
        await asyncio.sleep(2)
        with pytest.raises(CommandDenied, match="TEMPORARILY_REJECTED"):
            await vehicle.calibration.run("gyroscope")
        await running

    fly(COPTER, scenario)


def texts_of(harness, texts, gap=0.5):
    """Accept a calibration, and send status texts."""
    harness.autopilot.arm(False)

    async def send() -> None:
        for text in texts:
            await asyncio.sleep(gap)
            harness.send_statustext(f"[cal] {text}", 6)

    def accept(request):
        asyncio.get_running_loop().create_task(send())
        return RESULT.ACCEPTED

    harness.autopilot.commands.server.support(CMD.PREFLIGHT_CALIBRATION, accept)


def test_a_reported_failure():
    async def scenario(harness):
        texts_of(
            harness,
            ["calibration cancelled", "calibration started: 2 gyro", "calibration failed: reading sensor"],
        )
        with pytest.raises(ActionInterrupted) as failed:
            await harness.vehicle.calibration.run("gyroscope")
        assert str(failed.value) == "gyroscope calibration of 1/1 failed: reading sensor"

    run_scenario(scenario)


#: The texts of real vehicles: they were not turned, so that both calibrations failed.
ACCELEROMETER = [
    "calibration started: 2 accel",
    "pending: back front left right up down",
    "hold vehicle still on a pending side",
    "detected rest position, hold still...",
    "down orientation detected",
    "Hold still, measuring down side",
    "down side result: [ 1.5294 -0.2218 -11.85",
    "progress <17>",
    "down side done, rotate to a different side",
    "pending: back front left right up",
    "hold vehicle still on a pending side",
    "detected rest position, hold still...",
    "down side already completed",
    "calibration failed: timeout: no motion",
]
COMPASS = [
    "calibration started: 2 mag",
    "Skipped scale calibration, sensor 0",
    "pending: back front left right up down",
    "hold vehicle still on a pending side",
    "detected rest position, hold still...",
    "up orientation detected",
    "Rotate vehicle around the detected orientat",
    "Continue rotation for up 7 s",
    "up side calibration: progress <4>",
    "up side calibration: progress <8>",
    "calibration failed: mag",
]


@pytest.mark.parametrize(
    ("kind", "texts", "tasks", "reason"),
    [
        (
            "accelerometer",
            ACCELEROMETER,
            [TASK.PLACE, TASK.HOLD_STILL, TASK.PLACE, TASK.HOLD_STILL, TASK.PLACE],
            "timeout: no motion",
        ),
        ("compass", COMPASS, [TASK.PLACE, TASK.HOLD_STILL, TASK.ROTATE], "the vehicle reported a failure"),
    ],
)
def test_recorded_conversations(kind, texts, tasks, reason):
    async def scenario(harness):
        texts_of(harness, texts)
        steps = []
        with pytest.raises(ActionInterrupted, match=f"{kind} calibration of 1/1 failed: {reason}"):
            await harness.vehicle.calibration.run(kind, on_step=steps.append)
        assert [task for task, _ in groupby(step.task for step in steps)] == tasks
        if kind == "accelerometer":
            assert (steps[-1].pending, steps[-1].progress) == (tuple(POSES[:5]), 17)
        else:
            assert (steps[-1].pose, steps[-1].progress) == (Pose.BACK, 8)

    run_scenario(scenario)


def test_no_sign_of_progress():
    async def scenario(harness):
        texts_of(harness, ["calibration started: 2 gyro", "progress <10>"])
        begun = harness.connection.now()
        with pytest.raises(ActionTimeout, match="gyroscope calibration of 1/1 failed: no progress for 30 s"):
            await harness.vehicle.calibration.run("gyroscope")
        assert 30 <= harness.connection.now() - begun < 40
        cancels = [
            message
            for message in harness.autopilot.received
            if isinstance(message, common.CommandLong)
            and (message.command, message.param1) == (CMD.PREFLIGHT_CALIBRATION, 0)
        ]
        assert cancels

    run_scenario(scenario)


def test_remarks_of_the_vehicle_are_not_steps():
    async def scenario(harness):
        steps = []
        side = ["detected motion, hold still...", "left orientation detected", "left orientation detected"]
        rest = ["left side already completed", "sensor 0: 12 samples", "calibration done: mag"]
        texts_of(harness, ["calibration started: 2 mag", f"pending: {' '.join(SIDES)}", *side, *rest])
        await harness.vehicle.calibration.run("compass", on_step=steps.append)
        assert [(step.task, step.pose) for step in steps] == [
            (TASK.PLACE, None),
            (TASK.ROTATE, Pose.LEFT),
            (TASK.PLACE, None),
        ]
        assert str(steps[1]) == "Detected on its left side: rotate it around that axis."

    run_scenario(scenario)
