from __future__ import annotations

import asyncio
import ssl
from contextlib import asynccontextmanager

import pytest

from mavstack.errors import LinkError, LinkURLError
from mavstack.links import ChannelOpened, open_link
from mavstack.links.certificates import client_subject

from .certificates import certificates  # noqa: F401 - a fixture
from .conformance import Conformance
from .peers import Acceptor, StreamPeer


class UsesCertificates(Conformance):
    @pytest.fixture(autouse=True)
    def _certificates(self, certificates):  # noqa: F811
        self.folder = certificates


class TestTls(UsesCertificates):
    @asynccontextmanager
    async def pair(self, query=""):
        context = ssl.create_default_context(ssl.Purpose.CLIENT_AUTH)
        context.load_cert_chain(self.folder / "cert.pem", self.folder / "key.pem")
        acceptor = Acceptor()
        port = await acceptor.listen_tcp(ssl=context)
        yield open_link(f"tls://127.0.0.1:{port}?ca={self.folder}/ca.pem&{query}"), acceptor.accepted.get
        await acceptor.close()


class TestTlsin(UsesCertificates):
    @asynccontextmanager
    async def pair(self, query=""):
        link = open_link(f"tlsin://127.0.0.1:0?cert={self.folder}/cert.pem&key={self.folder}/key.pem&{query}")
        context = ssl.create_default_context(cafile=self.folder / "ca.pem")

        async def peer():
            return StreamPeer(*await asyncio.open_connection(*link.address, ssl=context))

        yield link, peer


@pytest.fixture
def server_url(certificates):  # noqa: F811
    return f"tlsin://127.0.0.1:0?cert={certificates}/cert.pem&key={certificates}/key.pem"


async def test_an_untrusted_server_raises_unless_insecure(server_url):
    async with open_link(server_url) as server:
        url = f"tls://127.0.0.1:{server.address[1]}"
        with pytest.raises(LinkError, match=r"not trusted .*\?ca="):
            await open_link(url)
        async with open_link(url, insecure=True) as client:
            assert isinstance(await anext(client), ChannelOpened)


async def test_a_certificate_for_another_name_is_refused(server_url, certificates):  # noqa: F811
    async with open_link(server_url) as server:
        url = f"tls://127.0.0.1:{server.address[1]}?ca={certificates}/ca.pem"
        with pytest.raises(LinkError, match="not trusted"):
            await open_link(url, server_name="ground.example")


async def test_a_server_may_require_client_certificates(server_url, certificates):  # noqa: F811
    async with open_link(server_url, ca=certificates / "ca.pem") as server:
        url = f"tls://127.0.0.1:{server.address[1]}?ca={certificates}/ca.pem"
        async with open_link(url, cert=certificates / "cert.pem", key=certificates / "key.pem") as client:
            (await anext(client)).channel.write(b"known")
            assert isinstance(await anext(server), ChannelOpened)
            assert (await anext(server)).data == b"known"
        await anext(server)
        # In TLS 1.3 the server refuses the client after the handshake.
        async with open_link(url, reconnect=False) as refused:
            assert len([event async for event in refused]) == 2
        assert not server.channels


@pytest.mark.parametrize(
    ("url", "problem"),
    [
        ("tlsin://127.0.0.1:0", r"no certificate: add \?cert="),
        ("tlsin://127.0.0.1:0?cert=none.pem", "cannot use the certificate none.pem"),
        ("tls://127.0.0.1:1?ca=none.pem", "cannot read the certificate authority none.pem"),
    ],
)
def test_unusable_certificates_raise(url, problem):
    with pytest.raises(LinkError, match=problem):
        open_link(url)


def test_an_encrypted_key_raises_without_a_prompt(certificates):  # noqa: F811
    with pytest.raises(LinkError, match="encrypted"):
        open_link(f"tlsin://127.0.0.1:0?cert={certificates}/cert.pem&key={certificates}/locked.pem")


async def test_a_peer_without_tls_raises():
    acceptor = Acceptor()
    port = await acceptor.listen_tcp()
    opening = asyncio.create_task(open_link(f"tls://127.0.0.1:{port}?insecure=yes").open())
    peer = await acceptor.accepted.get()
    await peer.send(b"\xfd" * 100)
    with pytest.raises(LinkError, match="check that the peer uses TLS"):
        await opening
    await acceptor.close()


def test_a_missing_certificate_is_a_link_url_error():
    with pytest.raises(LinkURLError):
        open_link("wssin://127.0.0.1:0")


async def test_the_subject_of_a_clients_certificate_is_its_identity(server_url, certificates):  # noqa: F811
    async with open_link(f"{server_url}&ca={certificates}/ca.pem") as server:
        own = f"ca={certificates}/ca.pem&cert={certificates}/cert.pem&key={certificates}/key.pem"
        async with open_link(f"tls://127.0.0.1:{server.address[1]}?{own}"):
            assert (await anext(server)).channel.identity == "CN=127.0.0.1"


def test_no_subject_looks_like_another():
    class Transport:
        def get_extra_info(self, _name):
            return {"subject": ((("commonName", "a,O=b\n"),), (("organizationName", "c"),))}

    assert client_subject(Transport()) == "CN=a\\,O\\=b\N{REPLACEMENT CHARACTER},O=c"
