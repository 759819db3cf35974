"""The client's CLI, dump, restore and pass-through against Betaflight's own SITL program."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING

import pytest

from mavstack.bridges.msp import FlightController
from mavstack.errors import MspDenied
from mavstack.msp import FrameVersion
from mavstack.msp.messages import FcVariant
from tests.interop.betaflight import URL, betaflight_sitl, needs_betaflight

if TYPE_CHECKING:
    from collections.abc import AsyncIterator
    from pathlib import Path

pytestmark = [pytest.mark.interop, needs_betaflight]

SETTING = "gyro_lpf1_static_hz"


@asynccontextmanager
async def board(folder: Path) -> AsyncIterator[FlightController]:
    """A client of a program that is started again when it ends, as a board restarts."""
    with betaflight_sitl(folder) as sitl:
        await sitl.start()

        async def keep_running() -> None:
            while True:
                await sitl.wait_for_exit()
                await sitl.restart()

        task = asyncio.create_task(keep_running())
        try:
            async with FlightController(URL) as controller:
                yield controller
        finally:
            task.cancel()
            sitl.stop()
            await asyncio.gather(task, return_exceptions=True)


async def test_lines_dump_and_restore(tmp_path: Path) -> None:
    async with board(tmp_path) as controller:
        async with controller.cli() as cli:
            assert "Betaflight / SITL" in await cli.run("version")
            assert (await cli.run(f"get {SETTING}")).startswith(f"{SETTING} = 250")
            assert "INVALID NAME" in await cli.run("set nonsense = 1")
            dump = await cli.dump("dump all")
            assert dump.count("\n") > 800
            assert f"set {SETTING} = 250" in dump
        text = await controller.dump()
        changed = text.replace("\nsave\n", f"\nprofile 0\nset {SETTING} = 222\n\nsave\n")
        assert await controller.restore(changed) > 10
        assert f"set {SETTING} = 222" in await controller.dump()
        with pytest.raises(MspDenied, match="nothing was saved"):
            await controller.restore(changed.replace("222", "333\nset nonsense = 1"))
        await controller.wait_for_restart()
        assert f"set {SETTING} = 222" in await controller.dump()


async def test_encodings_passthrough_and_reboot(tmp_path: Path) -> None:
    async with board(tmp_path) as controller:
        for version in (FrameVersion.V1, FrameVersion.V2, FrameVersion.V2_OVER_V1):
            assert await controller.request(FcVariant.COMMAND, version=version) == b"BTFL"
        with pytest.raises(MspDenied, match="refused by the firmware"):
            await controller.request(0x2FFF)
        with pytest.raises(MspDenied, match="connecting serial port 60"):
            async with controller.passthrough(60):
                pass
        await controller.reboot()
        assert controller.info.variant == "BTFL"
