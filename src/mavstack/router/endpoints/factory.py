"""The kind of endpoint for a configuration: native where the engine can read the descriptor itself."""

from __future__ import annotations

import sys
from importlib import import_module
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, cast

from mavstack.links.registry import open_link

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.links.base import Link
    from mavstack.router.attachments import Attachments
    from mavstack.router.config import EndpointConfig
    from mavstack.router.endpoints.base import Endpoint

_SERIAL: Final = "native:SerialEndpoint"
#: Module and class of the endpoint, by the class of the link. Subclasses do not count: a TLS link is a
#: subclass of the TCP link, and needs another endpoint.
_NATIVE: Final[Mapping[str, str]] = MappingProxyType(
    {
        "mavstack.links.udp.UdpListener": "native:UdpEndpoint",
        "mavstack.links.udp_sender.UdpSender": "native:UdpEndpoint",
        "mavstack.links.tcp.TcpClient": "native:SocketEndpoint",
        "mavstack.links.unix.UnixClient": "native:SocketEndpoint",
        "mavstack.links.tcp.TcpServer": "server:ServerEndpoint",
        "mavstack.links.unix.UnixServer": "server:ServerEndpoint",
        "mavstack.links.serial.SerialLink": _SERIAL,
    }
)
#: Link options that only Python links support: roles of clients, and threads for a serial port.
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
    # Import only the needed class: without a recorder, a router starts without the modules of log files.
    if config.record is not None:
        from mavstack.router.endpoints.recorder import RecorderEndpoint

        return RecorderEndpoint(config, attachments, config.record)
    link = open_link(config.url)
    native = config.high_latency is None and not _CARRIED & link.url.options.keys()
    if native and (endpoint := _native_endpoint(config, attachments, link)) is not None:
        return endpoint
    from mavstack.router.endpoints.carried import CarriedEndpoint

    return CarriedEndpoint(config, attachments, link)


def _native_endpoint(config: EndpointConfig, attachments: Attachments, link: Link) -> Endpoint | None:
    """Return the endpoint of a link whose descriptor the engine can read itself, or None."""
    kind = type(link)
    place = _NATIVE.get(f"{kind.__module__}.{kind.__qualname__}")
    if place is None or (place is _SERIAL and sys.platform == "win32"):
        return None
    module, name = place.split(":")
    make = getattr(import_module(f"mavstack.router.endpoints.{module}"), name)
    return cast("Endpoint", make(config, attachments, link))
