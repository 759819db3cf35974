from __future__ import annotations

import asyncio
import sys
from contextlib import asynccontextmanager

import pytest

from mavstack.errors import LinkError, LinkURLError, MissingExtraError
from mavstack.links import ChannelClosed, ChannelOpened, LinkDown, open_link

from .certificates import certificates  # noqa: F401 - a fixture
from .conformance import Conformance, receive

pytest.importorskip("websockets")

from websockets.asyncio.client import connect
from websockets.asyncio.server import serve
from websockets.exceptions import ConnectionClosed, InvalidStatus

from mavstack.links.ws import WsServer


class WsPeer:
    def __init__(self, socket) -> None:
        self.socket = socket
        self.rest = b""

    async def send(self, data: bytes) -> None:
        await self.socket.send(data)

    async def receive(self, count: int) -> bytes:
        while len(self.rest) < count:
            self.rest += await self.socket.recv()
        data, self.rest = self.rest[:count], self.rest[count:]
        return data

    async def close(self) -> None:
        await self.socket.close()


class WsAcceptor:
    """A WebSocket server that queues its connections."""

    def __init__(self) -> None:
        self.accepted = asyncio.Queue()
        self.server = None

    async def listen(self, port: int = 0) -> int:
        self.server = await serve(self._accept, "127.0.0.1", port, close_timeout=0.1)
        return self.server.sockets[0].getsockname()[1]

    async def _accept(self, socket) -> None:
        self.accepted.put_nowait(WsPeer(socket))
        await socket.wait_closed()

    async def close(self) -> None:
        self.server.close()
        await self.server.wait_closed()


class TestWsin(Conformance):
    @asynccontextmanager
    async def pair(self, query=""):
        link = open_link(f"wsin://127.0.0.1:0?{query}")

        async def peer():
            return WsPeer(await connect(f"ws://127.0.0.1:{link.address[1]}", close_timeout=0.1, proxy=None))

        yield link, peer


class TestWs(Conformance):
    @asynccontextmanager
    async def pair(self, query=""):
        acceptor = WsAcceptor()
        port = await acceptor.listen()
        yield open_link(f"ws://127.0.0.1:{port}/mavlink?{query}"), acceptor.accepted.get
        await acceptor.close()


async def test_both_ends_over_tls(certificates):  # noqa: F811
    server_url = f"wssin://127.0.0.1:0?cert={certificates}/cert.pem&key={certificates}/key.pem"
    async with open_link(server_url) as server:
        url = f"wss://127.0.0.1:{server.address[1]}?ca={certificates}/ca.pem"
        async with open_link(url) as client:
            (await anext(client)).channel.write(b"secret")
            await anext(server)
            assert await receive(server, 6) == b"secret"


async def test_web_pages_are_refused_unless_their_origin_is_given():
    async with open_link("wsin://127.0.0.1:0") as link:
        url = f"ws://127.0.0.1:{link.address[1]}"
        with pytest.raises(InvalidStatus, match="403"):
            await connect(url, origin="https://evil.example", proxy=None)
    async with open_link("wsin://127.0.0.1:0?origin=https://ground.example") as link:
        url = f"ws://127.0.0.1:{link.address[1]}"
        socket = await connect(url, origin="https://ground.example", proxy=None)
        await socket.close()
    async with open_link("wsin://127.0.0.1:0?origin=*") as link:
        url = f"ws://127.0.0.1:{link.address[1]}"
        socket = await connect(url, origin="https://any.example", proxy=None)
        await socket.close()


async def test_text_messages_are_dropped():
    async with open_link("wsin://127.0.0.1:0") as link:
        socket = await connect(f"ws://127.0.0.1:{link.address[1]}", proxy=None)
        channel = (await anext(link)).channel
        await socket.send("text")
        await socket.send(b"bytes")
        assert await receive(link, 5) == b"bytes"
        assert channel.counters.dropped_in == 1
        await socket.close()


async def test_a_full_link_closes_the_idlest_peer_for_a_new_one():
    async with open_link("wsin://127.0.0.1:0?max_peers=1") as link:
        url = f"ws://127.0.0.1:{link.address[1]}"
        first, second = await connect(url, proxy=None), await connect(url, proxy=None)
        with pytest.raises(ConnectionClosed):
            await first.recv()
        assert len(link.channels) == 1
        await second.close()


async def test_the_client_reconnects_to_a_restarted_server():
    acceptor = WsAcceptor()
    port = await acceptor.listen()
    async with open_link(f"ws://127.0.0.1:{port}/?retry=1ms&retry_limit=2ms") as link:
        assert isinstance(await anext(link), ChannelOpened)
        await acceptor.close()
        assert isinstance(await anext(link), ChannelClosed)
        assert isinstance(await anext(link), LinkDown)
        await acceptor.listen(port)
        while isinstance(event := await anext(link), LinkDown):
            pass
        assert isinstance(event, ChannelOpened)
    await acceptor.close()


async def test_a_server_without_websockets_raises():
    async def answer(reader, writer):
        await reader.readuntil(b"\r\n\r\n")
        writer.write(b"HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\n\r\n")
        writer.close()

    server = await asyncio.start_server(answer, "127.0.0.1", 0)
    port = server.sockets[0].getsockname()[1]
    with pytest.raises(LinkError, match=r"the server refused the WebSocket: .*404"):
        await open_link(f"ws://127.0.0.1:{port}/mavlink")
    server.close()
    await server.wait_closed()


