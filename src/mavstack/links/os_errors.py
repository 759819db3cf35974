"""Translation of operating system errors to `LinkError`, with a hint for the user."""

from __future__ import annotations

import errno
import socket
import ssl
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.errors import LinkError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.links.url import LinkURL

_HINTS: Final[Mapping[int, str]] = MappingProxyType(
    {
        errno.EADDRINUSE: "port {port} is in use by another program (a ground station, perhaps): "
        "close it, or use another port",
        errno.EADDRNOTAVAIL: "{host} is not an address of this machine: listen on 0.0.0.0, "
        "or use udpout:// or tcpout:// to reach another machine",
        errno.ECONNREFUSED: "connection refused: start the server first, or keep trying with ?wait=yes",
        errno.ECONNRESET: "connection reset by the peer",
        errno.EHOSTUNREACH: "the host is unreachable: check that it is on and connected to this network",
        errno.ENETUNREACH: "the network is unreachable: check the connection of this machine",
        errno.ETIMEDOUT: "no answer: check that the host is on and no firewall blocks the port",
        errno.EACCES: "permission denied",
        errno.EPERM: "permission denied",
        errno.ENOENT: "no such file or device: {path}",
        errno.ENODEV: "no such device: {path}",
        errno.ENXIO: "the device is not connected: {path}",
        errno.EBUSY: "{path} is in use by another program: close that program",
        errno.EISDIR: "{path} is a directory",
    }
)


def open_error(url: LinkURL, error: OSError) -> LinkError:
    """Return the `LinkError` for an error while opening a link."""
    return LinkError(f"cannot open {url.redacted}: {_hint(url, error)}")


def _hint(url: LinkURL, error: OSError) -> str:
    if isinstance(error, socket.gaierror):
        return f"the host name {url.host!r} cannot be resolved: check the spelling and the network"
    if isinstance(error, ssl.SSLCertVerificationError):
        return (
            f"its certificate is not trusted ({error.verify_message}): "
            "pass its certificate authority with ?ca=file.pem"
        )
    if isinstance(error, ssl.SSLError):
        return f"TLS failed ({error.reason or error}): check that the peer uses TLS"
    if isinstance(error, TimeoutError):
        return _HINTS[errno.ETIMEDOUT]
    if error.errno == errno.EACCES and 0 < url.port < 1024:
        return f"port {url.port} needs administrator rights: use a port above 1023"
    hint = _HINTS.get(error.errno or 0)
    if hint is None:
        return error.strerror or str(error)
    return hint.format(host=url.host, port=url.port, path=url.path)
