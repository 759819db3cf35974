from __future__ import annotations

import asyncio
import socket
import ssl
from contextlib import AsyncExitStack, suppress

import pytest
from starlette.applications import Starlette
from starlette.responses import PlainTextResponse
from starlette.routing import Route

from mavstack.errors import LinkError
from mavstack.handshakes import MAX_HANDSHAKES
from mavstack.http.connections import Connection
from mavstack.http.server import Certificate, serving
from tests.links.certificates import certificates
from tests.waiting import wait_until

__all__ = ["certificates"]
REQUEST = b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n"


async def answer(request):
    return PlainTextResponse("served")


async def test_an_address_in_use_is_an_error():
    async with serving(Starlette(), "127.0.0.1:0", name="a service") as (host, port):
        with pytest.raises(LinkError, match=r"cannot serve another service on .*in use"):
            async with serving(Starlette(), f"{host}:{port}", name="another service"):
                pass


async def test_answers_do_not_wait_for_the_acknowledgement_of_their_head(monkeypatch):
    options = []

    class Protocol(Connection):
        def connection_made(self, transport):
            super().connection_made(transport)
            sock = transport.get_extra_info("socket")
            options.append(sock.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY))

    monkeypatch.setattr("mavstack.http.connections.Connection", Protocol)
    app = Starlette(routes=[Route("/", answer)])
    async with asyncio.timeout(20), serving(app, "127.0.0.1:0", name="a service") as (host, port):
        reader, writer = await asyncio.open_connection(host, port)
        writer.write(REQUEST)
        await reader.readuntil(b"served")
        writer.close()
    assert options == [1]


async def test_a_missing_certificate_is_an_error():
    with pytest.raises(
        LinkError, match=r"with TLS: missing.pem is not a certificate with its key \(No such file"
    ):
        async with serving(Starlette(), "127.0.0.1:0", name="a service", tls=Certificate("missing.pem")):
            pass


async def test_handshakes_that_do_not_end_are_bounded_and_lock_out_no_client(certificates):
    app = Starlette(routes=[Route("/", answer)])
    tls = Certificate(str(certificates / "cert.pem"), str(certificates / "key.pem"))
    context = ssl.create_default_context(cafile=certificates / "ca.pem")
    async with AsyncExitStack() as stack, asyncio.timeout(60):
        host, port = await stack.enter_async_context(serving(app, "127.0.0.1:0", name="a service", tls=tls))
        silent = []
        for _ in range(MAX_HANDSHAKES + 8):
            reader, writer = await asyncio.open_connection(host, port)
            stack.callback(writer.close)
            silent.append(reader)
        await wait_until(lambda: sum(not each.at_eof() for each in silent) <= MAX_HANDSHAKES)
        reader, writer = await asyncio.open_connection(host, port, ssl=context)
        stack.callback(writer.close)
        writer.write(REQUEST)
        await reader.readuntil(b"served")


async def test_handshakes_that_do_not_end_do_not_delay_the_end_of_the_server(certificates):
    tls = Certificate(str(certificates / "cert.pem"), str(certificates / "key.pem"))
    async with asyncio.timeout(20):
        async with serving(Starlette(), "127.0.0.1:0", name="a service", tls=tls) as (host, port):
            reader, writer = await asyncio.open_connection(host, port)
        assert await reader.read() == b""
        writer.close()


@pytest.mark.parametrize(("requests", "beginning"), [(0, b""), (0, REQUEST[:9]), (1, REQUEST[:9])])
async def test_connections_whose_requests_do_not_arrive_are_closed(monkeypatch, requests, beginning):
    monkeypatch.setattr("mavstack.http.connections.HEAD_TIMEOUT", 0.05)
    app = Starlette(routes=[Route("/", answer)])
    async with asyncio.timeout(20), serving(app, "127.0.0.1:0", name="a service") as (host, port):
        reader, writer = await asyncio.open_connection(host, port)
        for _ in range(requests):
            writer.write(REQUEST)
            await reader.readuntil(b"served")
        writer.write(beginning)
        with suppress(ConnectionResetError):
            assert await reader.read() == b""
        writer.close()


async def test_a_request_that_arrived_has_no_deadline(monkeypatch):
    monkeypatch.setattr("mavstack.http.connections.HEAD_TIMEOUT", 0.05)

    async def answer_late(request):
        await asyncio.sleep(0.2)
        return PlainTextResponse("served")

    app = Starlette(routes=[Route("/", answer_late)])
    async with asyncio.timeout(20), serving(app, "127.0.0.1:0", name="a service") as (host, port):
        reader, writer = await asyncio.open_connection(host, port)
        writer.write(REQUEST)
        assert (await reader.readuntil(b"served")).startswith(b"HTTP/1.1 200")
        writer.close()


@pytest.mark.parametrize(
    ("proxy", "seen"),
    [("", b"127.0.0.1 http"), ("127.0.0.1", b"10.1.1.1 https"), ("10.9.9.9", b"127.0.0.1 http")],
)
async def test_the_address_of_a_client_is_that_of_its_connection_but_for_a_proxy(proxy, seen):
    async def show(request):
        return PlainTextResponse(f"{request.client.host} {request.url.scheme}")

    app = Starlette(routes=[Route("/", show)])
    async with (
        asyncio.timeout(20),
        serving(app, "127.0.0.1:0", name="a service", proxy=proxy) as (host, port),
    ):
        reader, writer = await asyncio.open_connection(host, port)
        headers = b"X-Forwarded-For: 10.1.1.1\r\nX-Forwarded-Proto: https\r\nConnection: close\r\n\r\n"
        writer.write(REQUEST[:-2] + headers)
        assert (await reader.read()).endswith(seen)
        writer.close()


async def test_connections_beyond_the_limit_are_closed(monkeypatch):
    monkeypatch.setattr("mavstack.http.connections.MAX_CONNECTIONS", 1)
    app = Starlette(routes=[Route("/", answer)])
    async with asyncio.timeout(20), serving(app, "127.0.0.1:0", name="a service") as (host, port):
        first_reader, first = await asyncio.open_connection(host, port)
        first.write(REQUEST)
        await first_reader.readuntil(b"served")
        reader, second = await asyncio.open_connection(host, port)
        with suppress(ConnectionResetError):
            assert await reader.read() == b""
        first.write(REQUEST)
        await first_reader.readuntil(b"served")
        first.close()
        second.close()
