"""Requests that a page in a browser could send to a server on this machine.

A browser sends requests to any address for any page. A server on loopback without a password therefore checks
two headers: `Host` must be a name of this machine, since a page could give its own name the address of
loopback (DNS rebinding), and `Origin` must be that of the server's own pages.
"""

from __future__ import annotations

from functools import lru_cache
from ipaddress import ip_address
from typing import Final
from urllib.parse import urlsplit

_LOCAL_NAMES: Final = frozenset({"localhost", "127.0.0.1", "::1"})


@lru_cache(64)
def host_of(header: str) -> str:
    """Return the host name of a `Host` header in lower case, without port and brackets; empty if invalid."""
    try:
        return urlsplit(f"//{header}").hostname or ""
    except ValueError:
        return ""


def is_local_host(header: str) -> bool:
    """Return whether a `Host` header names this machine by a name that no page can have."""
    return host_of(header) in _LOCAL_NAMES


def is_own_origin(origin: str, host: str) -> bool:
    """Return whether an `Origin` header is that of a page from the server with the `Host` header `host`."""
    scheme, separator, place = origin.partition("://")
    return bool(separator) and scheme in ("http", "https") and place.lower() == host.lower() != ""


def is_loopback(host: str) -> bool:
    """Return whether a server that listens on `host` can be reached from this machine only."""
    if host.lower() == "localhost":
        return True
    try:
        return ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False
