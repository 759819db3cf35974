"""Links over Zenoh: the conformance of links with a real router, and vehicles that come and go."""

from __future__ import annotations

import asyncio
import tomllib
from contextlib import asynccontextmanager, suppress
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from mavstack.bridges.zenoh.keys import VehicleKeys
from mavstack.bridges.zenoh.schemes import ZENOH
from mavstack.errors import LinkError, LinkURLError
from mavstack.links import ChannelClosed, ChannelOpened, parse_url
from mavstack.links.options import Options
from tests.bridges.ros2.running import free_port, zenoh_client, zenoh_router
from tests.links.conformance import Conformance

if TYPE_CHECKING:
    from collections.abc import Iterator

PYPROJECT = Path(__file__).parents[3] / "pyproject.toml"


def zenoh_link(text: str) -> Any:
    """Return the link of a URL, also where the entry point is not installed."""
    url = parse_url(text, {"zenoh": ZENOH})
    module, name = ZENOH.backend.split(":")
    options = Options(url)
    link = getattr(import_module(module), name)(url, options)
    options.refuse_unknown()
    return link


class GatewayPeer:
    """A gateway with one vehicle, by a plain session of Zenoh."""

    def __init__(self, session: Any, name: str = "alpha") -> None:
        keys = VehicleKeys("mavstack", name)
        loop = asyncio.get_running_loop()
        self.session = session
        self.zenoh = pytest.importorskip("zenoh")
        self.received: asyncio.Queue[bytes] = asyncio.Queue()
        self.publisher = session.declare_publisher(keys.frames_out)
        self.subscriber = session.declare_subscriber(
            keys.frames_in,
            lambda sample: loop.call_soon_threadsafe(self.received.put_nowait, bytes(sample.payload)),
        )
        self.token = session.liveliness().declare_token(keys.alive("tower"))

    async def ready(self) -> None:
        async with asyncio.timeout(10):
            while not self.publisher.matching_status.matching:  # noqa: ASYNC110
                await asyncio.sleep(0.01)

    async def send(self, data: bytes) -> None:
        self.publisher.put(data)
        await asyncio.sleep(0)

    async def receive(self, count: int) -> bytes:
        data = b""
        while len(data) < count:
            data += await self.received.get()
        return data

    async def close(self) -> None:
        with suppress(self.zenoh.ZError):  # it was closed before
            self.token.undeclare()


@pytest.fixture(scope="module", name="router")
def _router() -> Iterator[int]:
    with zenoh_router() as port:
        yield port


@pytest.mark.interop
class TestZenoh(Conformance):
    datagrams = True

    @pytest.fixture(autouse=True)
    def _use_router(self, router: int) -> None:
        self.port = router

    @asynccontextmanager
    async def pair(self, query: str = "") -> Any:
        session = zenoh_client(self.port)
        link = zenoh_link(f"zenoh://127.0.0.1:{self.port}/?{query}")

        async def peer() -> GatewayPeer:
            opened = GatewayPeer(session)
            await opened.ready()
            return opened

        yield link, peer
        session.close()


@pytest.mark.interop
async def test_each_vehicle_is_a_channel(router: int) -> None:
    sessions = [zenoh_client(router) for _ in range(2)]
    early = GatewayPeer(sessions[0], "alpha")
    async with asyncio.timeout(20), zenoh_link(f"zenoh://127.0.0.1:{router}") as link:
        first = await anext(link)
        assert isinstance(first, ChannelOpened)
        assert (first.channel.name, first.channel.peer) == ("zenoh alpha", "alpha")
        late = GatewayPeer(sessions[1], "beta")
        second = await anext(link)
        assert second.channel.peer == "beta"
        second.channel.write(b"for beta")
        assert await late.receive(8) == b"for beta"
        assert early.received.empty()
        sessions[1].close()
        assert await anext(link) == ChannelClosed(second.channel, "its gateway does not show it any more")
        assert list(link.channels) == [first.channel]
    sessions[0].close()


@pytest.mark.interop
async def test_one_vehicle_alone(router: int) -> None:
    session = zenoh_client(router)
    peers = [GatewayPeer(session, name) for name in ("alpha", "beta")]
    async with asyncio.timeout(20), zenoh_link(f"zenoh://127.0.0.1:{router}/mavstack?vehicle=beta") as link:
        assert (await anext(link)).channel.peer == "beta"
        await peers[1].ready()
        await peers[0].send(b"alpha")
        await peers[1].send(b"beta")
        assert (await anext(link)).data == b"beta"
    session.close()


@pytest.mark.interop
async def test_no_router() -> None:
    port = free_port()
    with pytest.raises(LinkError, match=f"connecting to the Zenoh router tcp/127.0.0.1:{port} failed"):
        await zenoh_link(f"zenoh://127.0.0.1:{port}?timeout=300ms").open()


@pytest.mark.parametrize(
    ("query", "reason"),
    [
        ("?vehicle=a/b", "the option vehicle must have letters"),
        ("?cert=a.pem", "the options cert and key need each other"),
        ("?vehicl=a", "did you mean vehicle?"),
        ("/a//b", "a prefix of keys must have letters"),
    ],
)
def test_wrong_urls(query: str, reason: str) -> None:
    pytest.importorskip("zenoh")
    with pytest.raises(LinkURLError, match=reason.replace("?", r"\?")):
        zenoh_link(f"zenoh://127.0.0.1{query}")


def test_the_scheme_is_an_entry_point() -> None:
    schemes = tomllib.loads(PYPROJECT.read_text("utf-8"))["project"]["entry-points"]["mavstack.links"]
    module, _, name = schemes["zenoh"].partition(":")
    assert getattr(import_module(module), name) is ZENOH
    url = parse_url(ZENOH.example, {"zenoh": ZENOH})
    assert (url.host, url.port, url.path) == ("127.0.0.1", 7447, "/mavstack")
    assert ZENOH.is_network
    assert not ZENOH.listens
