"""Routers, clients and gateways of Zenoh in this process."""

from __future__ import annotations

import asyncio
import json
from contextlib import asynccontextmanager, contextmanager
from typing import TYPE_CHECKING, Any

import pytest

from mavstack.bridges.core.zenoh_session import SessionOptions
from mavstack.bridges.zenoh.bus import Bus
from mavstack.bridges.zenoh.entry import IDENTITY
from mavstack.bridges.zenoh.gateway import Gateway, GatewayOptions
from mavstack.security.roles import Role
from mavstack.vehicle import Connection, connect
from tests.bridges.ros2.running import free_port, until, zenoh_client, zenoh_router

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Iterator
    from pathlib import Path

__all__ = [
    "fleet",
    "free_port",
    "get",
    "secure_client",
    "secure_router",
    "until",
    "zenoh_client",
    "zenoh_router",
]


@asynccontextmanager
async def fleet(
    url: str,
    port: int,
    *,
    count: int = 1,
    gateway: str = "g1",
    role: Role = Role.ADMINISTER,
    session: SessionOptions | None = None,
    **options: Any,
) -> AsyncIterator[tuple[Connection, Gateway]]:
    """Run a gateway of the vehicles at a URL."""
    bus = Bus(session or SessionOptions((f"tcp/127.0.0.1:{port}",)), gateway)
    identity: Any = IDENTITY
    async with (
        connect(url, **identity) as connection,
        Gateway(connection, bus, GatewayOptions(role=role, **options)) as opened,
    ):
        await connection.wait_for_vehicles(count)
        await until(lambda: len(opened.vehicles) == count)
        yield connection, opened


async def get(session: Any, selector: str, payload: bytes = b"", timeout: float = 20.0) -> dict[str, Any]:
    """Return the replies of a query by their keys; an error has the key "error"."""

    def run() -> dict[str, Any]:
        found = {}
        for reply in session.get(selector, payload=payload, timeout=timeout):
            if reply.ok is not None:
                found[str(reply.ok.key_expr)] = json.loads(bytes(reply.ok.payload))
            else:
                found["error"] = bytes(reply.err.payload).decode()
        return found

    return await asyncio.get_running_loop().run_in_executor(None, run)


@contextmanager
def secure_router(path: Path) -> Iterator[Any]:
    """Run a router with a configuration file."""
    zenoh = pytest.importorskip("zenoh")
    with zenoh.open(zenoh.Config.from_file(str(path))) as session:
        yield session


def secure_options(folder: Path, name: str, port: int) -> SessionOptions:
    """Return the options of a session with a certificate of a folder."""
    certificate, key = str(folder / f"{name}.pem"), str(folder / f"{name}.key")
    return SessionOptions(
        (f"tls/127.0.0.1:{port}",), ca=str(folder / "ca.pem"), certificate=certificate, private_key=key
    )


def secure_client(folder: Path, name: str, port: int) -> Any:
    """Return a session with a certificate of a folder."""
    zenoh = pytest.importorskip("zenoh")
    config = zenoh.Config()
    for key, value in secure_options(folder, name, port).values().items():
        config.insert_json5(key, json.dumps(value))
    return zenoh.open(config)
