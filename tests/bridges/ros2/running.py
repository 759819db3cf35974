"""A Zenoh router and a bridge in this process."""

from __future__ import annotations

import asyncio
import json
import socket
from contextlib import asynccontextmanager, contextmanager
from typing import TYPE_CHECKING, Any

import pytest

from mavstack.bridges.core.bridge import Bridge
from mavstack.security.roles import Role
from mavstack.vehicle import Connection, connect

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Iterator

    from mavstack.bridges.core.sink import Sink


def free_port() -> int:
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        port: int = found.getsockname()[1]
        return port


@contextmanager
def zenoh_router() -> Iterator[int]:
    """Run a Zenoh router; its value is the port."""
    zenoh = pytest.importorskip("zenoh")
    port = free_port()
    config = zenoh.Config()
    config.insert_json5("mode", '"router"')
    config.insert_json5("scouting/multicast/enabled", "false")
    config.insert_json5("listen/endpoints", json.dumps([f"tcp/127.0.0.1:{port}"]))
    with zenoh.open(config):
        yield port


def zenoh_client(port: int) -> Any:
    """Return a session that is a client of the router."""
    zenoh = pytest.importorskip("zenoh")
    config = zenoh.Config()
    config.insert_json5("mode", '"client"')
    config.insert_json5("scouting/multicast/enabled", "false")
    config.insert_json5("timestamping/enabled", "true")
    config.insert_json5("connect/endpoints", json.dumps([f"tcp/127.0.0.1:{port}"]))
    return zenoh.open(config)


def zenoh_ros2_sdk() -> Any:
    """Return an independent implementation of rmw_zenoh's wire, without a session."""
    sdk = pytest.importorskip("zenoh_ros2_sdk")
    sdk.ZenohSession._instance = None  # it has one session, whichever router a client names
    return sdk


@asynccontextmanager
async def bridged(url: str, sink: Sink, **options: Any) -> AsyncIterator[tuple[Connection, Bridge]]:
    """Run a bridge of the vehicle at a URL."""
    async with (
        connect(url) as connection,
        Bridge(connection, [sink], **{"role": Role.ADMINISTER, **options}) as bridge,
    ):
        await connection.wait_for_vehicle()
        yield connection, bridge


async def until(condition: Any, timeout: float = 20.0) -> None:
    """Wait until a condition holds, in real time."""
    async with asyncio.timeout(timeout):
        while not condition():  # noqa: ASYNC110 (conditions of other threads)
            await asyncio.sleep(0.05)
