from __future__ import annotations

import asyncio
import json
from urllib.request import urlopen

from mavstack.cli.demo.station import station_served
from mavstack.links import MemoryNetwork


async def test_the_station_is_served_while_the_block_runs(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)

    def ask(url: str) -> object:
        with urlopen(url, timeout=10) as answer:
            return json.loads(answer.read())

    async with asyncio.timeout(20), station_served(MemoryNetwork().link(), 0) as url:
        assert await asyncio.to_thread(ask, f"{url}api/vehicles") == []
    assert not list(tmp_path.iterdir())
