"""Requests that are answered by their heads alone, and those that the server must see."""

from __future__ import annotations

import asyncio
from email.utils import parsedate_to_datetime

import pytest
from starlette.applications import Starlette
from starlette.responses import PlainTextResponse
from starlette.routing import Route

from mavstack.http import idle_timer
from mavstack.http.connections import mark_client
from mavstack.http.early_answers import AnswerWriter, read_request
from mavstack.http.server import serving
from mavstack.security.admission import Proof

HEAD = b"GET /x?a=1 HTTP/1.1\r\nHost: localhost:8080\r\nConnection: Keep-Alive\r\nX-Empty:\r\n\r\n"
WRITER = AnswerWriter([(b"content-type", b"text/plain")])


def test_an_ordinary_request_is_read() -> None:
    request = read_request(HEAD)
    assert request is not None
    assert request.path == "/x?a=1"
    assert request.headers == {"host": "localhost:8080", "connection": "Keep-Alive", "x-empty": ""}


@pytest.mark.parametrize(
    "data",
    [
        HEAD.replace(b"GET", b"POST"),
        HEAD.replace(b"1.1", b"1.0", 1),
        HEAD.replace(b"Host: localhost:8080\r\n", b""),
        HEAD.replace(b"\r\n", b"\n"),
        HEAD.replace(b"/x", b"http://localhost/x"),
        HEAD.replace(b"Keep-Alive", b"close"),
        HEAD.replace(b"X-Empty", b"Host"),
        HEAD.replace(b"X-Empty", b"Origin"),
        HEAD.replace(b"X-Empty:", b"Content-Length: 1"),
        HEAD.replace(b"X-Empty:", b" folded: 1"),
        HEAD.replace(b"X-Empty:", b"X-Text: \xff"),
        HEAD.replace(b"X-Empty:", b"X-Text: a\rb"),
        HEAD + b"GET",
        HEAD[:-2],
        HEAD.replace(b"X-Empty:", b"X-Long: " + b"x" * 4096),
        b"",
    ],
)
def test_other_requests_are_for_the_server(data) -> None:
    assert read_request(data) is None


def test_an_answer_has_its_length_and_date() -> None:
    head, body = WRITER.write(b"text").split(b"\r\n\r\n")
    status, *fields = head.decode().split("\r\n")
    values = dict(each.split(": ") for each in fields)
    assert (status, body, values["content-length"]) == ("HTTP/1.1 200 OK", b"text", "4")
    assert parsedate_to_datetime(values["date"]).tzinfo is not None


def answer_early(request):
    mark_client(Proof.SPEAKING, "early")
    return WRITER.write(b"early") if request.path == "/early" else None


async def show(request):
    return PlainTextResponse("served")


async def ask(reader, writer, path):
    writer.write(f"GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
    head = await reader.readuntil(b"\r\n\r\n")
    length = int(head.lower().partition(b"content-length: ")[2].split(b"\r\n")[0])
    return await reader.readexactly(length)


APP = Starlette(routes=[Route("/{name}", show)])


def server():
    return serving(APP, "127.0.0.1:0", name="a service", answer_early=answer_early)


async def test_both_ways_in_turns_on_one_connection() -> None:
    async with asyncio.timeout(20), server() as (host, port):
        reader, writer = await asyncio.open_connection(host, port)
        found = [await ask(reader, writer, path) for path in ("/early", "/x", "/early", "/early", "/x")]
        writer.close()
    assert found == [b"early", b"served", b"early", b"early", b"served"]


async def test_parts_of_a_request_and_requests_at_once_are_answered_in_order() -> None:
    async with asyncio.timeout(20), server() as (host, port):
        reader, writer = await asyncio.open_connection(host, port)
        request = b"GET /early HTTP/1.1\r\nHost: localhost\r\n\r\n"
        writer.write(request[:25])
        await asyncio.sleep(0.01)
        writer.write(request[25:])
        await reader.readuntil(b"early")
        writer.write(request.replace(b"early", b"x") + request)
        await reader.readuntil(b"served")
        await reader.readuntil(b"served")  # the second one follows the first through the server
        writer.close()


async def test_connections_that_are_unused_are_closed(monkeypatch) -> None:
    monkeypatch.setattr(idle_timer, "IDLE_TIMEOUT", 0.05)
    async with asyncio.timeout(20), server() as (host, port):
        for path in ("/early", "/x"):
            reader, writer = await asyncio.open_connection(host, port)
            await ask(reader, writer, path)
            assert await reader.read() == b""
            writer.close()


async def test_a_client_that_does_not_read_waits_for_the_server() -> None:
    large = WRITER.write(b"x" * (4 << 20))
    asked = []

    def answer(request):
        asked.append(request.path)
        return large

    early = serving(APP, "127.0.0.1:0", name="a service", answer_early=answer)
    async with asyncio.timeout(20), early as (host, port):
        reader, writer = await asyncio.open_connection(host, port, limit=1 << 10)
        writer.write(b"GET /early HTTP/1.1\r\nHost: localhost\r\n\r\n")
        await reader.readuntil(b"\r\n\r\n")
        writer.write(b"GET /second HTTP/1.1\r\nHost: localhost\r\n\r\n")
        await asyncio.sleep(0.1)
        writer.close()
    assert asked == ["/early"]
