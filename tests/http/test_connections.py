"""The bound on the connections of an HTTP server: half requests lock no client out."""

from __future__ import annotations

import asyncio
import socket
from contextlib import ExitStack, suppress

import pytest
from starlette.applications import Starlette
from starlette.responses import PlainTextResponse, StreamingResponse
from starlette.routing import Route, WebSocketRoute
from websockets.asyncio.client import connect

from mavstack.http.connections import mark_client
from mavstack.http.server import serving
from mavstack.security.admission import Proof

REQUEST = b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n"
LIMIT = 8
#: A head without its end, a body without its end, and nothing.
HALF_REQUESTS = [REQUEST[:-2], b"POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 9\r\n\r\nx", b""]


async def answer(request):
    await request.body()
    return PlainTextResponse("served")


async def endless(request):
    async def events():
        yield "begun"
        await asyncio.Event().wait()

    if "session" in request.query_params:
        mark_client(Proof.AUTHENTICATED, "a session")
    return StreamingResponse(events())


APP = Starlette(routes=[Route("/", answer, methods=["GET", "POST"]), Route("/endless", endless)])


@pytest.fixture(autouse=True)
def few_connections(monkeypatch):
    monkeypatch.setattr("mavstack.http.connections.MAX_CONNECTIONS", LIMIT)


async def ask(host, port):
    reader, writer = await asyncio.open_connection(host, port)
    try:
        writer.write(REQUEST)
        with suppress(ConnectionResetError):
            return b"served" in await reader.readuntil(b"served")
    except asyncio.IncompleteReadError:
        return False
    finally:
        writer.close()


async def open_many(stack, count, data, host, port):
    for _ in range(count):
        sock = stack.enter_context(socket.create_connection((host, port)))
        sock.sendall(data)
        await asyncio.sleep(0.005)


@pytest.mark.parametrize("half", HALF_REQUESTS)
async def test_half_requests_lock_no_client_out(half):
    async with asyncio.timeout(20), serving(APP, "127.0.0.1:0", name="a service") as (host, port):
        with ExitStack() as stack:
            await open_many(stack, 3 * LIMIT, half, host, port)
            assert await ask(host, port)


async def test_half_requests_do_not_end_a_stream():
    async with asyncio.timeout(20), serving(APP, "127.0.0.1:0", name="a service") as (host, port):
        reader, writer = await asyncio.open_connection(host, port)
        writer.write(REQUEST.replace(b"/ ", b"/endless ", 1))
        await reader.readuntil(b"begun")
        with ExitStack() as stack:
            await open_many(stack, 3 * LIMIT, HALF_REQUESTS[0], host, port)
            await asyncio.sleep(0)
            assert not reader.at_eof()
        writer.close()


async def test_streams_of_sessions_that_may_act_keep_their_connections(monkeypatch):
    monkeypatch.setattr("mavstack.security.admission.USE_TIMEOUT", 0.0)
    async with asyncio.timeout(20), serving(APP, "127.0.0.1:0", name="a service") as (host, port):
        with ExitStack() as stack:
            target = REQUEST.replace(b"/ ", b"/endless?session=1 ", 1)
            await open_many(stack, LIMIT, target, host, port)
            assert not await ask(host, port)


async def test_a_websocket_has_a_place_until_it_ends(monkeypatch):
    monkeypatch.setattr("mavstack.http.connections.MAX_CONNECTIONS", 1)
    monkeypatch.setattr("mavstack.security.admission.USE_TIMEOUT", 0.0)

    async def echo(websocket):
        await websocket.accept()
        async for text in websocket.iter_text():
            await websocket.send_text(text)

    app = Starlette(routes=[Route("/", answer), WebSocketRoute("/ws", echo)])
    async with (
        asyncio.timeout(20),
        serving(app, "127.0.0.1:0", name="a service", websockets=True) as (host, port),
    ):
        async with connect(f"ws://{host}:{port}/ws") as client:
            await client.send("there")
            assert await client.recv() == "there"
            assert not await ask(host, port)
        served = False
        for _ in range(100):  # the server sees the end of the connection a moment later
            served = served or await ask(host, port)
        assert served


@pytest.mark.parametrize("rest", [b"", REQUEST[:-2]])
async def test_half_of_a_next_request_lets_a_connection_be_closed(monkeypatch, rest):
    """One that is unused between two requests was in use a moment ago, so that it stays."""
    monkeypatch.setattr("mavstack.http.connections.MAX_CONNECTIONS", 1)
    async with asyncio.timeout(20), serving(APP, "127.0.0.1:0", name="a service") as (host, port):
        reader, writer = await asyncio.open_connection(host, port)
        writer.write(REQUEST)
        await reader.readuntil(b"served")
        writer.write(rest)
        await asyncio.sleep(0.01)
        assert await ask(host, port) is bool(rest)
        writer.close()


async def test_exceptions_of_an_application_are_logged(caplog):
    async def fail(request):
        raise ValueError("a fault")

    app = Starlette(routes=[Route("/", fail)])
    async with asyncio.timeout(20), serving(app, "127.0.0.1:0", name="a service") as (host, port):
        reader, writer = await asyncio.open_connection(host, port)
        writer.write(REQUEST)
        assert b"500" in await reader.readline()
        writer.write(b"nonsense\r\n\r\n")
        await reader.read()
        writer.close()
    assert [(each.name, each.message) for each in caplog.records if each.levelname == "ERROR"] == [
        ("mavstack.http", "the request for / failed")
    ]
    assert not any(each.name.startswith("uvicorn") for each in caplog.records)
