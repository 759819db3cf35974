"""A router of sockets imports only the modules that its links use: it starts fast, and is small."""

from __future__ import annotations

import subprocess
import sys

_PROGRAM = """
import asyncio, sys
from mavstack.cli.registry import command_parser, load_command
from mavstack.cli.route import command, running
from mavstack.router.config import EndpointConfig, RouterConfig
from mavstack.router.router import Router

async def run():
    endpoints = [EndpointConfig(name, url=f"{name}://127.0.0.1:0") for name in ("udpin", "tcpin")]
    async with Router(RouterConfig(endpoints=tuple(endpoints))):
        pass

asyncio.run(run())
print(*sys.modules)
"""
#: Packages for other links and other commands; each of them cost more than the whole start does now.
_OTHERS = (
    "numpy",
    "http.client",
    "importlib.metadata",
    "mavstack.files",
    "mavstack.http",
    "mavstack.links.serial",
    "mavstack.logs",
    "mavstack.node.node",
    "mavstack.node.clients",
    "mavstack.router.control",
    "mavstack.router.endpoints.carried",
    "mavstack.router.endpoints.recorder",
    "mavstack.router.mavlink_router_config",
    "mavstack.services.camera",
    "mavstack.vehicle",
)


def test_a_router_of_sockets_imports_no_other_links_and_commands() -> None:
    done = subprocess.run([sys.executable, "-c", _PROGRAM], capture_output=True, text=True, check=True)
    imported = set(done.stdout.split())
    assert "mavstack.router.endpoints.native" in imported
    assert imported.isdisjoint(_OTHERS), sorted(imported.intersection(_OTHERS))
