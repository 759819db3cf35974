"""Flashing a megabyte over a pseudo terminal, beside the classic uploader of PX4 in the same run.

The board is the simulated one, in a separate process; the uploaders take turns, each as a program, so that
the start of the interpreter is a part of both.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING, Final

from mavstack.flashing.json_container import make_container

from .measure import OURS, Ratio, Row, take_turns

if TYPE_CHECKING:
    from collections.abc import Iterator

    from .rows import Bench

SIZE: Final = 1_000_000
BOARD: Final = 50
#: Seconds in which a megabyte must be written and verified.
TARGET: Final = 2.0
PEER: Final = "autopilot-tools"
_UPLOAD: Final = """
import sys
from autopilot_tools.px4._px_uploader import px_uploader

px_uploader(sys.argv[1:2], sys.argv[2])
"""
_OURS: Final = """
import asyncio, sys, time
from mavstack.flashing.bootloader_client import flash, identify, reboot
from mavstack.flashing.bootloader_port import BootloaderPort, port_url
from mavstack.flashing import read_firmware

async def main():
    firmware = read_firmware(sys.argv[1])
    started = time.perf_counter()
    async with BootloaderPort(port_url(sys.argv[2], 115200)) as port:
        board = await port.run(identify())
        await port.run(flash(firmware, board))
        await port.run(reboot())
    print("Elapsed Time", time.perf_counter() - started)

asyncio.run(main())
"""


@contextmanager
def _board(terminal: Path) -> Iterator[None]:
    words = [
        sys.executable,
        "-m",
        "mavstack",
        "sim",
        "--bootloader",
        "px4",
        "--out",
        f"pty://{terminal}",
        "--json",
    ]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as program:
        assert program.stdout is not None
        program.stdout.readline()
        try:
            yield
        finally:
            program.terminate()


def _seconds(script: str, firmware: Path, terminal: Path) -> float:
    """Flash a new board; return the seconds that the uploader reports."""
    with _board(terminal):
        time.sleep(0.1)
        done = subprocess.run(
            [sys.executable, "-c", script, str(firmware), str(terminal)],
            capture_output=True, text=True, check=True, timeout=120,
        )  # fmt: skip
    return float(done.stdout.rpartition("Elapsed Time")[2].split()[0])


def rows(bench: Bench) -> Iterator[Row]:
    """Measure flashing, beside the classic uploader and the target."""
    with tempfile.TemporaryDirectory(prefix="mavstack-bench-") as folder:
        firmware, terminal = Path(folder) / "firmware.px4", Path(folder) / "tty"
        image = b"\x00\x10\x00\x20" + Random(1).randbytes(SIZE - 4)
        firmware.write_bytes(make_container(image, BOARD, image_maxsize=2_064_384))
        work = {
            OURS: lambda: _seconds(_OURS, firmware, terminal),
            PEER: lambda: _seconds(_UPLOAD, firmware, terminal),
        }
        found = take_turns(work, max(bench.amounts.turns // 2, 3))
    ours, theirs = found[OURS], found[PEER]
    figures = {OURS: f"{statistics.median(ours):.2f} s", PEER: f"{statistics.median(theirs):.2f} s"}
    ratios = (
        Ratio(f"of {TARGET:g} s", tuple(each / TARGET for each in ours), 1, higher_is_better=False),
        Ratio(
            f"time of {PEER}",
            tuple(a / b for a, b in zip(ours, theirs, strict=True)),
            1,
            higher_is_better=False,
        ),
    )
    yield Row("flash 1 MB over a terminal", figures, ratios)
