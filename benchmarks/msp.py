"""Round trips of MSP beside YAMSPy: the row `msp`.

A program on a pseudo terminal replies to MSP_ATTITUDE as soon as it is asked, so the figure is the cost of
the client. YAMSPy is measured by its general functions, which verify the checksum as ours do, and by its
function for this message alone, which reads a fixed number of bytes and verifies nothing.
"""

from __future__ import annotations

import asyncio
import os
import pty
import subprocess
import sys
import time
import tty
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.msp import FlightController
from mavstack.msp import Direction, Frame
from mavstack.msp.messages.sensors import Attitude

from .measure import OURS, Row, speed_ratio, take_turns

if TYPE_CHECKING:
    from collections.abc import Iterator

    from .rows import Bench

YAMSPY, FAST = "YAMSPy", "YAMSPy, fast_read_attitude"
ATTITUDE: Final = 108
REPLIES: Final = {
    1: b"\x00\x01\x2e",
    2: b"BTFL",
    3: b"\x04\x05\x01",
    4: b"S405\x00\x00",
    5: b"Nov 22 202621:10:03abc1234",
    10: b"",
    160: bytes(12),
    ATTITUDE: bytes(6),
}
#: The program at the other end: requests of v1 without payload have six bytes.
PROGRAM: Final = """
import os, sys
terminal, replies = int(sys.argv[1]), eval(sys.argv[2])
data = b""
while True:
    data += os.read(terminal, 4096)
    while len(data) >= 6:
        os.write(terminal, replies.get(data[4], b"$M!\\0" + data[4:5] * 2))
        data = data[6:]
"""


def rows(bench: Bench) -> Iterator[Row]:
    """Measure round trips of one message."""
    try:
        import yamspy
    except ImportError:
        yield Row("MSP round trip", {YAMSPY: "not installed"}, ())
        return
    count = bench.amounts.slow // 20
    with _controller() as ours, _controller() as theirs:
        peer = yamspy.MSPy(theirs, logfilename=None, loglevel="CRITICAL")
        peer.conn.open()
        loop = asyncio.new_event_loop()
        client = loop.run_until_complete(FlightController(f"serial://{ours}").open())
        work = {
            OURS: lambda: loop.run_until_complete(_ours(client, count)),
            YAMSPY: lambda: _general(peer, count),
            FAST: lambda: _fast(peer, count),
        }
        results = take_turns(work, bench.amounts.turns)
        loop.run_until_complete(client.close())
        loop.close()
        peer.conn.close()
    figures = {name: f"{1e6 * sorted(times)[len(times) // 2]:.0f} µs" for name, times in results.items()}
    title = "MSP round trip: " + ", ".join(f"{name} {figure}" for name, figure in figures.items())
    yield Row(
        title, {OURS: figures[OURS]}, (speed_ratio(results, YAMSPY, 1.0), speed_ratio(results, FAST, None))
    )


async def _ours(client: FlightController, count: int) -> float:
    start = time.perf_counter()
    for _ in range(count):
        await client.get(Attitude)
    return (time.perf_counter() - start) / count


def _general(peer: Any, count: int) -> float:  # noqa: ANN401 (it has no types)
    start = time.perf_counter()
    for _ in range(count):
        peer.send_RAW_msg(ATTITUDE)
        peer.process_recv_data(peer.receive_msg())
    return (time.perf_counter() - start) / count


def _fast(peer: Any, count: int) -> float:  # noqa: ANN401 (it has no types)
    start = time.perf_counter()
    for _ in range(count):
        peer.fast_read_attitude()
    return (time.perf_counter() - start) / count


@contextmanager
def _controller() -> Iterator[str]:
    """Run a program that replies to requests; yield its terminal."""
    near, far = pty.openpty()
    tty.setraw(far)
    replies = {each: Frame(each, data, Direction.RESPONSE).encode() for each, data in REPLIES.items()}
    program = subprocess.Popen([sys.executable, "-c", PROGRAM, str(near), repr(replies)], pass_fds=[near])
    try:
        yield os.ttyname(far)
    finally:
        program.kill()
        program.wait()
        os.close(near)
        os.close(far)
