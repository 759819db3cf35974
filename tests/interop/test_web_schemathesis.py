"""Schemathesis calls every operation of the station's API as its OpenAPI description tells."""

from __future__ import annotations

import asyncio
import subprocess
import sys

import pytest

from mavstack.http.server import serving
from mavstack.server.access import Access
from mavstack.server.app import make_app
from mavstack.server.station import Station

pytest.importorskip("schemathesis")
pytestmark = [pytest.mark.interop, pytest.mark.long]

#: Requests that are valid by their schema may still be refused, such as a plan that is no plan.
CHECKS = (
    "not_a_server_error,status_code_conformance,content_type_conformance,response_schema_conformance,"
    "negative_data_rejection"
)
TIME_LIMIT = 120.0


async def test_operations_conform_to_their_description(tmp_path) -> None:
    async with Station(folder=tmp_path) as station:
        app = make_app(station, Access(), static=None)
        async with serving(app, "127.0.0.1:0", name="the station", websockets=True) as (host, port):
            words = ["run", f"http://{host}:{port}/openapi.json", "--checks", CHECKS, "--max-examples", "2"]
            words += ["--seed", "1", "--phases", "examples,fuzzing", "--suppress-health-check", "all"]
            words += ["--no-color", "--generation-database", "none"]
            running = await asyncio.create_subprocess_exec(
                sys.executable,
                "-m",
                "schemathesis.cli",
                *words,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                cwd=tmp_path,
            )
            output, _ = await asyncio.wait_for(running.communicate(), TIME_LIMIT)
    assert running.returncode == 0, output.decode()[-6000:]
