from __future__ import annotations

import asyncio
import os
import socket
from contextlib import asynccontextmanager

import pytest

from mavstack.errors import LinkError
from mavstack.server.access import Access
from mavstack.server.app import make_app
from mavstack.server.rows.hub import RowHub
from mavstack.server.rows.source import RowReader
from mavstack.server.rows.urls import parse_row_url
from mavstack.server.station import Station
from tests.server.asgi import ApiClient
from tests.waiting import wait_until

URL = "csv+tcp://127.0.0.1:{port}?name=cansat&template=time:s,alt:m*0.5"


@asynccontextmanager
async def sending(*chunks: bytes):
    """A TCP server that sends chunks to each client, and its URL as a source of rows."""
    done = asyncio.Event()

    async def serve(_reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        for chunk in chunks:
            writer.write(chunk)
            await writer.drain()
        await done.wait()
        writer.close()

    async with await asyncio.start_server(serve, "127.0.0.1", 0) as server:
        yield URL.format(port=server.sockets[0].getsockname()[1])
        done.set()


async def test_rows_reach_the_clients_of_the_websocket_and_of_the_api() -> None:
    async with sending(b"1,10", b"00\n2,20\nnonsense\n") as url, Station(network_only=True) as station:
        api = ApiClient(make_app(station, Access(), static=None))
        async with api.websocket("mavstack.rows.1") as socket:
            assert socket.subprotocol == "mavstack.rows.1"
            added = await api.post("/api/sources", {"url": url})
            assert added.status == 201
            assert added.json["url"] == url
            first, second = await socket.receive(), await socket.receive()
        assert (first["source"], first["message"], first["fields"]) == (
            "cansat",
            "ROW",
            {"time": 1, "alt": 500},
        )
        assert second["fields"] == {"time": 2, "alt": 10}
        (source,) = (await api.get("/api/sources")).json
        assert source["state"] == "connected"
        assert source["rows"] == {
            "name": "cansat",
            "messages": {"ROW": [{"name": "time", "unit": "s"}, {"name": "alt", "unit": "m"}]},
            "received": 2,
            "refused": 1,
        }
        (latest,) = (await api.get("/api/rows")).json
        assert (latest["fields"]["alt"], latest["count"]) == (10, 2)
        async with api.websocket("mavstack.rows.1") as late:
            assert (await late.receive())["fields"]["alt"] == 10
        assert (await api.post("/api/sources", {"url": url})).status == 409
        assert (await api.delete(f"/api/sources/{source['id']}")).status == 200
        assert (await api.get("/api/rows")).json == []
        assert (await api.get("/api/statistics")).json["router"] is False
        assert not station.sources.rows.clients


@pytest.mark.skipif(not hasattr(os, "openpty"), reason="no pseudo terminals")
async def test_rows_of_a_serial_port() -> None:
    device, terminal = os.openpty()
    url = f"csv+serial://{os.ttyname(terminal)}?baud=57600&name=bench&template=$IMU,roll:deg|$GPS,lat,_"
    try:
        async with Station(network_only=True) as station:
            api = ApiClient(make_app(station, Access(), static=None))
            async with api.websocket("mavstack.rows.1") as rows:
                assert (await api.post("/api/sources", {"url": url})).status == 201
                os.write(device, b"$IMU,1")  # a line comes in parts, others fit no template
                os.write(device, b"2.5\r\n\xff\x00\n$GPS,46.1,9\n$IMU,1,2\n")
                first, second = await rows.receive(), await rows.receive()
            await wait_until(lambda: station.sources.list()[0].values()["rows"]["refused"] == 2)
        assert [(each["source"], each["message"], each["fields"]) for each in (first, second)] == [
            ("bench", "IMU", {"roll": 12.5}),
            ("bench", "GPS", {"lat": 46.1}),
        ]
    finally:
        os.close(device)
        os.close(terminal)


async def test_a_source_that_cannot_be_opened_leaves_nothing_behind() -> None:
    with socket.create_server(("127.0.0.1", 0)) as free:
        url = URL.format(port=free.getsockname()[1])
    async with Station() as station:
        with pytest.raises(LinkError):
            await station.sources.add(f"{url}&reconnect=no")
        assert station.sources.list() == []


async def test_a_reader_counts_lines_that_are_too_long() -> None:
    hub = RowHub()
    async with sending(b"x" * 5000 + b"\n3,4\n") as url:
        reader = RowReader(parse_row_url(url), "cansat", hub)
        await reader.open()
        await wait_until(lambda: reader.received)
        assert (reader.received, reader.refused) == (1, 1)
        await reader.close()
        await reader.close()
    assert hub.latest == {}
