from __future__ import annotations

import asyncio
import sys
from contextlib import asynccontextmanager

import pytest

from mavstack.errors import LinkError
from mavstack.links import ChannelClosed, ChannelOpened, LinkDown, open_link

from .conformance import Conformance
from .peers import Acceptor, StreamPeer

posix_only = pytest.mark.skipif(sys.platform == "win32", reason="unix sockets are not available on Windows")


@posix_only
class TestUnixIn(Conformance):
    @pytest.fixture(autouse=True)
    def _path(self, tmp_path):
        self.path = tmp_path / "link.sock"

    @asynccontextmanager
    async def pair(self, query=""):
        async def peer():
            return StreamPeer(*await asyncio.open_unix_connection(self.path))

        yield open_link(f"unixin://{self.path}?{query}"), peer


@posix_only
class TestUnix(Conformance):
    @pytest.fixture(autouse=True)
    def _path(self, tmp_path):
        self.path = tmp_path / "link.sock"

    @asynccontextmanager
    async def pair(self, query=""):
        acceptor = Acceptor()
        await acceptor.listen_unix(self.path)
        yield open_link(f"unix://{self.path}?{query}"), acceptor.accepted.get
        await acceptor.close()
        self.path.unlink(missing_ok=True)


@posix_only
async def test_a_missing_socket_raises(tmp_path):
    with pytest.raises(LinkError, match="no such file or device"):
        await open_link(f"unix://{tmp_path}/none")


@posix_only
async def test_the_socket_of_a_dead_server_is_replaced_and_of_a_live_one_not(tmp_path):
    path = tmp_path / "link.sock"
    async with open_link(f"unixin://{path}"):
        with pytest.raises(LinkError, match="another program listens on it"):
            await open_link(f"unixin://{path}")
    assert not path.exists()
    dead = Acceptor()
    await dead.listen_unix(path)
    path.rename(tmp_path / "kept")
    await dead.close()
    (tmp_path / "kept").rename(path)
    async with open_link(f"unixin://{path}"), open_link(f"unix://{path}") as client:
        assert isinstance(await anext(client), ChannelOpened)


@posix_only
async def test_the_client_reconnects_to_a_restarted_server(tmp_path):
    path = tmp_path / "link.sock"
    server = await open_link(f"unixin://{path}")
    async with open_link(f"unix://{path}?retry=1ms") as client:
        assert isinstance(await anext(client), ChannelOpened)
        await server.close()
        assert isinstance(await anext(client), ChannelClosed)
        async with open_link(f"unixin://{path}"):
            while isinstance(event := await anext(client), LinkDown):
                pass
            assert isinstance(event, ChannelOpened)


async def test_unix_sockets_raise_on_windows(monkeypatch):
    monkeypatch.setattr(sys, "platform", "win32")
    with pytest.raises(LinkError, match="not available on Windows; use tcpin"):
        await open_link("unix:///tmp/x")


@posix_only
async def test_frames_keep_the_boundaries_of_chunks(tmp_path):
    path = tmp_path / "link.sock"
    acceptor = Acceptor()
    await acceptor.listen_unix(path)
    async with open_link(f"unix://{path}?framing=length") as client:
        peer = await acceptor.accepted.get()
        channel = (await anext(client)).channel
        channel.write(b"abc")
        channel.write(b"defg")
        assert await peer.receive(15) == b"\0\0\0\3abc\0\0\0\4defg"
        await peer.send(b"\0\0\0\2hi\0\0\0\0\0\0\0\3you")
        assert [(await anext(client)).data for _ in range(2)] == [b"hi", b"you"]
        assert channel.counters.bytes_in == 5
    await acceptor.close()


@posix_only
async def test_a_peer_without_frames_is_disconnected_with_the_reason(tmp_path):
    path = tmp_path / "link.sock"
    async with open_link(f"unixin://{path}?framing=length") as server, open_link(f"unix://{path}") as client:
        (await anext(client)).channel.write(b"\xfd\x09\x00\x00 a plain packet")
        assert isinstance(await anext(server), ChannelOpened)
        closed = await anext(server)
        assert isinstance(closed, ChannelClosed)
        assert "does not use framing=length" in closed.reason


@posix_only
class TestFramedUnix(Conformance):
    """Both ends of a framed link."""

    @asynccontextmanager
    async def pair(self, query=""):
        path = self.path

        class FramedPeer:
            """The other end, whose frames the test does not see."""

            def __init__(self, link, channel) -> None:
                self.link, self.channel, self.rest = link, channel, b""

            async def send(self, data: bytes) -> None:
                self.channel.write(data)
                await self.channel.drain()

            async def receive(self, count: int) -> bytes:
                while len(self.rest) < count:
                    self.rest += (await anext(self.link)).data
                data, self.rest = self.rest[:count], self.rest[count:]
                return data

            async def close(self) -> None:
                await self.link.close()

        async def peer():
            link = await open_link(f"unix://{path}?framing=length&reconnect=no")
            return FramedPeer(link, (await anext(link)).channel)

        yield open_link(f"unixin://{path}?framing=length&{query}"), peer

    @pytest.fixture(autouse=True)
    def _path(self, tmp_path):
        self.path = tmp_path / "link.sock"
