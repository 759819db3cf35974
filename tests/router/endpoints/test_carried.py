from __future__ import annotations

import asyncio
from pathlib import Path

import pytest
from websockets.asyncio.client import connect

from mavstack import Parser, encode
from mavstack.dialects import common
from mavstack.links.ws import WsChannel
from mavstack.router import RouterEngine
from mavstack.router.config import EndpointConfig, Recording
from mavstack.router.endpoints import LISTENING
from mavstack.router.endpoints.carried import MAX_CHUNK, _chunks
from mavstack.router.snapshot import take_snapshot
from mavstack.security import SigningKey
from tests.router.peers import DIALECT, TIMEOUT, UdpPeer, arm, heartbeat, names, port, routing, until

VEHICLE = EndpointConfig("vehicle", "udpin://127.0.0.1:0")
WEB = EndpointConfig("web", "wsin://127.0.0.1:0")
RECORDING = Path(__file__).parents[2] / "recordings" / "flight.tlog"


async def receive(socket):
    async with asyncio.timeout(TIMEOUT):
        return await socket.recv()


async def test_websocket_messages_hold_one_or_more_packets():
    async with routing(VEHICLE, WEB) as router:
        endpoint = router.endpoints["web"]
        with UdpPeer(port(router, "vehicle")) as vehicle:
            async with connect(f"ws://127.0.0.1:{port(router, 'web')}", proxy=None) as socket:
                await until(lambda: endpoint.numbers)
                vehicle.send(b"".join(heartbeat(sequence=number) for number in range(50)))
                received = b""
                while len(received) < 50 * len(heartbeat()):
                    received += await receive(socket)
                assert received == b"".join(heartbeat(sequence=number) for number in range(50))
                await socket.send(heartbeat(255) + heartbeat(254))
                assert await vehicle.receive() + await vehicle.receive() == heartbeat(255) + heartbeat(254)
            await until(lambda: endpoint.state == LISTENING)
            assert not endpoint.numbers


async def test_packets_for_a_slow_channel_wait_in_the_engine(monkeypatch):
    room, send = asyncio.Event(), WsChannel.send_bytes
    monkeypatch.setattr(WsChannel, "send_bytes", lambda self, data: room.is_set() and send(self, data))
    monkeypatch.setattr(WsChannel, "drain", lambda self: room.wait())
    async with routing(VEHICLE, WEB) as router:
        endpoint = router.endpoints["web"]
        with UdpPeer(port(router, "vehicle")) as vehicle:
            async with connect(f"ws://127.0.0.1:{port(router, 'web')}", proxy=None) as socket:
                await until(lambda: endpoint.numbers)
                (number,) = endpoint.numbers
                for sequence in range(5):
                    vehicle.send(heartbeat(sequence=sequence))
                    await until(lambda sent=sequence: counters(router, number).sent == sent + 1)
                    await asyncio.sleep(0)
                assert counters(router, number).queued > 0
                assert endpoint.dropped == {number: 0}
                room.set()
                received = b""
                while len(received) < 5 * len(heartbeat()):
                    received += await receive(socket)
                assert received == b"".join(heartbeat(sequence=sequence) for sequence in range(5))


def counters(router, number):
    return router.statistics().endpoints[number]


def test_chunks_are_bounded():
    packets = [bytes(280)] * 40
    chunks = list(_chunks(packets))
    assert sum(count for count, _ in chunks) == 40
    assert b"".join(chunk for _, chunk in chunks) == b"".join(packets)
    assert len(chunks) == 3
    assert all(len(chunk) <= MAX_CHUNK for _, chunk in chunks)
    assert list(_chunks([bytes(5000)])) == [(1, bytes(5000))]


async def test_impaired_links_are_carried():
    async with routing(VEHICLE, EndpointConfig("ground", "udpin://127.0.0.1:0?latency=1ms")) as router:
        with UdpPeer(port(router, "vehicle")) as vehicle, UdpPeer(port(router, "ground")) as ground:
            vehicle.send(heartbeat())
            ground.send(heartbeat(255))
            assert await vehicle.receive() == heartbeat(255)


