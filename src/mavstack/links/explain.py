"""What an error of the operating system means for a link, and what the user can do about it."""

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
        "close it, or choose another port",
        errno.EADDRNOTAVAIL: "{host} is not an address of this machine: listen on 0.0.0.0, "
        "or use udpout:// or tcpout:// to reach another machine",
        errno.ECONNREFUSED: "nobody listens there: start the other side first, or keep trying with ?wait=yes",
        errno.ECONNRESET: "the other side hung up",
        errno.EHOSTUNREACH: "the host cannot be reached: is it on, and on this network?",
        errno.ENETUNREACH: "the network cannot be reached: is it connected?",
        errno.ETIMEDOUT: "no answer: is the host on, and no firewall between?",
        errno.EACCES: "permission denied",
        errno.EPERM: "permission denied",
        errno.ENOENT: "there is no such file or device: {path}",
        errno.ENODEV: "there is no such device: {path}",
        errno.ENXIO: "the device is not connected: {path}",
        errno.EBUSY: "{path} is in use by another program: close that first",
        errno.EISDIR: "{path} is a directory",
    }
)


def explain(url: LinkURL, error: OSError) -> LinkError:
    """The `LinkError` that tells what happened, where, and what to do."""
    return LinkError(f"cannot open {url}: {_hint(url, error)}")


def _hint(url: LinkURL, error: OSError) -> str:
    if isinstance(error, socket.gaierror):
        return f"the host name {url.host!r} cannot be resolved: check the spelling and the network"
    if isinstance(error, ssl.SSLCertVerificationError):
        return f"its certificate is not trusted ({error.verify_message}): name the authority by ?ca=file.pem"
    if isinstance(error, ssl.SSLError):
        return f"TLS failed ({error.reason or error}): does the other side speak TLS?"
    if isinstance(error, TimeoutError):
        return _HINTS[errno.ETIMEDOUT]
    if error.errno == errno.EACCES and 0 < url.port < 1024:
        return f"port {url.port} needs administrator rights: choose one over 1023"
    hint = _HINTS.get(error.errno or 0)
    if hint is None:
        return error.strerror or str(error)
    return hint.format(host=url.host, port=url.port, path=url.path)
