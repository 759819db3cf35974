"""A tile server: the address of a tile, and the request for it."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass
from http import HTTPStatus
from http.client import HTTPException
from typing import TYPE_CHECKING, Final
from urllib.error import HTTPError, URLError
from urllib.parse import urlsplit
from urllib.request import Request, urlopen

from mavstack.errors import InvalidArgumentError
from mavstack.maps.failures import MapError
from mavstack.maps.terms import ServerTerms, terms_of
from mavstack.maps.tiles import MAX_TILE

if TYPE_CHECKING:
    from mavstack.maps.tiles import Tile

#: Timeout of one request in seconds.
REQUEST_TIMEOUT: Final = 30.0
#: Operators of tile servers require that programs identify themselves.
USER_AGENT: Final = "Mavstack offline maps"
_PARTS: Final = ("{z}", "{x}", "{y}")
_ABSENT: Final = frozenset({HTTPStatus.NO_CONTENT, HTTPStatus.NOT_FOUND, HTTPStatus.GONE})
_BUSY: Final = frozenset(
    {
        HTTPStatus.REQUEST_TIMEOUT,
        HTTPStatus.TOO_MANY_REQUESTS,
        HTTPStatus.INTERNAL_SERVER_ERROR,
        HTTPStatus.BAD_GATEWAY,
        HTTPStatus.SERVICE_UNAVAILABLE,
        HTTPStatus.GATEWAY_TIMEOUT,
    }
)
_MAGIC: Final = (
    (b"\x89PNG\r\n\x1a\n", "png"),
    (b"\xff\xd8\xff", "jpg"),
    (b"RIFF", "webp"),
    (b"\x1f\x8b", "pbf"),
)
_VECTOR_TYPES: Final = ("mapbox-vector-tile", "protobuf", "mvt")


@dataclass(frozen=True, slots=True)
class TileAnswer:
    """The answer to a request.

    Attributes:
        data: The tile; empty: the server has none at this place, or is busy.
        format: The format of the tile: `png`, `jpg`, `webp` or `pbf`; empty without a tile.
        retry_after: Seconds after which the request may be repeated; None: it succeeded.
        reason: The reason of a request that did not succeed.
    """

    data: bytes = b""
    format: str = ""
    retry_after: float | None = None
    reason: str = ""


class TileServer:
    """A tile server.

    Args:
        template: Its address, such as `https://tiles.example.org/{z}/{x}/{y}.png`.

    Raises:
        InvalidArgumentError: The address is not one of HTTP, or lacks a part.
    """

    def __init__(self, template: str) -> None:
        self.template = template.strip()
        try:
            parsed = urlsplit(self.template)
            host, _ = parsed.hostname, parsed.port
            (host or "").encode("idna")  # names with empty or long labels cannot be looked up
        except ValueError as error:
            raise InvalidArgumentError(f"the address of the tiles is not a URL: {error}") from None
        if parsed.scheme.lower() not in ("http", "https") or not host:
            raise InvalidArgumentError(
                "the address of the tiles must begin with http:// or https:// and a host"
            )
        if "@" in parsed.netloc:
            raise InvalidArgumentError(
                "the address of the tiles must not have a user name or a password; a key belongs in its "
                "path or query"
            )
        missing = [part for part in _PARTS if part not in self.template]
        if missing:
            raise InvalidArgumentError(f"the address of the tiles has no {', '.join(missing)}")
        if any(each <= " " or each > "~" for each in self.template):
            raise InvalidArgumentError(
                "the address of the tiles has spaces or other characters that URLs escape"
            )
        #: The host name; logs and errors show only this part, because paths and queries may contain keys.
        self.host = host
        #: The terms of use of the server.
        self.terms: ServerTerms = terms_of(host, parsed.path)

    def url(self, tile: Tile) -> str:
        """Return the address of a tile."""
        url = self.template
        for part, value in zip(_PARTS, tile, strict=True):
            url = url.replace(part, str(value))
        return url

    async def fetch(self, tile: Tile) -> TileAnswer:
        """Request a tile.

        Returns:
            The tile, or that the server has none, or after how many seconds the request may be repeated.

        Raises:
            MapError: The server refuses the request, or what it sent is not a tile.
        """
        return await asyncio.to_thread(self._request, self.url(tile))

    def _request(self, url: str) -> TileAnswer:
        """Request an address; blocks until the answer is there."""
        request = Request(url, headers={"User-Agent": USER_AGENT})  # noqa: S310 (HTTP alone)
        try:
            with urlopen(request, timeout=REQUEST_TIMEOUT) as response:  # noqa: S310
                data = response.read(MAX_TILE + 1)
                kind = response.headers.get_content_type()
        except HTTPError as error:
            with error:
                return self._failed(error)
        except (URLError, HTTPException, OSError, ValueError) as error:  # ValueError: a redirect to no URL
            reason = getattr(error, "reason", None) or error
            return TileAnswer(retry_after=0.0, reason=str(reason) or type(error).__name__)
        if not data:
            return TileAnswer()
        return TileAnswer(data, self._format(data, kind))

    def _failed(self, error: HTTPError) -> TileAnswer:
        if error.code in _ABSENT:
            return TileAnswer()
        reason = f"{error.code} {error.reason}".strip()
        if error.code in _BUSY:
            return TileAnswer(retry_after=_seconds(error.headers.get("Retry-After")), reason=reason)
        hint = (
            "; does the address need a key, or does the owner forbid downloads?"
            if error.code in (401, 403)
            else ""
        )
        raise MapError(f"downloading tiles from {self.host} failed: {reason}{hint}")

    def _format(self, data: bytes, kind: str) -> str:
        if len(data) > MAX_TILE:
            raise MapError(
                f"downloading tiles from {self.host} failed: a tile has more than {MAX_TILE >> 20} MiB"
            )
        for magic, name in _MAGIC:
            if data.startswith(magic):
                return name
        if any(each in kind for each in _VECTOR_TYPES):
            return "pbf"
        raise MapError(
            f"downloading tiles from {self.host} failed: it sent {kind[:60]}, not a picture; is there a page "
            "to log in between?"
        )


def _seconds(text: str | None) -> float:
    """Return the seconds of the header Retry-After; 0 if it has a date or is missing."""
    return float(text) if text is not None and text.isascii() and text.isdigit() else 0.0
