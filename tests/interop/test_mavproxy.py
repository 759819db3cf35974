"""MAVProxy as a ground station, in a process of its own, against our servers."""

from __future__ import annotations

import asyncio
import os
import sys
from contextlib import asynccontextmanager, suppress
from importlib.util import find_spec

import pytest

from mavstack.dialects import common
from mavstack.services.mission import MissionItem, Plan
from mavstack.services.parameters import ParameterWritten
from tests.interop.vehicle import vehicle_on_udp

pytestmark = [
    pytest.mark.interop,
    pytest.mark.skipif(find_spec("MAVProxy") is None, reason="MAVProxy is not installed"),
]

#: Longer than anything takes on a busy machine.
PATIENCE = 60.0


class Console:
    """Its command line: says a line, waits for what it prints."""

    def __init__(self, process: asyncio.subprocess.Process) -> None:
        self._process = process
        self._text = ""

    def say(self, line: str) -> None:
        self._process.stdin.write(line.encode() + b"\n")

    async def hear(self, wanted: str) -> None:
        """Wait for a text; what comes after it is left for the next."""
        try:
            async with asyncio.timeout(PATIENCE):
                while wanted not in self._text:
                    more = await self._process.stdout.read(4096)
                    assert more, f"MAVProxy ended: {self._text}"
                    self._text += more.decode(errors="replace")
        except TimeoutError:
            raise AssertionError(f"no {wanted!r} in: {self._text}") from None
        self._text = self._text.partition(wanted)[2]


@asynccontextmanager
async def mavproxy(port: int, directory):
    command = (
        *(sys.executable, "-W", "ignore", "-m", "MAVProxy.mavproxy", f"--master=udpout:127.0.0.1:{port}"),
        *("--nowait", f"--state-basedir={directory}", f"--logfile={directory / 'telemetry.log'}"),
        "--default-modules=param,mode,arm,wp,cmdlong,ftp,link",
    )
    process = await asyncio.create_subprocess_exec(
        *command,
        stdin=asyncio.subprocess.PIPE,
        stdout=asyncio.subprocess.PIPE,
        stderr=asyncio.subprocess.STDOUT,
        cwd=directory,
        env={**os.environ, "HOME": str(directory)},
    )
    try:
        yield Console(process)
    finally:
        with suppress(ProcessLookupError):
            process.kill()
        await process.communicate()


async def test_it_controls_our_vehicle(tmp_path) -> None:
    (tmp_path / "files").mkdir()
    (tmp_path / "files" / "hello.txt").write_bytes(b"hello there")
    async with (
        vehicle_on_udp(autopilot=common.MavAutopilot.ARDUPILOTMEGA, root=tmp_path / "files") as (
            vehicle,
            port,
        ),
        mavproxy(port, tmp_path) as console,
    ):
        vehicle.mission.replace(Plan.of([MissionItem(common.MavCmd.NAV_WAYPOINT, param7=7.0)] * 25))
        await console.hear("Detected vehicle 1:1")
        await console.hear("Received 44 parameters")
        async with vehicle.events(ParameterWritten) as written:
            console.say("param set GAIN 0.5")
            await anext(written)
        console.say("mode GUIDED")
        await console.hear("Mode GUIDED")
        console.say("arm throttle")
        await console.hear("ARMED")
        assert vehicle.is_armed
        assert vehicle.modes.current.custom_mode == 4
        assert vehicle.parameters["GAIN"] == 0.5
        console.say("wp save plan.txt")
        await console.hear("Saved 25 waypoints")
        vehicle.mission.replace(Plan(common.MavMissionType.MISSION))
        console.say("wp load plan.txt")
        await console.hear("Loaded 25 waypoints")
        await console.hear("TYPE_MISSION: ACCEPTED")
        assert len(vehicle.mission.plan(common.MavMissionType.MISSION)) == 25
        console.say("ftp get hello.txt")
        await console.hear("Wrote 11 bytes")
        console.say("ftp list /")
        await console.hear("Total size")  # by then it has closed the file
        assert (tmp_path / "hello.txt").read_bytes() == b"hello there"
