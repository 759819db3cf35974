"""From a URL to a link: a dictionary of backends, one file each, imported on first use.

Other packages add schemes by an entry point of the group `mavstack.links`, named as the scheme, that loads
to a callable taking a `LinkURL` and its `Options` and returning a `Link`. They are looked for only when a
scheme is not one of ours.
"""

from __future__ import annotations

from importlib import import_module
from os.path import isfile
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, TypeAlias

from mavstack.links.impairment import Impairment
from mavstack.links.options import Options
from mavstack.links.url import LinkURL, parse_url

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from importlib.metadata import EntryPoints

    from mavstack.links.base import Link

ENTRY_POINTS = "mavstack.links"

Backend: TypeAlias = "Callable[[LinkURL, Options], Link]"

BACKENDS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "udpin": "udp:UdpListener",
        "udpout": "udp:UdpSender",
        "tcpin": "tcp:TcpServer",
        "tcpout": "tcp:TcpClient",
        "tls": "tls:TlsClient",
        "tlsin": "tls:TlsServer",
        "serial": "serial:SerialLink",
        "unix": "unix:UnixClient",
        "unixin": "unix:UnixServer",
        "ws": "ws:WsClient",
        "wss": "ws:WsClient",
        "wsin": "ws:WsServer",
        "wssin": "ws:WsServer",
        "file": "file:FileLink",
        "memory": "memory:refuse",
    }
)


def open_link(url: str | LinkURL, **options: object) -> Link:
    """The link of a URL: `async with` or `await` opens it. Options are added to those of the URL.

    Raises `LinkURLError` at once for a URL or an option that is not understood.
    """
    parsed = (understand(url) if isinstance(url, str) else url).with_options(**options)
    reader = Options(parsed)
    impairment = Impairment.from_options(reader)
    link = _backend(parsed.scheme)(parsed, reader)
    reader.finish()
    if impairment is None:
        return link
    from mavstack.links.impaired import impair

    return impair(link, impairment)


def understand(text: str) -> LinkURL:
    """Parse a URL; beyond `parse_url`, an existing file may be named without any scheme."""
    scheme, separator, _ = text.partition("://")
    if separator and scheme not in BACKENDS:
        return parse_url(text, plugins().names)
    is_file = isfile(text)  # noqa: PTH113 - unlike Path's, this one does not raise for any text
    return LinkURL("file", path=text) if is_file else parse_url(text)


def plugins() -> EntryPoints:
    """The schemes of other packages."""
    from importlib.metadata import entry_points

    return entry_points(group=ENTRY_POINTS)


def _backend(scheme: str) -> Backend:
    if scheme not in BACKENDS:
        backend: Backend = plugins()[scheme].load()
        return backend
    module, name = BACKENDS[scheme].split(":")
    found: Backend = getattr(import_module(f"mavstack.links.{module}"), name)
    return found
