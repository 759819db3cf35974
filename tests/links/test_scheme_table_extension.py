"""A new scheme costs two files: its module in `mavstack.links.schemes`, with the backend, and its test."""

from __future__ import annotations

import sys
from types import SimpleNamespace

import pytest

from docs._tools import link_options
from mavstack.cli.common.exposure import announce_exposure
from mavstack.errors import LinkURLError
from mavstack.links import BytesReceived, ChannelOpened, open_link, schemes
from mavstack.links.client_urls import is_network_scheme
from mavstack.links.scheme_table import builtin_schemes, find_scheme

MODULE = '''
"""Links that return what is written to them."""

from __future__ import annotations

from time import time

from mavstack.links.base import Link
from mavstack.links.channel import Channel
from mavstack.links.scheme import AddressKind, LinkScheme

SCHEMES = (
    LinkScheme(
        name="echoin",
        backend="mavstack.links.schemes.echo:EchoLink",
        address=AddressKind.HOST,
        example="echoin://0.0.0.0:7",
        purpose="Returns what is written.",
        listens=True,
        is_stream=True,
        default_port=7,
        aliases={"echo": {}},
        options={"times": "how often a chunk returns"},
    ),
)


class EchoChannel(Channel):
    def __init__(self, link):
        super().__init__("echoin here", "here", link.inbox.remove_channel)
        self._link = link

    def send_bytes(self, data):
        for _ in range(self._link.times):
            self._link.inbox.deliver(self, bytes(data), time())
        return True

    def close_transport(self):
        pass


class EchoLink(Link):
    def __init__(self, url, options):
        super().__init__(url, options)
        self.times = options.integer("times", 1)

    async def open_transport(self):
        self.inbox.add_channel(EchoChannel(self))
'''


@pytest.fixture
def _echo(tmp_path, monkeypatch):
    (tmp_path / "echo.py").write_text(MODULE)
    monkeypatch.setattr(schemes, "__path__", [*schemes.__path__, str(tmp_path)])
    forget()
    yield
    sys.modules.pop("mavstack.links.schemes.echo", None)
    forget()


def forget():
    builtin_schemes.cache_clear()
    find_scheme.cache_clear()


@pytest.mark.usefixtures("_echo")
async def test_its_links_open():
    async with open_link("echo://127.0.0.1?times=2") as link:
        assert str(link.url) == "echoin://127.0.0.1:7?times=2"
        opened = await anext(link)
        assert isinstance(opened, ChannelOpened)
        opened.channel.write(b"hello")
        for _ in range(2):
            event = await anext(link)
            assert isinstance(event, BytesReceived)
            assert event.data == b"hello"


@pytest.mark.usefixtures("_echo")
def test_everything_that_has_to_know_it_knows_it(capsys):
    with pytest.raises(LinkURLError, match="did you mean echoin"):
        open_link("echooin://127.0.0.1")
    assert is_network_scheme("echoin")
    announce_exposure("watch", [SimpleNamespace(url=open_link("echoin://0.0.0.0:7").url)])
    assert "echoin://0.0.0.0:7 can be reached from the network" in capsys.readouterr().err


@pytest.mark.usefixtures("_echo")
def test_the_documentation_lists_it_with_its_options():
    text = link_options.render()
    assert "| `echoin` | `echoin://0.0.0.0:7` | Returns what is written. |" in text
    assert "| `times` | integer | 1 | how often a chunk returns |" in text


def test_it_is_unknown_without_its_module():
    assert "echoin" not in builtin_schemes()
