"""URLs of sources of rows: a link that carries lines, a template, and a name.

    csv+tcp://127.0.0.1:5770?name=cansat&template=time:s,lat:deg,lon:deg,alt:m
    csv+serial:///dev/ttyUSB0?baud=115200&template=$GPS,lat,lon|$IMU,roll,pitch

`csv+tcpin` and `csv+udp` listen. Other options are those of the link.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.errors import LinkURLError
from mavstack.links import LinkURL, parse_url
from mavstack.links.url import redact_options
from mavstack.server.rows.template import parse_templates

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.server.rows.template import RowTemplate

#: The schemes, and the link that carries each.
SCHEMES: Final[Mapping[str, str]] = MappingProxyType(
    {"csv+tcp": "tcpout", "csv+tcpin": "tcpin", "csv+udp": "udpin", "csv+serial": "serial"}
)
_NAME: Final = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,31}")


@dataclass(frozen=True, slots=True)
class RowUrl:
    """A parsed URL.

    Attributes:
        text: The URL without secrets.
        link: The URL of the link that carries the lines.
        name: The name of the source; empty: none was given.
        templates: The templates of its lines.
    """

    text: str
    link: LinkURL
    name: str
    templates: tuple[RowTemplate, ...]


def is_row_url(text: str) -> bool:
    """Return whether a text is the URL of a source of rows."""
    return text.partition("://")[0].strip().lower() in SCHEMES


def parse_row_url(text: str) -> RowUrl:
    """Parse the URL of a source of rows; raises `LinkURLError` or `InvalidArgumentError` (template)."""
    scheme, _, rest = text.strip().partition("://")
    url = parse_url(f"{SCHEMES[scheme.lower()]}://{rest}")
    options = dict(url.options)
    template, name = options.pop("template", ""), options.pop("name", "")
    shown = redact_options(text.strip())
    if not template:
        example = f"{shown}{'&' if '?' in shown else '?'}template=time:s,lat:deg,lon:deg"
        raise LinkURLError(f"{shown} has no template, which names the columns: {example}")
    if name and not _NAME.fullmatch(name):
        raise LinkURLError(f"the name of a source has letters, digits, _ and -, got {name[:40]!r}")
    return RowUrl(shown, replace(url, options=options), name, parse_templates(template))
