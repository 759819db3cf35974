"""Peers of a router in tests: sockets on loopback, and packets."""

from __future__ import annotations

import asyncio
import socket
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, Any

from mavstack import Dialect, Parser, encode
from mavstack.dialects import common
from mavstack.router.config import EndpointConfig, RouterConfig
from mavstack.router.router import Router

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable
    from typing import Self

TIMEOUT = 5.0
DIALECT = Dialect.load("all")


def heartbeat(system: int = 1, component: int = 1, sequence: int = 0) -> bytes:
    message = common.Heartbeat(type=common.MavType.QUADROTOR, autopilot=common.MavAutopilot.PX4)
    return encode(message, system=system, component=component, sequence=sequence)


def arm(target: int = 1, system: int = 255) -> bytes:
    message = common.CommandLong(target_system=target, target_component=1, command=400, param1=1)
    return encode(message, system=system, component=190)


def names(data: bytes) -> list[str | None]:
    return [packet.name for packet in Parser(DIALECT).feed(data)]


@asynccontextmanager
async def routing(*endpoints: EndpointConfig, **settings: Any) -> AsyncIterator[Router]:
    async with Router(RouterConfig(endpoints, **settings)) as router:
        yield router


def port(router: Router, name: str) -> int:
    """The port on which an endpoint listens."""
    return int(router.endpoints[name].address[1])


class UdpPeer:
    """A UDP socket that talks to an endpoint."""

    def __init__(self, target: int = 0) -> None:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", 0))
        self.socket.setblocking(False)
        self.target = target

    @property
    def port(self) -> int:
        return int(self.socket.getsockname()[1])

    def send(self, data: bytes) -> None:
        self.socket.sendto(data, ("127.0.0.1", self.target))

    async def receive(self) -> bytes:
        async with asyncio.timeout(TIMEOUT):
            data, address = await asyncio.get_running_loop().sock_recvfrom(self.socket, 65536)
        self.target = address[1]
        return data

    def waiting(self) -> int:
        """The number of datagrams that wait."""
        count = 0
        while True:
            try:
                self.socket.recv(65536)
            except BlockingIOError:
                return count
            count += 1

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.socket.close()


async def until(condition: Callable[[], object]) -> None:
    """Wait until a condition holds."""
    async with asyncio.timeout(TIMEOUT):
        while not condition():  # noqa: ASYNC110 (of another thread)
            await asyncio.sleep(0.001)
