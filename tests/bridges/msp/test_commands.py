"""The commands of a bridge: calibrations, restart, saving."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.errors import ActionUnsupported, CommandDenied
from mavstack.msp.messages.actions import Reboot, RebootMode
from mavstack.msp.messages.navigation import WpMissionSave
from mavstack.msp.messages.sensors import AccCalibration, MagCalibration
from mavstack.services.mission import MissionItem
from tests.bridges.msp.fake_controller import run

_CMD = common.MavCmd


def test_the_calibration_of_the_accelerometer_ends_with_the_flag():
    async def scenario(vehicle, controller, bridge):
        controller.calibrating_until = controller.now + 3
        started = controller.now
        result = await vehicle.calibration.run("accelerometer")
        assert (str(result.kind), len(controller.sent_of(AccCalibration))) == ("accelerometer", 1)
        assert 2.9 <= controller.now - started < 4

    run(scenario)


def test_a_calibration_without_the_flag_ends_soon():
    async def scenario(vehicle, controller, bridge):
        started = controller.now
        await vehicle.calibration.run("accelerometer")
        assert controller.now - started < 2

    run(scenario)


def test_the_calibration_of_the_compass():
    async def scenario(vehicle, controller, bridge):
        started = controller.now
        await vehicle.calibration.run("compass")
        assert len(controller.sent_of(MagCalibration)) == 1
        assert 30 <= controller.now - started < 32

    run(scenario, variant="INAV")


def test_refused_calibrations():
    async def scenario(vehicle, controller, bridge):
        with pytest.raises(CommandDenied, match="there is no compass"):
            await vehicle.calibration.run("compass")
        with pytest.raises(CommandDenied, match="UNSUPPORTED"):
            await vehicle.command(_CMD.PREFLIGHT_CALIBRATION, 1)
        with pytest.raises(ActionUnsupported):
            await vehicle.calibration.cancel("accelerometer")
        await vehicle.arm()
        with pytest.raises(CommandDenied, match="Calibration refused: armed"):
            await vehicle.command(_CMD.PREFLIGHT_CALIBRATION, 0, 0, 0, 0, 1)

    run(scenario)


def test_a_restart():
    async def scenario(vehicle, controller, bridge):
        await asyncio.sleep(5)
        reads = controller.settings.reads
        await vehicle.reboot()
        assert controller.sent_of(Reboot) == [Reboot(None)]
        await asyncio.sleep(1)
        assert controller.settings.reads > reads  # they may have changed
        await vehicle.arm()
        with pytest.raises(CommandDenied, match="Reboot refused: armed"):
            await vehicle.reboot()

    run(scenario)


@pytest.mark.parametrize(("variant", "sent"), [("BTFL", [Reboot(RebootMode.BOOTLOADER_ROM)]), ("INAV", [])])
def test_the_bootloader(variant, sent):
    async def scenario(vehicle, controller, bridge):
        if sent:
            await vehicle.command(_CMD.PREFLIGHT_REBOOT_SHUTDOWN, 3)
        else:
            with pytest.raises(CommandDenied, match="UNSUPPORTED"):
                await vehicle.command(_CMD.PREFLIGHT_REBOOT_SHUTDOWN, 3)
        assert controller.sent_of(Reboot) == sent

    run(scenario, variant=variant)


@pytest.mark.parametrize(("variant", "missions"), [("BTFL", 0), ("INAV", 0), ("INAV", 1)])
def test_saving(variant, missions):
    async def scenario(vehicle, controller, bridge):
        if missions:
            await vehicle.mission.upload([MissionItem(_CMD.NAV_WAYPOINT, 0, 0, 0, 0, 47.0, 8.0, 20.0)])
        await vehicle.command(_CMD.PREFLIGHT_STORAGE, 1)
        assert (controller.saved, len(controller.sent_of(WpMissionSave))) == (1, missions)
        await vehicle.arm()
        with pytest.raises(CommandDenied, match="Saving refused: armed"):
            await vehicle.command(_CMD.PREFLIGHT_STORAGE, 1)
        with pytest.raises(CommandDenied, match="UNSUPPORTED"):
            await vehicle.command(_CMD.PREFLIGHT_STORAGE, 2)

    run(scenario, variant=variant)


def test_termination_disarms():
    async def scenario(vehicle, controller, bridge):
        await vehicle.arm()
        await vehicle.terminate()
        assert not controller.armed

    run(scenario)
