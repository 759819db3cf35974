"""A sealed UDP link beside a plain one in one run: the row `sealed`, and `python -m benchmarks.sealed`.

Two links of one process on the loopback, without nodes: the packets of a flight are written in bursts of
what a flight controller sends at once, and counted by their bytes at the other end. A sealed link joins the
packets of a burst to datagrams; the plain link sends each alone.
"""

from __future__ import annotations

import asyncio
import statistics
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple

from cryptography.hazmat.primitives.ciphers import Cipher
from cryptography.hazmat.primitives.ciphers.algorithms import AES
from cryptography.hazmat.primitives.ciphers.modes import CTR

from mavstack import open_link
from mavstack.links import BytesReceived, ChannelOpened
from mavstack.security import SigningKey
from mavstack.wire import crc16

from . import workload
from .measure import OURS, Ratio, Row

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from mavstack.links import LinkEvent
    from mavstack.links.base import Link

    from .rows import Bench

PACKETS: Final = 100_000
BURST: Final = 32
#: Packets per second that a sealed link must carry.
TARGET: Final = 150_000
PLAIN, SEALED = "plain", "sealed, ChaCha20-Poly1305"
#: Bytes under way, which the sockets can hold.
_MAX_AHEAD: Final = 64 << 10


class Rate(NamedTuple):
    """Packets per second of time, and of processor time, which other programs do not change."""

    wall: float
    processor: float


async def _turn(listening: str, connecting: str, query: str, packets: list[bytes]) -> Rate:
    """Send all packets, none of which may be lost."""
    async with (
        open_link(f"{listening}://127.0.0.1:0?{query}") as server,
        open_link(f"{connecting}://127.0.0.1:{_port(server)}?{query}") as client,
    ):
        event = await anext(client)
        while not isinstance(event, ChannelOpened):
            event = await anext(client)
        received = 0

        def count(events: Sequence[LinkEvent]) -> None:
            nonlocal received
            received += sum(len(each.data) for each in events if isinstance(each, BytesReceived))

        reader = asyncio.create_task(server.read(count))
        started, used = time.perf_counter(), time.process_time()
        sent = 0
        for at in range(0, len(packets), BURST):
            sent += sum(len(packet) for packet in packets[at : at + BURST] if event.channel.write(packet))
            await asyncio.sleep(0)
            while sent - received > _MAX_AHEAD:  # noqa: ASYNC110 (an event would cost time that is measured)
                await asyncio.sleep(0)
        deadline = time.perf_counter() + 1
        while received < sent and time.perf_counter() < deadline:  # noqa: ASYNC110 (the same)
            await asyncio.sleep(0)
        wall, processor = time.perf_counter() - started, time.process_time() - used
        reader.cancel()
    if received < sum(map(len, packets)):
        raise SystemExit(f"{listening}: packets were lost")
    return Rate(len(packets) / wall, len(packets) / processor)


def _port(link: Link) -> int:
    assert link.address is not None
    return link.address[1]


def _payloads_alone(packets: list[bytes]) -> Rate:
    """Encrypt the payload of each packet by AES-128 in counter mode, with a new CRC, without authentication.

    This is the structure of MAVShield (arXiv 2504.20626) with another cipher; sending is not included.
    """
    key = bytes(16)
    started, used = time.perf_counter(), time.process_time()
    for number, packet in enumerate(packets):
        encryptor = Cipher(AES(key), CTR(number.to_bytes(16))).encryptor()
        body = packet[1:10] + encryptor.update(packet[10:-2])
        crc16(body)
    return Rate(len(packets) / (time.perf_counter() - started), len(packets) / (time.process_time() - used))


def measure(packets: list[bytes], turns: int) -> dict[str, list[Rate]]:
    """Return the rates of each kind of link, in turns."""
    with tempfile.TemporaryDirectory(prefix="mavstack-bench-") as folder:
        key = Path(folder) / "bench.key"
        SigningKey.generate().save(key)
        links = {
            PLAIN: ("udpin", "udpout", ""),
            SEALED: ("sealed+udpin", "sealed+udpout", f"shared_key={key}"),
            "sealed, AES-256-GCM": ("sealed+udpin", "sealed+udpout", f"shared_key={key}&cipher=aes256"),
            "sealed, packets alone": ("sealed+udpin", "sealed+udpout", f"shared_key={key}&mtu=21"),
        }
        rates: dict[str, list[Rate]] = {name: [] for name in links}
        for _ in range(turns):
            for name, link in links.items():
                rates[name].append(asyncio.run(_turn(*link, packets)))
    return rates


def rows(bench: Bench) -> Iterator[Row]:
    """Measure sealed UDP, beside a plain link and the target."""
    packets = list(workload.build(PACKETS).packets(PACKETS))
    rates = measure(packets, max(bench.amounts.turns // 2, 3))
    sealed, plain = ([each.wall for each in rates[name]] for name in (SEALED, PLAIN))
    figures = {OURS: f"{statistics.median(sealed):,.0f}/s (plain UDP {statistics.median(plain):,.0f}/s)"}
    yield Row(
        "sealed UDP", figures, (Ratio(f"of {TARGET:,} packets/s", tuple(x / TARGET for x in sealed), 1),)
    )


def main(turns: int = 5) -> None:
    """Measure in turns, and print a line for each kind of link."""
    packets = list(workload.build(PACKETS).packets(PACKETS))
    rates = measure(packets, turns)
    rates["payloads alone, AES-CTR, not sent"] = [_payloads_alone(packets) for _ in range(turns)]
    for name, values in rates.items():
        wall, processor = (statistics.median(each) for each in zip(*values, strict=True))
        print(f"UDP {name}: {wall:,.0f} packets/s, {processor:,.0f} per second of processor time")


if __name__ == "__main__":
    main()
