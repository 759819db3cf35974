"""Attack by connections that never finish their TLS or WebSocket handshake, and fill the memory."""

from __future__ import annotations

import asyncio
import ssl
from contextlib import AsyncExitStack, asynccontextmanager
from typing import TYPE_CHECKING

import pytest

from mavstack.handshakes import MAX_HANDSHAKES
from mavstack.links import open_link
from tests.links.certificates import certificates
from tests.waiting import wait_until

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from mavstack.links import Link

__all__ = ["certificates"]
COUNT = MAX_HANDSHAKES + 16
UPGRADE = b"GET / HTTP/1.1\r\nHost: drone\r\n"


@pytest.fixture(params=["tlsin", "wsin", "wssin"])
def url(request, certificates) -> str:
    query = f"?cert={certificates}/cert.pem&key={certificates}/key.pem"
    return f"{request.param}://127.0.0.1:0" + query * (request.param != "wsin")


def client_url(url: str, link: Link) -> str:
    scheme = {"tlsin": "tls", "wsin": "ws", "wssin": "wss"}[url.partition(":")[0]]
    return f"{scheme}://127.0.0.1:{link.address[1]}" + "?insecure=yes" * (scheme != "ws")


@asynccontextmanager
async def half_open(link: Link, data: bytes = b"") -> AsyncIterator[list[asyncio.StreamReader]]:
    """Open connections that send these bytes and then nothing."""
    async with AsyncExitStack() as stack:
        readers = []
        for _ in range(COUNT):
            reader, writer = await asyncio.open_connection(*link.address)
            stack.callback(writer.close)
            writer.write(data)
            readers.append(reader)
        yield readers


def open_count(readers: list[asyncio.StreamReader]) -> int:
    """Return the number of connections that the server has not closed."""
    return sum(not reader.at_eof() and reader.exception() is None for reader in readers)


@pytest.mark.parametrize("data", [b"", b"\x16", UPGRADE])
async def test_half_open_connections_are_bounded_and_lock_out_no_peer(url, data) -> None:
    async with open_link(url) as link, half_open(link, data) as readers:
        await wait_until(lambda: open_count(readers) <= MAX_HANDSHAKES)
        async with open_link(client_url(url, link)) as client:
            client.channels[0].write(b"hello")
            await wait_until(lambda: link.counters.bytes_in == 5)
        assert len(link.channels) <= 1


async def test_closing_a_link_does_not_wait_for_handshakes(url) -> None:
    link = open_link(url)
    await link.open()
    async with half_open(link) as readers:
        await asyncio.sleep(0)
        async with asyncio.timeout(5):
            await link.close()
        await wait_until(lambda: open_count(readers) == 0)


async def test_a_handshake_that_takes_too_long_ends(url, monkeypatch) -> None:
    for module in ("handshakes", "links.ws"):
        monkeypatch.setattr(f"mavstack.{module}.HANDSHAKE_TIMEOUT", 0.2)
    async with open_link(url) as link, half_open(link, b"\x16") as readers:
        await wait_until(lambda: open_count(readers) == 0)


async def test_bytes_sent_right_after_the_tls_handshake_arrive(certificates) -> None:
    """The client's first bytes can come with the end of its handshake."""
    url = f"tlsin://127.0.0.1:0?cert={certificates}/cert.pem&key={certificates}/key.pem"
    context = ssl.create_default_context(cafile=certificates / "ca.pem")
    async with open_link(url) as link:
        for number in range(1, 6):
            _, writer = await asyncio.open_connection(*link.address, ssl=context)
            writer.write(b"hello")
            writer.close()
            await wait_until(lambda number=number: link.counters.bytes_in == 5 * number)