async def test_a_port_in_use_raises():
    async with open_link("wsin://127.0.0.1:0") as first:
        with pytest.raises(LinkError, match="is in use"):
            await open_link(f"wsin://127.0.0.1:{first.address[1]}")


def test_a_missing_extra_raises(monkeypatch):
    monkeypatch.setitem(sys.modules, "websockets.asyncio.client", None)
    monkeypatch.delitem(sys.modules, "mavstack.links.ws", raising=False)
    with pytest.raises(MissingExtraError, match=r"pip install 'mavstack\[web\]'"):
        open_link("ws://127.0.0.1:5770")


# requests: headers, query, subprotocols and tokens


async def test_the_request_of_a_client_reaches_the_server():
    async with open_link("wsin://127.0.0.1:0?subprotocol=mavlink,raw") as server:
        port = server.address[1]
        url = f"ws://127.0.0.1:{port}/fleet%20one?query.vehicle=7&query.room=a%26b&header.X-Team=red"
        async with open_link(f"{url}&subprotocol=other,mavlink&origin="):
            request = (await anext(server)).channel.request
    assert request.path == "/fleet one"
    assert request.query == {"vehicle": "7", "room": "a&b"}
    assert request.headers["x-team"] == "red"
    assert request.subprotocol == "mavlink"
    assert "red" not in repr(request)


async def test_a_path_that_is_no_url_is_a_path():
    async with open_link("wsin://127.0.0.1:0") as server:
        reader, writer = await asyncio.open_connection("127.0.0.1", server.address[1])
        head = "Host: x\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
        key = "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
        writer.write(f"GET //[bad?room=1 HTTP/1.1\r\n{head}{key}".encode())
        assert (await reader.readline()).startswith(b"HTTP/1.1 101")
        assert (await anext(server)).channel.request.query == {"room": "1"}
        writer.close()


async def test_other_channels_have_no_request():
    server = await open_link("wsin://127.0.0.1:0")
    async with server, open_link(f"ws://127.0.0.1:{server.address[1]}") as client:
        assert (await anext(client)).channel.request is None


async def test_a_client_sends_its_token_and_its_origin():
    acceptor = WsAcceptor()
    port = await acceptor.listen()
    url = f"ws://127.0.0.1:{port}/?token=abc%20def&origin=https://ground.example"
    async with open_link(url) as client:
        headers = (await acceptor.accepted.get()).socket.request.headers
        assert (headers["Authorization"], headers["Origin"]) == ("Bearer abc def", "https://ground.example")
        assert "abc" not in client.url.redacted
    await acceptor.close()


@pytest.mark.parametrize(
    ("headers", "path"),
    [
        ({"Authorization": "Bearer right"}, "/"),
        ({"authorization": "bearer right"}, "/"),
        ({}, "/?access_token=right"),
    ],
)
async def test_a_server_accepts_its_token(headers, path):
    async with open_link("wsin://127.0.0.1:0?token=right") as server:
        url = f"ws://127.0.0.1:{server.address[1]}{path}"
        socket = await connect(url, additional_headers=headers, proxy=None)
        assert isinstance(await anext(server), ChannelOpened)
        await socket.close()


@pytest.mark.parametrize(
    "query", ["", "&token=wrong", "&query.access_token=", "&header.Authorization=Basic%20x"]
)
async def test_a_server_refuses_clients_without_its_token(query):
    async with open_link("wsin://127.0.0.1:0?token=right") as server:
        with pytest.raises(LinkError, match="401") as refused:
            await open_link(f"ws://127.0.0.1:{server.address[1]}?reconnect=no{query}")
        assert "wrong" not in str(refused.value)
        assert not server.channels


async def test_a_program_decides_by_the_request():
    server = WsServer.of("wsin://127.0.0.1:0")
    server.accept = lambda request: None if "vehicle" in request.query else "name your vehicle"
    async with server:
        url = f"ws://127.0.0.1:{server.address[1]}"
        with pytest.raises(LinkError, match="403"):
            await open_link(url)
        async with open_link(f"{url}?query.vehicle=7"):
            assert (await anext(server)).channel.request.query == {"vehicle": "7"}


async def test_a_server_with_subprotocols_needs_one_of_them():
    async with open_link("wsin://127.0.0.1:0?subprotocol=mavlink") as server:
        with pytest.raises(LinkError, match="refused the WebSocket"):
            await open_link(f"ws://127.0.0.1:{server.address[1]}?subprotocol=other")


@pytest.mark.parametrize("option", ["header.A%20B=x", "header.A=x%0d%0aB:%20y", "token=a%0ab", "header.=x"])
def test_a_header_that_http_does_not_allow_is_refused(option):
    with pytest.raises(LinkURLError, match="HTTP does not allow the header"):
        open_link(f"ws://127.0.0.1:1?{option}")


def test_only_a_websocket_server_has_an_accept_callback():
    with pytest.raises(LinkURLError, match="is not a WebSocket server"):
        WsServer.of("ws://127.0.0.1:1")


async def test_a_client_certificate_is_required_and_names_the_client(certificates):  # noqa: F811
    own = f"cert={certificates}/cert.pem&key={certificates}/key.pem&ca={certificates}/ca.pem"
    async with open_link(f"wssin://127.0.0.1:0?{own}") as server:
        url = f"wss://127.0.0.1:{server.address[1]}?reconnect=no"
        with pytest.raises(LinkError):
            await open_link(f"{url}&ca={certificates}/ca.pem")
        async with open_link(f"{url}&{own}"):
            assert (await anext(server)).channel.identity == "CN=127.0.0.1"
