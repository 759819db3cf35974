"""The registry of link backends by URL scheme; each backend is a module that is imported on first use.

Other packages add schemes by entry points of the group `mavstack.links`. The entry point has the name of the
scheme and loads a callable that takes a `LinkURL` and its `Options` and returns a `Link`. Entry points are
looked up only for schemes that are not built in.
"""

from __future__ import annotations

from importlib import import_module
from os.path import isfile
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, TypeAlias

from mavstack.links.impairment import Impairment
from mavstack.links.options import Options
from mavstack.links.url import SEALED, LinkURL, parse_url

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from importlib.metadata import EntryPoints

    from mavstack.links.base import Link

ENTRY_POINTS = "mavstack.links"

#: The values of the option `radio`, the default first.
RADIOS: Final = ("none", "sik")

Backend: TypeAlias = "Callable[[LinkURL, Options], Link]"

BACKENDS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "udpin": "udp:UdpListener",
        "udpout": "udp_sender:UdpSender",
        "tcpin": "tcp:TcpServer",
        "tcpout": "tcp:TcpClient",
        "tls": "tls:TlsClient",
        "tlsin": "tls:TlsServer",
        "serial": "serial:SerialLink",
        "pty": "pseudo_terminal:PseudoTerminalLink",
        "unix": "unix:UnixClient",
        "unixin": "unix:UnixServer",
        "ws": "ws:WsClient",
        "wss": "ws:WsClient",
        "wsin": "ws:WsServer",
        "wssin": "ws:WsServer",
        "sealed+udpin": "sealed:SealedLink",
        "sealed+udpout": "sealed:SealedLink",
        "sealed+tcpin": "sealed:SealedLink",
        "sealed+tcpout": "sealed:SealedLink",
        "sealed+serial": "sealed:SealedLink",
        "file": "file:FileLink",
        "memory": "memory:refuse_url",
    }
)


def open_link(url: str | LinkURL, **options: object) -> Link:
    """Create the link of a URL; `async with` or `await` opens it.

    Args:
        url: A link URL such as `udpin://0.0.0.0:14550`, a serial device, or the path of a file to replay.
        options: Options in addition to those of the URL, such as `reconnect=False`.

    Returns:
        The link, not open yet.

    Raises:
        LinkURLError: The URL is malformed, or an option is unknown or malformed.
        LinkError: A certificate cannot be read.
        MissingExtraError: The scheme needs an optional dependency.
    """
    parsed = (resolve_url(url) if isinstance(url, str) else url).with_options(**options)
    reader = Options(parsed)
    is_sealed = parsed.scheme.startswith(SEALED)  # it impairs the link that it seals
    link = _backend(parsed.scheme)(parsed, reader) if is_sealed else impaired_link(parsed, reader)
    reader.refuse_unknown()
    return link


def impaired_link(url: LinkURL, options: Options) -> Link:
    """Create the link of a URL with the impairments of its options."""
    impairment = Impairment.from_options(options)
    radio = options.choice("radio", RADIOS)
    link = _backend(url.scheme)(url, options)
    if radio == "sik":
        from mavstack.links.radio import sik_radio

        return sik_radio(link, impairment)
    if impairment is None:
        return link
    from mavstack.links.impaired import impair

    return impair(link, impairment)


def plain_link(url: LinkURL, options: Options) -> Link:
    """Create the link of a URL without the impairments of its options, for a link that is built upon it."""
    return _backend(url.scheme)(url, options)


def resolve_url(text: str) -> LinkURL:
    """Parse a URL, or the path of an existing file without a scheme; raises `LinkURLError`."""
    scheme, separator, _ = text.partition("://")
    if separator and scheme not in BACKENDS:
        return parse_url(text, plugins().names)
    is_file = isfile(text)  # noqa: PTH113 - unlike Path.is_file, it never raises
    return LinkURL("file", path=text) if is_file else parse_url(text)


def plugins() -> EntryPoints:
    """Return the entry points of other packages, by scheme."""
    from importlib.metadata import entry_points

    return entry_points(group=ENTRY_POINTS)


def _backend(scheme: str) -> Backend:
    if scheme not in BACKENDS:
        backend: Backend = plugins()[scheme].load()
        return backend
    module, name = BACKENDS[scheme].split(":")
    builtin: Backend = getattr(import_module(f"mavstack.links.{module}"), name)
    return builtin
