"""The kind of endpoint for a configuration: native where the engine can read the descriptor itself."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Final, cast

from mavstack.links.registry import open_link
from mavstack.router.endpoints.carried import CarriedEndpoint
from mavstack.router.endpoints.native import SerialEndpoint, SocketEndpoint, UdpEndpoint
from mavstack.router.endpoints.recorder import RecorderEndpoint
from mavstack.router.endpoints.server import ServerEndpoint

if TYPE_CHECKING:
    from mavstack.links.base import Link
    from mavstack.router.attachments import Attachments
    from mavstack.router.config import EndpointConfig
    from mavstack.router.endpoints.base import Endpoint

#: Options of links that Python applies: roles of clients, and the threads of a serial port.
_CARRIED: Final = frozenset({"role", "roles", "threads"})


def make_endpoint(config: EndpointConfig, attachments: Attachments) -> Endpoint:
    """Return the endpoint of a configuration, not open yet.

    Args:
        config: The configuration of the endpoint.
        attachments: The links of the engine.

    Raises:
        LinkError: The URL is malformed, or a certificate cannot be read.
        MissingExtraError: The scheme needs an optional dependency.
    """
    if config.record is not None:
        return RecorderEndpoint(config, attachments, config.record)
    link = open_link(config.url)
    native = config.high_latency is None and not _CARRIED & link.url.options.keys()
    return (_native_endpoint(config, attachments, link) if native else None) or CarriedEndpoint(
        config, attachments, link
    )


def _native_endpoint(config: EndpointConfig, attachments: Attachments, link: Link) -> Endpoint | None:
    """Return the endpoint of a link whose descriptor the engine can read itself, or None.

    Exactly these classes: TLS derives from TCP, and an impaired link wraps another.
    """
    from mavstack.links.serial import SerialLink
    from mavstack.links.tcp import TcpClient, TcpServer
    from mavstack.links.udp import UdpListener
    from mavstack.links.udp_sender import UdpSender
    from mavstack.links.unix import UnixClient, UnixServer

    kind = type(link)
    if kind in (UdpListener, UdpSender):
        return UdpEndpoint(config, attachments, cast("UdpListener | UdpSender", link))
    if kind in (TcpClient, UnixClient):
        return SocketEndpoint(config, attachments, cast("TcpClient | UnixClient", link))
    if kind in (TcpServer, UnixServer):
        return ServerEndpoint(config, attachments, cast("TcpServer | UnixServer", link))
    if kind is SerialLink and sys.platform != "win32":
        return SerialEndpoint(config, attachments, cast("SerialLink", link))
    return None
