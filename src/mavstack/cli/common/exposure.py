"""The notice that other hosts can reach a port that a command has opened."""

from __future__ import annotations

from ipaddress import ip_address
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.output import echo

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mavstack.links import Link

_LISTENING: Final = frozenset({"udpin", "tcpin", "tlsin", "wsin", "wssin"})


def announce_exposure(command: str, links: Iterable[Link]) -> None:
    """Say on stderr which links accept data from other hosts."""
    for link in links:
        url = link.url
        if url.scheme in _LISTENING and not _is_loopback(url.host):
            remedy = "127.0.0.1 in the URL limits it to this machine"
            echo(f"mav {command}: {url.redacted} can be reached from the network; {remedy}", error=True)


def _is_loopback(host: str) -> bool:
    if host == "localhost":
        return True
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return False
