"""The notice that other hosts can reach a port that a command has opened."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.cli.common.output import echo
from mavstack.links.address import is_loopback
from mavstack.links.scheme_table import find_scheme

if TYPE_CHECKING:
    from collections.abc import Iterable
    from typing import Protocol

    from mavstack.links.url import LinkURL

    class HasURL(Protocol):
        """A link, or an endpoint of the router."""

        @property
        def url(self) -> LinkURL:
            """The URL that was opened."""


#: Number of links up to which each is named; of more links only the first and the last are named.
_MAX_SHOWN: Final = 3


def announce_exposure(command: str, links: Iterable[HasURL]) -> None:
    """Say on stderr, in one line, which links accept data from other hosts."""
    urls = [link.url for link in links]
    exposed = [url.redacted for url in urls if _is_exposed(url)]
    if not exposed:
        return
    shown = ", ".join(exposed) if len(exposed) <= _MAX_SHOWN else f"{exposed[0]} … {exposed[-1]}"
    remedy = "127.0.0.1 in the URL limits it to this machine"
    echo(f"mav {command}: {shown} can be reached from the network; {remedy}", error=True)


def _is_exposed(url: LinkURL) -> bool:
    scheme = find_scheme(url.scheme)
    return scheme is not None and scheme.is_network and scheme.listens and not _is_local(url.host)


def _is_local(host: str) -> bool:
    return host == "localhost" or is_loopback(host)
