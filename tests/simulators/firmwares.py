"""Stand-ins for firmwares: what their side of each interface does."""

from __future__ import annotations

import asyncio
import socket
import struct
from contextlib import suppress

from mavstack.dialects import Dialect, common
from mavstack.wire import Parser, encode


class Px4:
    """PX4 as the interface sees it: no answer at first, then one to each HIL_SENSOR."""

    def __init__(self, reader, writer, silent=3):
        self.reader, self.writer, self.silent = reader, writer, silent
        self.times = []
        self.sensors = []

    @classmethod
    async def connect(cls, port, **options):
        return cls(*await asyncio.open_connection("127.0.0.1", port), **options)

    async def close(self):
        self.writer.close()
        with suppress(OSError):
            await self.writer.wait_closed()

    async def fly(self, steps, motors=0.6):
        try:
            with suppress(ConnectionResetError, BrokenPipeError):
                await self._fly(steps, motors)
        finally:
            await self.close()

    async def _fly(self, steps, motors):
        parser = Parser(Dialect.load("common"))
        while len(self.times) < steps and (data := await self.reader.read(4096)):
            for packet in parser.feed(data):
                if isinstance(packet.message, common.HilSensor):
                    self.times.append(packet.message.time_usec)
                    self.sensors.append(packet.message)
                    if len(self.times) > self.silent:
                        self.answer(motors)

    def answer(self, motors):
        message = common.HilActuatorControls(controls=[motors] * 4 + [0.0] * 12, mode=129, flags=1)
        self.writer.write(encode(message, system=1, component=1))


class Sitl:
    """ArduPilot's SITL as the JSON interface sees it."""

    def __init__(self):
        self.answers: asyncio.Queue[bytes] = asyncio.Queue()
        self.transport = None

    @classmethod
    async def connect(cls, port):
        made = cls()

        class Asks(asyncio.DatagramProtocol):
            def datagram_received(self, data, addr):
                made.answers.put_nowait(data)

        loop = asyncio.get_running_loop()
        made.transport, _ = await loop.create_datagram_endpoint(Asks, remote_addr=("127.0.0.1", port))
        return made

    def send(self, data):
        self.transport.sendto(data)

    async def ask(self, number, pulse=1700, count=16, rate=400):
        magic = 18458 if count == 16 else 29569
        self.send(struct.pack(f"<HHI{count}H", magic, rate, number, *[pulse] * count))
        return await asyncio.wait_for(self.answers.get(), 10)

    def close(self):
        self.transport.close()


async def until(holds):
    """Let the loop run until a condition holds."""
    while not holds():  # noqa: ASYNC110 (a simulator has no event for a step)
        await asyncio.sleep(0)


def free_port():
    """Return a TCP and UDP port that is free now."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        port: int = server.getsockname()[1]
        return port
