"""gpsd (Debian) reads the position of a vehicle that `mav serial --nmea` sends."""

from __future__ import annotations

import asyncio
import json
import shutil
import sys

import pytest

from mavstack.sim import BackgroundSimulator
from tests.interop.test_rtk_str2str import free_port

GPSD = shutil.which("gpsd") or shutil.which("gpsd", path="/usr/sbin")
pytestmark = [pytest.mark.interop, pytest.mark.skipif(GPSD is None, reason="gpsd is not installed")]
WATCH = b'?WATCH={"enable":true,"json":true};\n'


async def started(*words: str) -> asyncio.subprocess.Process:
    nothing = asyncio.subprocess.DEVNULL
    return await asyncio.create_subprocess_exec(*words, stdout=nothing, stderr=nothing)


async def position_of(port: int) -> dict:
    """The first report of gpsd with a position in three dimensions."""
    while True:
        try:
            reader, writer = await asyncio.open_connection("127.0.0.1", port)
            break
        except OSError:
            await asyncio.sleep(0.1)
    writer.write(WATCH)
    async for line in reader:
        report = json.loads(line)
        if report["class"] == "TPV" and report["mode"] == 3:
            writer.close()
            return report
    raise AssertionError("gpsd ended")


@pytest.mark.smoke
async def test_gpsd_has_the_position_of_the_vehicle():
    nmea, control = free_port(), free_port()
    with BackgroundSimulator(airborne=True) as simulator:
        gpsd = await started(GPSD, "-N", "-n", "-S", str(control), f"udp://127.0.0.1:{nmea}")
        words = ["serial", "--nmea", "--rate", "5", "--out", f"udpout://127.0.0.1:{nmea}"]
        mav = await started(sys.executable, "-m", "mavstack", *words, "--url", simulator.url)
        try:
            async with asyncio.timeout(60):
                found = await position_of(control)
        finally:
            for process in (mav, gpsd):
                process.terminate()
                await process.wait()
        truth = simulator.call(lambda: simulator.vehicle.body.truth)
        place = simulator.vehicle.body.frame.to_global(truth.north, truth.east, truth.down)
    assert found["lat"] == pytest.approx(place[0], abs=1e-4)
    assert found["lon"] == pytest.approx(place[1], abs=1e-4)
    assert found["altMSL"] == pytest.approx(place[2], abs=5)
