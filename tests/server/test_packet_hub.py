from __future__ import annotations

import asyncio
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import pytest

from mavstack.dialects import common
from mavstack.server.packet_hub import MAX_INTERVAL, MIN_INTERVAL, PacketHub
from mavstack.sim.virtual import run_virtually
from mavstack.wire import Encoder, Parser

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.server.packet_hub import Batch
    from mavstack.wire import Packet

PACKET = Parser(common).feed(Encoder(1, 1).encode(common.Attitude()))[0]


class Connection:
    """Stands for a connection: calls the listener of the hub."""

    receive: Callable[[Packet], None]

    def add_packet_listener(self, _: None, callback: Callable[[Packet], None]) -> None:
        self.receive = callback

    def now(self) -> float:
        return asyncio.get_running_loop().time()


class Client:
    """Keeps the times of batches and the numbers of their packets."""

    def __init__(self) -> None:
        self.batches: list[tuple[float, int]] = []

    def put(self, batch: Batch) -> None:
        self.batches.append((asyncio.get_running_loop().time(), len(batch.packets)))


def batches(clients: int, interval: float, count: int) -> list[tuple[float, int]]:
    """Return the batches of one client, with the seconds since the first packet."""
    first = Client()

    async def run() -> None:
        connection: Any = Connection()
        hub = PacketHub(connection)
        hub.open()
        hub.clients = {first, *(Client() for _ in range(clients - 1))}
        await asyncio.sleep(1)
        begun = asyncio.get_running_loop().time()
        for _ in range(count):
            connection.receive(PACKET)
            await asyncio.sleep(interval)
        await asyncio.sleep(1)
        first.batches[:] = [(time - begun, packets) for time, packets in first.batches]

    run_virtually(run())
    return first.batches


@pytest.mark.parametrize("clients", [1, 100])
def test_packets_after_a_pause_are_handed_on_at_once(clients: int) -> None:
    times, packets = zip(*batches(clients, 0.1, 5), strict=True)
    assert times == pytest.approx([0, 0.1, 0.2, 0.3, 0.4], abs=1e-4)
    assert packets == (1,) * 5


def test_a_packet_after_a_pause_waits_for_no_turn_of_the_loop() -> None:
    client = Client()

    async def run() -> None:
        connection: Any = Connection()
        hub = PacketHub(connection)
        hub.open()
        hub.clients.add(client)
        await asyncio.sleep(1)
        for _ in range(3):
            connection.receive(PACKET)
        assert [packets for _, packets in client.batches] == [1]
        await asyncio.sleep(1)
        assert [packets for _, packets in client.batches] == [1, 2]

    run_virtually(run())


@pytest.mark.parametrize(("clients", "interval"), [(1, MIN_INTERVAL), (10, 0.01), (100, MAX_INTERVAL)])
def test_packets_that_follow_closely_are_handed_on_together(clients: int, interval: float) -> None:
    found = batches(clients, 0.0005, 2000)
    assert sum(packets for _, packets in found) == 2000
    times = [time for time, _ in found]
    assert times[0] == pytest.approx(0, abs=1e-4)
    gaps = [after - before for before, after in pairwise(times)]
    assert min(gaps) >= interval - 1e-6
    assert max(gaps) == pytest.approx(interval, abs=0.001)
