"""Arming Betaflight's SITL by MSP_SET_RAW_RC, as a flight controller and as a vehicle."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

import pytest

import mavstack
from mavstack.bridges.msp import FlightController
from mavstack.dialects import common
from mavstack.errors import CommandDenied
from mavstack.msp.messages import config, modes, sensors
from tests.interop.betaflight import GRAVITY, URL, betaflight_sitl, flight_simulator, needs_betaflight

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = [pytest.mark.interop, pytest.mark.timeout(120), needs_betaflight]

RECEIVERS = config.Feature.RX_UDP | config.Feature.RX_SERIAL | config.Feature.RX_PPM
BOX_ARM, BOX_ANGLE = 0, 1
ONE_G = 256


async def take_channels_by_msp(controller: FlightController) -> None:
    """Make MSP the only receiver, and give the modes switches; both hold after a restart."""
    features = (await controller.get(config.FeatureConfig)).features
    await controller.send(config.SetFeatureConfig(features & ~RECEIVERS | config.Feature.RX_MSP))
    await controller.send(modes.SetModeRange(0, BOX_ARM, 0, 1700, 2100, 0, 0))
    await controller.send(modes.SetModeRange(1, BOX_ANGLE, 1, 1700, 2100, 0, 0))
    await controller.save()


async def test_arming_and_modes_by_rc_channels(tmp_path: Path) -> None:
    with betaflight_sitl(tmp_path) as sitl:
        await sitl.start()
        async with FlightController(URL) as controller:
            await take_channels_by_msp(controller)
        await sitl.restart()
        async with flight_simulator(), await mavstack.connect(URL) as connection:
            vehicle = await connection.wait_for_vehicle(timeout=20)
            await vehicle.wait_until_ready(timeout=30)
            await vehicle.arm()
            assert vehicle.armed
            await vehicle.set_mode("ANGLE")
            assert vehicle.mode == "ANGLE"
            await vehicle.disarm()
            assert not vehicle.armed


async def test_another_receiver_keeps_control(tmp_path: Path) -> None:
    with betaflight_sitl(tmp_path) as sitl:
        await sitl.start()
        async with flight_simulator(), await mavstack.connect(URL) as connection:
            vehicle = await connection.wait_for_vehicle(timeout=20)
            with pytest.raises(CommandDenied):
                await vehicle.arm()


async def gravity(controller: FlightController) -> int:
    """Return the vertical acceleration, 256 for 1 g, once the reading is steady."""
    before, now = 0, -1
    while before != now or not now:
        await asyncio.sleep(0.2)
        before, now = now, (await controller.get(sensors.RawImu)).accelerations[2]
    return now


async def test_calibrating_the_accelerometer(tmp_path: Path) -> None:
    with betaflight_sitl(tmp_path) as sitl:
        await sitl.start()
        async with flight_simulator(gravity=0.9 * GRAVITY):
            async with FlightController(URL) as controller:
                assert await gravity(controller) == pytest.approx(0.9 * ONE_G, abs=2)
            async with await mavstack.connect(URL) as connection:
                vehicle = await connection.wait_for_vehicle(timeout=20)
                states = []
                vehicle.add_listener(common.Heartbeat, lambda beat: states.append(beat.system_status))
                await vehicle.calibration.run("accelerometer")
                assert common.MavState.CALIBRATING in states
            async with FlightController(URL) as controller:
                assert await gravity(controller) == pytest.approx(ONE_G, abs=2)
