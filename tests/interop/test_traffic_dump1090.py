"""dump1090-mutability (Debian) as a receiver: its text and its frames become aircraft for vehicles."""

from __future__ import annotations

import asyncio
import shutil
import socket

import pytest

from mavstack import connect
from mavstack.sim import BackgroundSimulator
from mavstack.vehicle.traffic import TrafficFeed
from tests.interop.test_rtk_str2str import free_port

pytestmark = [
    pytest.mark.interop,
    pytest.mark.skipif(shutil.which("dump1090-mutability") is None, reason="dump1090 is not installed"),
]
#: Frames of one aircraft, 40621D: callsign, even and odd position, velocity of another report of 485020.
FRAMES = (
    "8D4840D6202CC371C32CE0576098",
    "8D40621D58C382D690C8AC2863A7",
    "8D40621D58C386435CC412692AD6",
    "8D485020994409940838175B284F",
)


@pytest.mark.smoke
async def test_the_text_and_the_frames_of_dump1090():
    raw, sbs, beast = (free_port() for _ in range(3))
    words = [
        "dump1090-mutability", "--net-only", "--quiet", "--net-bind-address", "127.0.0.1",
        "--net-ri-port", str(raw), "--net-ro-port", "0", "--net-sbs-port", str(sbs),
        "--net-bo-port", str(beast), "--net-bi-port", "0",
        "--net-http-port", "0",
    ]  # fmt: skip
    process = await asyncio.create_subprocess_exec(
        *words, stdout=asyncio.subprocess.DEVNULL, stderr=asyncio.subprocess.DEVNULL
    )
    try:
        await _wait_for_port(raw)
        with BackgroundSimulator() as simulator:
            async with (
                connect(simulator.url) as connection,
                TrafficFeed(connection, f"sbs://127.0.0.1:{sbs}") as text,
                TrafficFeed(connection, f"beast://127.0.0.1:{beast}") as frames,
            ):
                await _feed(raw, text, frames)
                for feed in (text, frames):
                    _check(feed)
    finally:
        process.terminate()
        await process.wait()


def _check(feed: TrafficFeed) -> None:
    known = {each.address: each for each in feed.aircraft.all()}
    assert known.keys() >= {0x40621D, 0x4840D6, 0x485020}
    assert known[0x4840D6].callsign.strip() == "KLM1023"
    place = known[0x40621D]
    assert (place.latitude, place.longitude) == pytest.approx((52.2572, 3.9194), abs=0.03)
    assert place.altitude == pytest.approx(38_000 * 0.3048, abs=10)
    assert known[0x485020].speed == pytest.approx(159 * 0.5144, abs=2)


async def _wait_for_port(port: int) -> None:
    for _ in range(100):
        try:
            socket.create_connection(("127.0.0.1", port), 1).close()
        except OSError:
            await asyncio.sleep(0.1)
        else:
            return
    raise AssertionError("dump1090 does not listen")


async def _feed(port: int, *feeds: TrafficFeed) -> None:
    """Send the frames again and again until all feeds have them."""
    _, writer = await asyncio.open_connection("127.0.0.1", port)
    for _ in range(60):
        writer.write("".join(f"*{frame};\n" for frame in FRAMES).encode())
        await asyncio.sleep(0.25)
        located = [[each for each in feed.aircraft.all() if each.latitude] for feed in feeds]
        if all(located) and all(len(feed.aircraft) >= 3 for feed in feeds):
            break
    writer.close()
