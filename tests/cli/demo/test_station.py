from __future__ import annotations

import asyncio
import json
import subprocess
import sys
from time import monotonic
from typing import TYPE_CHECKING
from urllib.request import urlopen

from mavstack.cli.demo.station import station_served
from mavstack.links import MemoryNetwork

if TYPE_CHECKING:
    from pathlib import Path


async def test_the_station_is_served_while_the_block_runs(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)

    def ask(url: str) -> object:
        with urlopen(url, timeout=10) as answer:
            return json.loads(answer.read())

    async with asyncio.timeout(20), station_served(MemoryNetwork().link(), 0) as url:
        assert await asyncio.to_thread(ask, f"{url}api/vehicles") == []
    assert not list(tmp_path.iterdir())


def test_vehicles_answer_the_station_and_not_the_pilot_of_the_demo(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "mavstack", "demo", "--web", "--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=tmp_path) as process:
        assert process.stdout is not None
        try:
            url = process.stdout.readline().split()[3].rstrip(";")
            vehicles: list[dict[str, int]] = []
            deadline = monotonic() + 60
            while not vehicles and monotonic() < deadline:
                with urlopen(f"{url}api/vehicles", timeout=10) as answer:
                    vehicles = json.loads(answer.read())
            with urlopen(f"{url}api/vehicles/{vehicles[0]['system']}/mission", timeout=60) as answer:
                plan = json.loads(answer.read())
            assert plan["fileType"] == "MavstackPlan"
        finally:
            process.terminate()
