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