async def test_a_recording_is_replayed_and_ends():
    url = f"file://{RECORDING}?speed=max"
    async with routing(EndpointConfig("ground", "udpin://127.0.0.1:0")) as router:
        with UdpPeer(port(router, "ground")) as ground:
            ground.send(heartbeat(255))
            await until(lambda: router.statistics().routes)
            await router.add(EndpointConfig("replay", url))
            assert names(await ground.receive())
            await until(lambda: router.endpoints["replay"].state == "ended")


async def test_a_recording_waits_for_room_and_loses_nothing(tmp_path, monkeypatch):
    packets = [heartbeat(sequence=number) for number in range(100)]
    source, target = tmp_path / "packets.bin", tmp_path / "copy.tlog"
    source.write_bytes(b"".join(packets))
    refusals, push = iter([False] * 3), RouterEngine.push
    monkeypatch.setattr(
        RouterEngine, "push", lambda self, number, data: next(refusals, True) and push(self, number, data)
    )
    async with routing(EndpointConfig("box", record=Recording(str(target)))) as router:
        await router.add(EndpointConfig("replay", f"file://{source}?speed=max"))
        await until(lambda: target.stat().st_size == 100 * (8 + len(packets[0])))
        assert not any(router.endpoints["replay"].dropped.values())


async def test_bytes_that_come_faster_than_they_are_routed_are_counted(monkeypatch):
    monkeypatch.setattr(RouterEngine, "push", lambda *_: False)
    async with (
        routing(WEB) as router,
        connect(f"ws://127.0.0.1:{port(router, 'web')}", proxy=None) as socket,
    ):
        await socket.send(heartbeat())
        await until(lambda: list(router.endpoints["web"].dropped.values()) == [1])


async def test_high_latency_sends_summaries_instead_of_telemetry():
    with UdpPeer() as ground:
        satellite = EndpointConfig("satellite", f"udpout://127.0.0.1:{ground.port}", high_latency=0.02)
        async with routing(VEHICLE, satellite) as router:
            with UdpPeer(port(router, "vehicle")) as vehicle:
                vehicle.send(heartbeat() + encode(common.Attitude(), system=1, component=1))
                vehicle.send(encode(common.CommandAck(command=400), system=1, component=1))
                received = names(await ground.receive() + await ground.receive())
                assert sorted(received) == ["COMMAND_ACK", "HIGH_LATENCY2"]
                (packet,) = Parser(DIALECT).feed(await ground.receive())
                assert (packet.name, packet.system) == ("HIGH_LATENCY2", 1)
                assert packet.message.autopilot == common.MavAutopilot.PX4
                ground.send(heartbeat(255))
                assert await vehicle.receive() == heartbeat(255)
                (number,) = router.endpoints["satellite"].numbers
                assert (
                    take_snapshot(router).endpoints[1].sent
                    == router.endpoints["satellite"].sent[number][0]
                    >= 3
                )


async def test_two_routers_make_a_sealed_tunnel(tmp_path):
    pytest.importorskip("cryptography")
    key = tmp_path / "fleet.key"
    SigningKey.generate().save(key)
    inside = EndpointConfig("inside", "udpin://127.0.0.1:0")
    listening = EndpointConfig("sealed", f"sealed+udpin://127.0.0.1:0?shared_key={key}")
    async with routing(inside, listening) as ground:
        address = f"127.0.0.1:{port(ground, 'sealed')}"
        connecting = EndpointConfig("sealed", f"sealed+udpout://{address}?shared_key={key}")
        async with routing(inside, connecting) as vehicle:
            with UdpPeer(port(ground, "inside")) as station, UdpPeer(port(vehicle, "inside")) as autopilot:
                await until(lambda: len(ground.statistics().endpoints) == 2)
                station.send(heartbeat(255, 190))
                await until(lambda: vehicle.statistics().routes)
                autopilot.send(heartbeat())
                assert await station.receive() == heartbeat()
                station.send(arm())
                assert names((await autopilot.receive())[-len(arm()) :]) == ["COMMAND_LONG"]
