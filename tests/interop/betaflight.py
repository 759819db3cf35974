"""Betaflight's own SITL program, which speaks MSP on TCP port 5761.

The environment variable MAVSTACK_BETAFLIGHT_SITL holds the path of the program: a SITL build with display,
video transmitter and beeper (USE_OSD, USE_OSD_SD, USE_OSD_HD, USE_VTX, USE_BEEPER), which its target leaves
out by default. Its port is fixed, so one runs at a time on a machine. The first run only writes the EEPROM,
a file in the working folder; a restart by MSP ends the program.
"""

from __future__ import annotations

import asyncio
import os
import shutil
import socket
import struct
import subprocess
import sys
import tempfile
import time
from contextlib import asynccontextmanager, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from tests.waiting import wait_until

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Iterator

PROGRAM_VARIABLE = "MAVSTACK_BETAFLIGHT_SITL"
PORT = 5761
URL = f"msp+tcp://127.0.0.1:{PORT}"
EEPROM_SIZE = 32768
#: UDP port for the packets of a flight simulator.
SIMULATOR_PORT = 9003
SIMULATOR_INTERVAL = 0.005
GRAVITY = 9.80665

PROGRAM = shutil.which(os.environ.get(PROGRAM_VARIABLE, ""))
needs_betaflight = pytest.mark.skipif(
    PROGRAM is None, reason=f"{PROGRAM_VARIABLE} names no SITL program of Betaflight"
)


def at_rest(gravity: float) -> tuple[float, ...]:
    """Return angular rates, acceleration, attitude, velocity, longitude, latitude, altitude and pressure."""
    return (0, 0, 0, 0, 0, -gravity, 1, 0, 0, 0, 0, 0, 0, 8.545594, 47.397742, 488.0, 95_600.0)


@contextmanager
def _alone() -> Iterator[None]:
    """Wait until no other test of the machine uses the port."""
    assert sys.platform != "win32"
    import fcntl

    with Path(tempfile.gettempdir(), "mavstack-betaflight-sitl.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


class BetaflightSitl:
    """The program in a folder of its own, which holds its EEPROM."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._process: subprocess.Popen[bytes] | None = None

    async def start(self) -> None:
        """Start the program, and wait until it listens."""
        if not (self._folder / "eeprom.bin").exists():
            self._run()
            await wait_until(self._has_eeprom, "Betaflight's first run writes its EEPROM")
            self.stop()
        self._run()
        await wait_until(_listens, "Betaflight's SITL listens")

    async def restart(self) -> None:
        """Start the program again; what was not saved is lost."""
        self.stop()
        await self.start()

    async def wait_for_exit(self) -> None:
        """Wait until the program has ended, as it does when it restarts."""
        await asyncio.to_thread(self._process.wait, 20)

    def stop(self) -> None:
        """End the program. Idempotent."""
        if self._process is not None:
            self._process.kill()
            self._process.wait(timeout=20)
            self._process = None

    def _run(self) -> None:
        assert PROGRAM is not None
        assert not _listens(), f"another program uses port {PORT}"
        self._process = subprocess.Popen(
            [PROGRAM],
            cwd=self._folder,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )

    def _has_eeprom(self) -> bool:
        path = self._folder / "eeprom.bin"
        return path.exists() and path.stat().st_size >= EEPROM_SIZE and _listens()


def _listens() -> bool:
    """Look the port up: a connection that closes would take the next one with it."""
    sockets = Path("/proc/net/tcp").read_text("ascii").splitlines()[1:]
    return any(line.split()[1].endswith(f":{PORT:04X}") and line.split()[3] == "0A" for line in sockets)


@asynccontextmanager
async def flight_simulator(gravity: float = GRAVITY) -> AsyncIterator[None]:
    """Send the packets of a simulator whose vehicle is at rest, as long as the block runs.

    `gravity` is the acceleration that the sensor measures, in m/s². Betaflight reads its receiver in the loop
    of its gyroscope, which has values only by such packets: without them its channels and its reasons not to
    arm stay as they are at the start.
    """
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:

        async def send() -> None:
            start = time.monotonic()
            while True:
                packet = struct.pack("<18d", time.monotonic() - start, *at_rest(gravity))
                sender.sendto(packet, ("127.0.0.1", SIMULATOR_PORT))
                await asyncio.sleep(SIMULATOR_INTERVAL)

        task = asyncio.create_task(send())
        try:
            yield
        finally:
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)


@contextmanager
def betaflight_sitl(folder: Path) -> Iterator[BetaflightSitl]:
    """Run Betaflight's SITL with the EEPROM of a folder; `start` starts it."""
    with _alone():
        sitl = BetaflightSitl(folder)
        try:
            yield sitl
        finally:
            sitl.stop()
