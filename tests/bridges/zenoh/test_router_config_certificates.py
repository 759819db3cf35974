"""The router's access list, with real certificates: each owner gets what it may have, and nothing else."""

from __future__ import annotations

import asyncio
from contextlib import ExitStack
from functools import partial
from typing import TYPE_CHECKING, Any

import pytest

from mavstack import encode
from mavstack.bridges.zenoh.certificates import FleetCertificates
from mavstack.bridges.zenoh.router_config import Fleet, router_config
from mavstack.dialects import common
from mavstack.sim.background import BackgroundSimulator
from mavstack.vehicle import Connection
from tests.bridges.zenoh.running import (
    fleet,
    free_port,
    get,
    secure_client,
    secure_options,
    secure_router,
    until,
)
from tests.bridges.zenoh.test_link import zenoh_link

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.interop
MODE = "mavstack/alpha/command/set_mode"


def test_certificates_decide(tmp_path: Path) -> None:
    zenoh = pytest.importorskip("zenoh")
    pytest.importorskip("cryptography")
    port = free_port()
    owners = Fleet({"alpha": ("alpha",), "beta": ("beta",)}, ("map",), ("tower",), ("router",))
    certificates = FleetCertificates(tmp_path)
    certificates.make("router", ["127.0.0.1"])
    for name in (*owners.owners(), "mallory"):
        certificates.make(name)
    path = tmp_path / "router.json5"
    files = {"certificate": "router.pem", "private_key": "router.key", "ca": "ca.pem"}
    named = {key: str(tmp_path / name) for key, name in files.items()}
    path.write_text(router_config(owners, listen=[f"tls/127.0.0.1:{port}"], **named), "utf-8")

    async def scenario(url: str, stack: ExitStack) -> None:
        session = secure_options(tmp_path, "alpha", port)
        async with fleet(url, port, session=session, names={1: "alpha"}) as (_, gateway):
            clients = {
                name: secure_client(tmp_path, name, port) for name in ("tower", "map", "mallory", "beta")
            }
            for each in clients.values():
                stack.callback(each.close)
            got: dict[str, set[str]] = {name: set() for name in clients}

            def receive(name: str, sample: Any) -> None:
                got[name].add(str(sample.key_expr).split("/", 2)[2])

            for name, client in clients.items():
                for key in ("mavstack/*/frame/out", "mavstack/*/state/*", "mavstack/**"):
                    client.declare_subscriber(key, partial(receive, name))
            await until(lambda: got["tower"] >= {"frame/out", "state/position"} <= got["map"])
            for name in ("mallory", "beta"):
                assert got[name] == set()
                assert await get(clients[name], "mavstack/*/state/*", timeout=1) == {}
                assert not list(clients[name].liveliness().get("mavstack/**", timeout=1))
            assert "mavstack/alpha/state/status" in await get(clients["map"], "mavstack/*/state/*")
            heartbeat = encode(common.Heartbeat(type=6, autopilot=8), system=255, component=190, sequence=0)
            for name in ("map", "mallory", "beta"):
                assert await get(clients[name], MODE, b'{"custom_mode": "GUIDED"}', timeout=1) == {}
                clients[name].put("mavstack/alpha/frame/in", heartbeat)
            await asyncio.sleep(0.5)
            assert gateway.vehicles[1].guard.accepted == 0
            assert (await get(clients["tower"], MODE, b'{"custom_mode": "GUIDED"}'))[MODE]["ok"]
            clients["tower"].put("mavstack/alpha/frame/in", heartbeat)
            await until(lambda: gateway.vehicles[1].guard.accepted == 1)
            query = f"ca={tmp_path}/ca.pem&cert={tmp_path}/tower.pem&key={tmp_path}/tower.key"
            async with Connection(zenoh_link(f"zenoh://127.0.0.1:{port}?{query}")) as far:
                assert (await far.wait_for_vehicle()).mode == "GUIDED"

    with secure_router(path), BackgroundSimulator("copter") as simulator, ExitStack() as stack:
        asyncio.run(scenario(simulator.url, stack))
    assert zenoh is not None
