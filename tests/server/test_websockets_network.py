"""WebSockets over real sockets: the handshake, and packets in both directions."""

from __future__ import annotations

import asyncio
import json

import pytest
from websockets.asyncio.client import connect
from websockets.exceptions import InvalidStatus

from mavstack.dialects import common
from mavstack.http.server import serving
from mavstack.security.roles import Role
from mavstack.server.access import Access
from mavstack.server.app import make_app
from mavstack.server.station import Station
from mavstack.wire import Encoder

HEARTBEAT = common.Heartbeat(type=2, autopilot=3, mavlink_version=3)


class Vehicle(asyncio.DatagramProtocol):
    """A peer that sends heartbeats and keeps what it receives."""

    def __init__(self) -> None:
        self.received: asyncio.Queue[bytes] = asyncio.Queue()

    def datagram_received(self, data: bytes, address: object) -> None:
        self.received.put_nowait(data)


async def test_packets_and_json_over_real_sockets() -> None:
    async with Station(telemetry=False) as station:
        source = await station.sources.add("udpin://127.0.0.1:0?trust_senders=yes")
        loop = asyncio.get_running_loop()
        transport, peer = await loop.create_datagram_endpoint(Vehicle, remote_addr=source.link.address)
        app = make_app(station, Access(), static=None)
        heartbeat = Encoder(1, 1).encode(HEARTBEAT)
        async with (
            asyncio.timeout(20),
            serving(app, "127.0.0.1:0", name="the station", websockets=True) as (host, port),
            connect(f"ws://{host}:{port}/ws", subprotocols=["mavstack.raw.1"]) as raw,
            connect(f"ws://{host}:{port}/ws", subprotocols=["mavstack.json.1"]) as decoded,
        ):
            await decoded.send(json.dumps({"subscribe": ["HEARTBEAT"], "system": 1}))
            await decoded.send(json.dumps({}))
            assert "error" in json.loads(await decoded.recv())  # so the subscription has been made
            transport.sendto(heartbeat)
            assert await raw.recv() == heartbeat
            message = json.loads(await decoded.recv())
            assert (message["message"], message["fields"]["autopilot"]) == ("HEARTBEAT", 3)
            command = common.CommandLong(target_system=1, target_component=1, command=400, param1=1)
            sent = Encoder(245, 191).encode(command)
            await raw.send(sent)
            while await peer.received.get() != sent:
                pass
            sticks = Encoder(245, 191)
            positions = [sticks.encode(common.ManualControl(target=1, x=x)) for x in range(50)]
            for each in positions:
                await raw.send(each)
            arrived = []
            while positions[-1] not in arrived:
                arrived.append(await peer.received.get())
            assert [each for each in arrived if each in positions] == positions
        transport.close()


async def test_refused_handshakes_have_a_status() -> None:
    access = Access(passwords={Role.OPERATE: "may fly it"}, local=False)
    async with Station(telemetry=False) as station:
        app = make_app(station, access, static=None)
        listening = serving(app, "127.0.0.1:0", name="the station", websockets=True)
        async with asyncio.timeout(20), listening as (host, port):
            with pytest.raises(InvalidStatus, match="401"):
                await connect(f"ws://{host}:{port}/ws")
            ticket = access.make_ticket(access.log_in("10.0.0.1", password="may fly it").session)
            offered = ["ados-ws-ticket", ticket, "mavstack.raw.1"]
            async with connect(f"ws://{host}:{port}/ws", subprotocols=offered) as socket:
                assert socket.subprotocol == "mavstack.raw.1"
            with pytest.raises(InvalidStatus, match="401"):
                await connect(f"ws://{host}:{port}/ws", subprotocols=offered)
