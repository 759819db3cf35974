"""Terms of tile servers: which of them forbid downloads of areas, and what the others ask for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True, slots=True)
class ServerTerms:
    """The terms of a tile server.

    Attributes:
        text: The terms in a sentence.
        allowed: False if the owner forbids the download of areas.
        attribution: The credit that has to be shown; empty: it is not known.
    """

    text: str
    allowed: bool = True
    attribution: str = ""


#: Terms by the end of the host name; by host name and beginning of the path where a host serves several
#: owners.
_TERMS: Final[tuple[tuple[str, ServerTerms], ...]] = (
    (
        "openstreetmap.org",
        ServerTerms(
            "the tile servers of OpenStreetMap forbid the download of areas "
            "(https://operations.osmfoundation.org/policies/tiles/); use a server whose owner permits it, "
            "or your own",
            allowed=False,
            attribution="© OpenStreetMap contributors",
        ),
    ),
    (
        "google.com",
        ServerTerms("Google forbids to keep tiles; use a server whose owner permits it", allowed=False),
    ),
    (
        "googleapis.com",
        ServerTerms("Google forbids to keep tiles; use a server whose owner permits it", allowed=False),
    ),
    (
        "virtualearth.net",
        ServerTerms("Bing Maps forbids to keep tiles; use a server whose owner permits it", allowed=False),
    ),
    (
        "arcgisonline.com",
        ServerTerms(
            "Esri permits to keep tiles only with an account whose licence has it", attribution="Esri"
        ),
    ),
    (
        "s3.amazonaws.com/elevation-tiles-prod",
        ServerTerms(
            "Terrain Tiles on AWS are open data, and ask for the credit of their sources "
            "(https://github.com/tilezen/joerd/blob/master/docs/attribution.md)",
            attribution="Terrain Tiles: Mapzen, SRTM, GMTED2010, ETOPO1 and others",
        ),
    ),
)
_UNKNOWN: Final = ServerTerms(
    "the owner of the server decides whether areas may be downloaded, and how fast: read the terms first"
)
_OWN: Final = ServerTerms("the server is on this machine")
_LOCAL: Final = frozenset({"localhost", "127.0.0.1", "::1"})


def terms_of(host: str, path: str = "") -> ServerTerms:
    """Return the terms of a tile server.

    Args:
        host: The host of its address.
        path: The path of its address.
    """
    name = host.lower().rstrip(".")
    if name in _LOCAL:
        return _OWN
    for place, terms in _TERMS:
        domain, _, start = place.partition("/")
        if (name == domain or name.endswith(f".{domain}")) and path.lstrip("/").startswith(start):
            return terms
    return _UNKNOWN
