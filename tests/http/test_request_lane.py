"""The lane of requests: by counts of other work between a request that comes first and its answer."""

from __future__ import annotations

import asyncio
import socket
from contextlib import ExitStack

import pytest
from starlette.applications import Starlette
from starlette.responses import PlainTextResponse
from starlette.routing import Route

from mavstack.http import connections
from mavstack.http.request_lane import MAX_HEAD, RequestLane, has_whole_head, read_head
from mavstack.http.server import serving
from mavstack.security.admission import Place

OTHERS = 200
OTHER = b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n"
CONTROL = b"POST /control HTTP/1.1\r\nHost: localhost\r\nContent-Length: 2\r\nConnection: close\r\n\r\n{}"
#: Other requests that may run between the arrival of a request that comes first and its answer: one for each
#: turn of the event loop that the server needs for a request.
MAX_BEFORE = 20


class Served:
    """An application that counts its other requests, and how many of them ran before the control request."""

    def __init__(self) -> None:
        self.others = 0
        self.before = -1
        self.app = Starlette(
            routes=[Route("/", self.answer), Route("/control", self.control, methods=["POST"])]
        )

    async def answer(self, _):
        self.others += 1
        await asyncio.sleep(0)
        return PlainTextResponse("other")

    async def control(self, request):
        await request.body()
        self.before = self.others
        return PlainTextResponse("done")


def is_control(head) -> bool:
    return head.method == "POST"


def connected(stack, address, data):
    sock = stack.enter_context(socket.create_connection(address))
    sock.sendall(data)
    sock.setblocking(False)
    return sock


async def read_answer(sock):
    answer = b""
    while part := await asyncio.get_running_loop().sock_recv(sock, 4096):
        answer += part
    return answer


@pytest.mark.parametrize("others", [OTHER, OTHER * 20])
async def test_few_other_requests_run_before_a_control_request(others):
    """Before: all of a burst ran first."""
    served = Served()
    async with (
        asyncio.timeout(60),
        serving(served.app, "127.0.0.1:0", name="a service", comes_first=is_control) as address,
    ):
        with ExitStack() as stack:
            for _ in range(OTHERS):
                connected(stack, address, others)
            assert b"done" in await read_answer(connected(stack, address, CONTROL))
    assert 0 <= served.before <= MAX_BEFORE


async def test_pipelined_requests_run_few_at_a_time():
    """Before: one of each connection ran in each turn of the loop."""
    served = Served()
    async with (
        asyncio.timeout(60),
        serving(served.app, "127.0.0.1:0", name="a service", comes_first=is_control) as address,
    ):
        with ExitStack() as stack:
            for _ in range(50):
                connected(stack, address, OTHER * 100)
            while served.others < 100:  # noqa: ASYNC110 (turns of the loop are counted)
                await asyncio.sleep(0)
            begun = served.others
            assert b"done" in await read_answer(connected(stack, address, CONTROL))
    assert served.before - begun <= MAX_BEFORE


async def test_half_requests_are_not_compared_for_each_newcomer(monkeypatch):
    """Before: each of 600 newcomers compared all connections, 180,000 places together."""
    compared = 0

    def counted(*arguments):
        nonlocal compared
        compared += 1
        return Place(*arguments)

    monkeypatch.setattr(connections, "MAX_CONNECTIONS", 64)
    monkeypatch.setattr(connections, "Place", counted)
    served = Served()
    async with (
        asyncio.timeout(60),
        serving(served.app, "127.0.0.1:0", name="a service", comes_first=is_control) as address,
    ):
        with ExitStack() as stack:
            for _ in range(OTHERS):
                connected(stack, address, OTHER[:-2])
            assert b"done" in await read_answer(connected(stack, address, CONTROL))
    assert 0 < compared <= OTHERS // 4 * 64


@pytest.mark.parametrize("size", [1, 7, len(CONTROL)])
@pytest.mark.parametrize("before", [b"", b"\r\n\r\n"])
async def test_requests_in_parts_and_after_empty_lines_are_served(size, before):
    served = Served()
    async with (
        asyncio.timeout(60),
        serving(served.app, "127.0.0.1:0", name="a service") as (host, port),
    ):
        reader, writer = await asyncio.open_connection(host, port)
        data = before + OTHER + OTHER[:20]  # the next one begins before the first one is answered
        for start in range(0, len(data), size):
            writer.write(data[start : start + size])
            await writer.drain()
            await asyncio.sleep(0)
        await reader.readuntil(b"other")
        writer.write(OTHER[20:-2])
        await writer.drain()
        await asyncio.sleep(0.01)
        writer.write(OTHER[-2:])
        await reader.readuntil(b"other")
        writer.write(CONTROL)
        assert b"done" in await reader.read()
        writer.close()
    assert served.others == 2


async def test_a_head_that_is_too_long_is_refused():
    async with asyncio.timeout(60), serving(Served().app, "127.0.0.1:0", name="a service") as (host, port):
        reader, writer = await asyncio.open_connection(host, port)
        writer.write(b"GET / HTTP/1.1\r\nx: " + b"x" * (MAX_HEAD + 100))
        assert (await reader.readline()).startswith(b"HTTP/1.1 4")
        writer.close()


async def test_one_request_begins_in_each_turn_of_the_loop():
    lane, begun = RequestLane(), 0

    def begin() -> None:
        nonlocal begun
        begun += 1

    for _ in range(5):
        lane.enter(begin)
    for expected in range(5):
        assert begun == expected
        await asyncio.sleep(0)
    await asyncio.wait_for(lane.turn(), 5)


@pytest.mark.parametrize("end", [b"\r\n", b"\n"])
def test_the_head_of_a_request_shows_whose_it_is(end):
    lines = [
        b"POST /x HTTP/1.1",
        b"cookie: a=b",
        b"AUTHORIZATION:  Bearer t ",
        b"",
        b"cookie: no",
    ]
    data = end.join(lines)
    assert has_whole_head(data)
    assert not has_whole_head(end.join(lines[:3]) + end)
    assert read_head(data) == ("POST", "Bearer t", "a=b")
    assert read_head(b"GET / HTTP/1.1" + end * 2) == ("GET", "", "")
