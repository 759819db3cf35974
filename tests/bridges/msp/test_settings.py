from __future__ import annotations

import asyncio

import pytest

from mavstack.errors import InvalidArgumentError, MspDenied, MspFirmwareError, MspSettingError
from mavstack.sim.virtual import run_virtually
from tests.bridges.msp.controllers import IDENTITY, Firmware, controller_of

PID, SET_PID, TUNING, SAVE = 112, 202, 111, 250


class TunedFirmware(Firmware):
    """A firmware with gains and rates, which keeps the gains that it is sent."""

    def __init__(self) -> None:
        self.gains = bytes(range(40, 55))
        replies = {PID: lambda _: self.gains, SET_PID: self.set_gains, TUNING: bytes(range(23)), SAVE: b""}
        super().__init__({**IDENTITY, **replies})

    def set_gains(self, payload: bytes) -> bytes:
        self.gains = payload
        return b""


class StubbornFirmware(TunedFirmware):
    """A firmware that accepts gains and ignores them."""

    def set_gains(self, payload: bytes) -> bytes:
        return b""


def test_a_setting_is_written_and_read_back() -> None:
    async def main() -> None:
        firmware = TunedFirmware()
        async with controller_of(firmware) as controller:
            settings = controller.settings
            assert await settings.get("BF_PID_PITCH_I") == 44
            assert await settings.set("BF_PID_PITCH_I", 90) == 90
            assert firmware.gains == bytes([40, 41, 42, 43, 90, *range(45, 55)])
            assert await settings.get("BF_RATE_RC_EXPO") == 1
            await settings.save()
            assert firmware.received[-1].command == SAVE

    run_virtually(main())


def test_settings_that_are_set_at_the_same_time_do_not_undo_each_other() -> None:
    async def main() -> None:
        firmware = TunedFirmware()
        async with controller_of(firmware) as controller:
            names = ("BF_PID_ROLL_P", "BF_PID_PITCH_P", "BF_PID_YAW_P")
            await asyncio.gather(*(controller.settings.set(name, 7) for name in names))
            assert [firmware.gains[index] for index in (0, 3, 6)] == [7, 7, 7]

    run_virtually(main())


def test_all_settings_of_the_equipment_that_is_there() -> None:
    async def main() -> None:
        steps: list[tuple[int, int]] = []
        async with controller_of(TunedFirmware()) as controller:
            values = await controller.settings.all(lambda done, total: steps.append((done, total)))
            assert len(controller.settings.definitions()) > 250
        assert {name.rpartition("_")[0] for name in values} >= {"BF_PID_ROLL", "BF_PID_MAG"}
        assert len(values) == 15 + 17  # gains and rates; commands of others are refused
        assert steps[-1][0] == steps[-1][1]

    run_virtually(main())


def test_a_setting_that_does_not_stay_is_an_error() -> None:
    async def main() -> None:
        async with controller_of(StubbornFirmware()) as controller:
            with pytest.raises(
                MspSettingError, match=r"writing BF_PID_ROLL_P of .* failed: wrote 90, read 40 back"
            ):
                await controller.settings.set("BF_PID_ROLL_P", 90)

    run_virtually(main())


def test_wrong_settings_are_refused_before_anything_is_sent() -> None:
    async def main() -> None:
        firmware = TunedFirmware()
        async with controller_of(firmware) as controller:
            before = len(firmware.received)
            for name, value, error in (
                ("BF_PID_ROLL_P", 251, InvalidArgumentError),
                ("BF_WINGS", 1, InvalidArgumentError),
                ("BF_THR_HOVER", 1, MspFirmwareError),
            ):
                with pytest.raises(error, match=name):
                    await controller.settings.set(name, value)
            assert len(firmware.received) == before
            with pytest.raises(MspDenied):
                await controller.settings.get("BF_OSD_UNITS")

    run_virtually(main())
