from __future__ import annotations

import asyncio
import json
import os
import socket
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING

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

if TYPE_CHECKING:
    from pathlib import Path

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


DECODER = {
    "name": "bench",
    "framing": {"kind": "fixed", "marker": "aa", "size": 4},
    "checksum": {"kind": "sum8"},
    "messages": [
        {"name": "BENCH", "fields": [{"name": "volts", "type": "uint16", "factor": 0.5, "unit": "V"}]}
    ],
}
FRAME = b"\xaa\x04\x01\xaf"


async def test_frames_of_tcp_are_decoded_and_counted() -> None:
    async with sending(b"noise" + FRAME[:2], FRAME[2:] + b"\xaa\0\0\0") as csv, Station() as station:
        api = ApiClient(make_app(station, Access(), static=None))
        url = csv.replace("csv+", "frames+").partition("?")[0] + "?name=bench&decoder=bench"
        added = await api.post("/api/sources", {"url": url, "decoder": DECODER})
        assert (added.status, added.json["url"]) == (201, url)
        (source,) = station.sources.list()
        await wait_until(lambda: source.values()["rows"]["refused"])
        assert source.values()["rows"] == {
            "name": "bench",
            "messages": {"BENCH": [{"name": "volts", "unit": "V"}]},
            "received": 1,
            "refused": 1,
        }
        (latest,) = (await api.get("/api/rows")).json
        assert (latest["message"], latest["fields"], "data" in latest) == ("BENCH", {"volts": 130}, False)


async def test_datagrams_without_a_decoder_reach_scripts_as_bytes() -> None:
    async with Station(network_only=True) as station:
        api = ApiClient(make_app(station, Access(), static=None))
        async with api.websocket("mavstack.rows.1") as rows:
            added = await api.post("/api/sources", {"url": "frames+udp://127.0.0.1:0?name=raw"})
            assert added.status == 201
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
                for data in (b"\x01\x02", b"\xff"):
                    sender.sendto(data, tuple(added.json["address"]))
            found = [await rows.receive(), await rows.receive()]
        assert [(each["message"], each["fields"], each["data"]) for each in found] == [
            ("FRAME", {"size": 2}, "AQI="),
            ("FRAME", {"size": 1}, "/w=="),
        ]


async def test_requests_for_frames_that_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "bench.json"
    file.write_text(json.dumps({"type": "mavstack-decoder", **DECODER}), "utf-8")
    udp = "frames+udp://127.0.0.1:0?name=bench"
    async with Station(network_only=True) as station:
        api = ApiClient(make_app(station, Access(), static=None))

        async def add(url: str, decoder: dict | None = None) -> tuple[int, str]:
            answer = await api.post("/api/sources", {"url": url, "decoder": decoder})
            return answer.status, answer.json.get("error", {}).get("text", "")

        for path in (file, tmp_path / "missing.json"):
            status, problem = await add(f"{udp}&decoder={path}")
            assert (status, problem) == (
                403,
                "without a password no file can be named: send the decoder itself",
            )
        status, problem = await add(udp, DECODER | {"messages": [{}]})
        assert status == 400
        assert "messages[0].fields must have at least one field" in problem
        for url in ("udpin://127.0.0.1:0", "csv+udp://127.0.0.1:0?template=a"):
            status, problem = await add(url, DECODER)
            assert status == 400
            assert "frames" in problem
        assert (await add(f"{udp}&template=a"))[0] == 400
        assert station.sources.list() == []
        source = await station.sources.add(f"{udp}&decoder={file}")
        assert source.values()["rows"]["messages"] == {"BENCH": [{"name": "volts", "unit": "V"}]}


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
