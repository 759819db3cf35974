"""Clients of WebSockets that break the protocol, send too much, or leave; other clients do not notice."""

from __future__ import annotations

import asyncio
import struct
from contextlib import asynccontextmanager, suppress
from time import time
from typing import TYPE_CHECKING

from websockets.asyncio.client import connect

from mavstack.dialects import common
from mavstack.http.server import MAX_WEBSOCKET_MESSAGE, serving
from mavstack.security.roles import Role
from mavstack.security.tickets import make_ticket
from mavstack.server.access import Access
from mavstack.server.app import make_app
from mavstack.server.station import Station
from mavstack.wire import Encoder

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

CONTINUATION, TEXT, BINARY, CLOSE, RESERVED = 0, 1, 2, 8, 11
MASK = b"\x00\x00\x00\x00"  # of zeros: the payload is sent as it is
KEY = "the key of the tickets"
HEARTBEAT = Encoder(1, 1).encode(common.Heartbeat(type=2, autopilot=3, mavlink_version=3))
SCOPE = "gs.mavlink_ws.operate"


class Socket:
    """A WebSocket whose frames are made by hand."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.reader, self.writer = reader, writer

    def send(self, opcode: int, data: bytes, *, final: bool = True, masked: bool = True) -> None:
        """Send a frame; its length is written in 64 bits, as it may be."""
        head = bytes([opcode | 0x80 * final, 127 | 0x80 * masked])
        self.writer.write(head + struct.pack("!Q", len(data)) + MASK * masked + data)

    async def close_code(self) -> int:
        """Read up to the frame that closes the WebSocket, and return its code."""
        while True:
            opcode, length = await self.reader.readexactly(2)
            data = await self.reader.readexactly(length)
            if opcode & 0x0F == CLOSE:
                return int.from_bytes(data[:2])


class Server:
    """A station on a port, and the sockets that a test has opened there."""

    def __init__(self, port: int) -> None:
        self.port = port
        self.sockets: list[Socket] = []

    async def connect(self) -> Socket:
        self.sockets.append(Socket(*await asyncio.open_connection("127.0.0.1", self.port)))
        return self.sockets[-1]

    async def open(self, *offered: str, origin: str = "") -> tuple[int, Socket]:
        """Open a WebSocket as a browser does; returns the status of the answer, too."""
        socket = await self.connect()
        lines = [
            "GET /ws HTTP/1.1",
            f"Host: 127.0.0.1:{self.port}",
            "Upgrade: websocket",
            "Connection: Upgrade",
            "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==",
            "Sec-WebSocket-Version: 13",
            "Sec-WebSocket-Extensions: permessage-deflate; client_max_window_bits",
            *([f"Sec-WebSocket-Protocol: {', '.join(offered)}"] if offered else []),
            *([f"Origin: {origin}"] if origin else []),
        ]
        socket.writer.write("\r\n".join([*lines, "\r\n"]).encode())
        head = await socket.reader.readuntil(b"\r\n\r\n")
        assert b"permessage-deflate" not in head  # it would cost processor time for each client
        return int(head.split()[1]), socket

    async def close(self) -> None:
        for each in self.sockets:
            each.writer.close()
            with suppress(OSError):
                await each.writer.wait_closed()


@asynccontextmanager
async def serving_a_station(access: Access | None = None) -> AsyncIterator[Server]:
    """Run a station; at the end a client that behaves must still get packets."""
    async with Station(telemetry=False) as station, asyncio.timeout(20):
        source = await station.sources.add("udpin://127.0.0.1:0")
        app = make_app(station, access or Access(), static=None)
        async with serving(app, "127.0.0.1:0", name="the station", websockets=True) as (_, port):
            server = Server(port)
            yield server
            ticket = make_ticket(KEY, now=time(), nonce=b"fedcba9876543210", scope=SCOPE)
            offered = ["ados-ws-ticket", ticket, "mavstack.raw.1"]
            async with connect(f"ws://127.0.0.1:{port}/ws", subprotocols=offered) as good:
                vehicle, _ = await asyncio.get_running_loop().create_datagram_endpoint(
                    asyncio.DatagramProtocol, remote_addr=source.link.address
                )
                vehicle.sendto(HEARTBEAT)
                assert await good.recv() == HEARTBEAT
                vehicle.close()
            await server.close()


async def test_clients_that_break_the_protocol_are_closed(caplog) -> None:
    faults = [
        ("mavstack.json.1", 1007, (TEXT, b"\xff\xfe"), {}),
        ("mavstack.json.1", 1009, (TEXT, b"x" * (MAX_WEBSOCKET_MESSAGE + 1)), {}),
        ("mavstack.raw.1", 1009, (BINARY, bytes(MAX_WEBSOCKET_MESSAGE + 1)), {}),
        ("mavstack.raw.1", 1002, (BINARY, b"\xfd"), {"masked": False}),
        ("mavstack.raw.1", 1002, (CONTINUATION, b"\xfd"), {}),
        ("mavstack.raw.1", 1002, (RESERVED, b""), {}),
    ]
    async with serving_a_station() as server:
        for protocol, code, frame, options in faults:
            status, socket = await server.open(protocol)
            assert status == 101
            socket.send(*frame, **options)
            assert await socket.close_code() == code, frame[1][:10]
    assert not caplog.records  # a client cannot fill the log


async def test_clients_that_send_nonsense_or_leave_in_the_middle() -> None:
    async with serving_a_station() as server:
        _, raw = await server.open("mavstack.raw.1")
        raw.send(TEXT, b"a text")
        raw.send(BINARY, bytes(range(256)) * 100)
        raw.send(BINARY, b"\xfd\xff", final=False)
        _, decoded = await server.open("mavstack.json.1")
        decoded.send(BINARY, b"\x00\xff")
        decoded.send(TEXT, b"[" * 100_000)
        half = await server.connect()
        half.writer.write(b"GET /ws HTTP/1.1\r\nHost: 127.")
        for socket in (raw, decoded, half):
            await socket.writer.drain()
            socket.writer.transport.abort()


async def test_clients_that_have_vanished_are_closed(monkeypatch) -> None:
    monkeypatch.setattr("mavstack.http.server.PING_INTERVAL", 0.05)
    async with serving_a_station() as server:
        for protocol in ("mavstack.raw.1", "mavstack.json.1"):
            _, vanished = await server.open(protocol)
            assert await vanished.close_code() == 1011  # it answers no ping


async def test_handshakes_that_are_refused(caplog) -> None:
    access = Access(passwords={Role.OPERATE: "may fly it"}, ticket_key=KEY, local=False)
    async with serving_a_station(access) as server:
        ticket = make_ticket(KEY, now=time(), nonce=b"0123456789abcdef", scope=SCOPE)
        offered = ("ados-ws-ticket", ticket, "mavstack.raw.1")
        asked = (
            server.open(*offered),
            server.open(*offered),  # the ticket again
            server.open(),
            server.open("mavlink"),
            server.open(origin="https://elsewhere.example"),
        )
        assert [(await each)[0] for each in asked] == [101, 401, 401, 400, 403]
    assert not caplog.records


async def test_more_clients_than_allowed_are_refused(monkeypatch) -> None:
    monkeypatch.setattr("mavstack.server.client_shares.MAX_STREAMS", 2)
    async with serving_a_station() as server:
        assert [(await server.open())[0] for _ in range(3)] == [101, 101, 429]
        for socket in server.sockets:
            socket.writer.transport.abort()
        while (await server.open())[0] == 429:  # noqa: ASYNC110 (only its answer tells)
            await asyncio.sleep(0.01)
        server.sockets[-1].writer.transport.abort()
