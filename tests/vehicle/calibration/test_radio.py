"""The radio control calibration of both firmwares: the pulses that are measured, and the parameters."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.errors import ActionInterrupted, InvalidStateError
from mavstack.sim.vehicle_types import VehicleType
from mavstack.vehicle import CalibrationTask, ChannelRange
from tests.vehicle.calibration.pilot import calibrate
from tests.vehicle.world import ARDUPILOT, PX4, fly

TASK = CalibrationTask


def transmitter(simulated):
    """Let the vehicle receive a transmitter, which PX4's simulations have not."""
    radio = simulated.autopilot.radio
    radio.has_transmitter = radio.switched_on = True
    return radio


@pytest.mark.parametrize("firmware", [ARDUPILOT, PX4])
def test_the_pulses_of_the_channels(firmware):
    async def scenario(world, vehicle):
        radio = transmitter(world.simulated)
        middle = list(radio._own)

        async def move() -> None:
            for pulse in (1012, 1990, 1100):
                radio._own[0] = radio._own[2] = pulse
                await asyncio.sleep(0.5)
            radio._own[:] = middle
            radio._own[0], radio._own[2] = 1505, 1015

        moving = []

        def act(step) -> None:
            if step.task is TASK.MOVE_STICKS:
                moving.append(asyncio.create_task(move()))

        steps, result = await calibrate(vehicle, "radio", act)
        tasks = list(dict.fromkeys(step.task for step in steps))
        assert tasks == [TASK.WAIT, TASK.MOVE_STICKS, TASK.CENTER_STICKS]
        assert result.channels == {1: ChannelRange(1012, 1505, 1990), 3: ChannelRange(1000, 1015, 1990)}
        parameters = world.simulated.parameters
        assert [parameters[f"RC3_{name}"] for name in ("MIN", "TRIM", "MAX")] == [1000, 1015, 1990]
        if firmware is PX4:
            texts = [text.text for text in vehicle.status_texts]
            assert "Calibration: Restoring RC input" in texts

    fly((VehicleType.COPTER, firmware), scenario)


def test_sticks_that_did_not_move():
    async def scenario(world, vehicle):
        transmitter(world.simulated)
        with pytest.raises(ActionInterrupted, match="radio calibration of 1/1 failed: no channel"):
            await calibrate(vehicle, "radio")
        await asyncio.sleep(1)
        assert world.simulated.autopilot.profile.state.calibrating == ""

    fly((VehicleType.COPTER, PX4), scenario)


def test_only_steps_that_wait_are_confirmed():
    async def scenario(world, vehicle):
        transmitter(world.simulated)
        async with vehicle.calibration.start("radio") as session:
            with pytest.raises(InvalidStateError, match="radio calibration does not wait for a confirmation"):
                await session.confirm()
            async for step in session:
                if step.needs_confirmation:
                    break

    fly((VehicleType.COPTER, ARDUPILOT), scenario)
