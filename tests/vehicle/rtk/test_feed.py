"""Sources of corrections over real sockets."""

from __future__ import annotations

import asyncio
import ssl

import pytest

from mavstack.errors import LinkError
from mavstack.gnss.rtcm import RtcmFramer
from mavstack.vehicle.rtk import CorrectionFeed, FeedState, download_source_table, feed
from tests.gnss.caster import caster
from tests.gnss.test_rtcm import msm, station
from tests.links.certificates import certificates  # noqa: F401 - a fixture

GGA = b"$GPGGA,120000.00,4723.86,N,00832.73,E,1,14,0.6,488.0,M,47.0,M,,*7F\r\n"


async def until(condition) -> None:
    async with asyncio.timeout(20):
        while not condition():  # noqa: ASYNC110 (states of threads)
            await asyncio.sleep(0.01)


async def test_a_caster_streams_and_receives_the_position(monkeypatch):
    monkeypatch.setattr(feed, "MIN_PAUSE", 0.01)
    framer, numbers = RtcmFramer(), []

    def deliver(data: bytes) -> None:
        numbers.extend(frame.number for frame in framer.feed(data))

    with caster() as server:
        server.epochs = 3  # then the caster closes the connection, and the feed asks again
        async with CorrectionFeed(server.url, deliver, lambda: GGA) as source:
            await until(lambda: source.connects >= 2 and len(numbers) > 12)
            await until(lambda: any(server.sentences))
        assert numbers[:3] == [1005, 1074, 1084]
        assert GGA in server.sentences
        assert source.state is FeedState.ENDED
        assert source.problem  # closed or reset by the caster
        assert "secret" not in source.url


async def test_a_caster_over_tls_must_be_trusted(certificates, monkeypatch):  # noqa: F811
    data = bytearray()

    async def answer(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        assert (await reader.readuntil(b"\r\n\r\n")).startswith(b"GET /NEAR ")
        writer.write(b"ICY 200 OK\r\n\r\n" + station().data)
        await writer.drain()

    context = ssl.create_default_context(ssl.Purpose.CLIENT_AUTH)
    context.load_cert_chain(certificates / "cert.pem", certificates / "key.pem")
    server = await asyncio.start_server(answer, "127.0.0.1", 0, ssl=context)
    url = f"ntrips://127.0.0.1:{server.sockets[0].getsockname()[1]}/NEAR"
    async with CorrectionFeed(url, data.extend) as source:
        await until(lambda: "certificate verify failed" in source.problem)
    assert not data
    monkeypatch.setenv("SSL_CERT_FILE", str(certificates / "ca.pem"))
    async with CorrectionFeed(url, data.extend):
        await until(lambda: data == station().data)
    server.close()
    await server.wait_closed()


async def test_a_wrong_password_ends_the_feed():
    with caster() as server:
        async with CorrectionFeed(server.url.replace("secret", "wrong"), bytes) as source:
            with pytest.raises(LinkError, match="it refused user and password"):
                await source.wait()
        assert len(server.requests) == 1


async def test_no_caster_is_tried_again(monkeypatch):
    monkeypatch.setattr(feed, "MIN_PAUSE", 0.01)
    states = []
    source = CorrectionFeed("ntrip://127.0.0.1:1/M", bytes)
    source.on_change = lambda changed: states.append(changed.state)
    async with source:
        await until(lambda: states.count(FeedState.CONNECTING) >= 2)
    assert "refused" in source.problem or "Connect" in source.problem


async def test_a_base_over_tcp_is_configured():
    received = bytearray()

    async def base(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        writer.write(station().data + msm(1074, 1).data)
        received.extend(await reader.read(1000))
        writer.close()

    from mavstack.gnss.ublox import SurveyIn

    server = await asyncio.start_server(base, "127.0.0.1", 0)
    port = server.sockets[0].getsockname()[1]
    data = bytearray()
    async with CorrectionFeed(f"tcpout://127.0.0.1:{port}", data.extend, base=SurveyIn()) as source:
        await until(lambda: received and len(data) > 100)
        assert source.connects == 1
    assert received[:4] == b"\xb5\x62\x06\x8a"
    server.close()
    await server.wait_closed()


async def test_the_source_table():
    with caster() as server:
        (entry,) = await download_source_table(server.url)
        assert entry.mountpoint == "NEAR"
        url = server.url
    with pytest.raises(LinkError, match=r"opening ntrip://127.0.0.1:\d+/ failed: "):
        await download_source_table(url)
