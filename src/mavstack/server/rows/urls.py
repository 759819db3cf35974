"""URLs of sources of rows: a link that carries lines or frames, their template or decoder, and a name.

    csv+tcp://127.0.0.1:5770?name=cansat&template=time:s,lat:deg,lon:deg,alt:m
    csv+serial:///dev/ttyUSB0?baud=115200&template=$GPS,lat,lon|$IMU,roll,pitch
    frames+udp://0.0.0.0:9000?name=bench&decoder=bench.json
    frames+mqtt://127.0.0.1:1883?topic=bench/values&name=bench

`+tcp`, `+mqtt` and `+mqtts` connect, `+tcpin` and `+udp` listen. Other options are those of the link.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

from mavstack.errors import LinkURLError
from mavstack.links import LinkURL, parse_url
from mavstack.links.url import redact_options
from mavstack.server.rows.frame_decoder import parse_decoder
from mavstack.server.rows.mqtt import SCHEMES as MQTT
from mavstack.server.rows.template import parse_templates

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.server.rows.frame_decoder import FrameDecoder
    from mavstack.server.rows.template import RowTemplate

#: The scheme of the link that carries the rows, by the second part of a row URL's scheme.
_CARRIERS: Final[Mapping[str, str]] = MappingProxyType(
    {"tcp": "tcpout", "tcpin": "tcpin", "udp": "udpin", "serial": "serial", **{name: name for name in MQTT}}
)
#: The schemes of row URLs, each with the scheme of the link that carries the rows.
SCHEMES: Final[Mapping[str, str]] = MappingProxyType(
    {f"{kind}+{name}": link for kind in ("csv", "frames") for name, link in _CARRIERS.items()}
)
_NAME: Final = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,31}")


@dataclass(frozen=True, slots=True)
class RowUrl:
    """A parsed URL.

    Attributes:
        text: The URL without secrets.
        link: The URL of the link that carries the lines or frames.
        name: The name of the source; empty: none was given.
        templates: The templates of its lines; empty: it carries frames.
        decoder: The decoder of its frames; None: their bytes are left to scripts.
        decoder_file: The file with the decoder, which is not read yet; empty: there is none.
    """

    text: str
    link: LinkURL
    name: str
    templates: tuple[RowTemplate, ...] = ()
    decoder: FrameDecoder | None = None
    decoder_file: str = ""


def is_row_url(text: str) -> bool:
    """Return whether a text is the URL of a source of rows."""
    return text.partition("://")[0].strip().lower() in SCHEMES


def parse_row_url(text: str, decoder: Mapping[str, Any] | None = None) -> RowUrl:
    """Parse the URL of a source of rows.

    Args:
        text: The URL.
        decoder: The declaration of the decoder that the URL names; None: the URL names a file, or none.

    Returns:
        The parts of the URL.

    Raises:
        LinkURLError: The URL is malformed.
        InvalidArgumentError: The template or the decoder is malformed.
    """
    scheme, _, rest = text.strip().partition("://")
    carrier = SCHEMES[scheme.lower()]
    if carrier in MQTT:  # in an MQTT topic, + is a wildcard, not a space
        rest = rest.replace("+", "%2B")
    url = parse_url(f"{carrier}://{rest}", MQTT)
    options = dict(url.options)
    name, template = options.pop("name", ""), options.pop("template", "")
    shown = redact_options(text.strip())
    if name and not _NAME.fullmatch(name):
        raise LinkURLError(f"the name of a source has letters, digits, _ and -, got {name[:40]!r}")
    if not scheme.lower().startswith("frames"):
        if decoder is not None:
            raise LinkURLError(f"{shown} has lines, which no decoder reads: frames+… has frames")
        _require_template(shown, template)
        return RowUrl(shown, replace(url, options=options), name, templates=parse_templates(template))
    if template:
        raise LinkURLError(f"{shown} has frames, which no template reads: csv+… has lines")
    file = options.pop("decoder", "")
    parsed = None if decoder is None else parse_decoder(decoder)
    link = replace(url, options=options)
    return RowUrl(shown, link, name, decoder=parsed, decoder_file="" if parsed else file)


def _require_template(shown: str, template: str) -> None:
    if not template:
        example = f"{shown}{'&' if '?' in shown else '?'}template=time:s,lat:deg,lon:deg"
        raise LinkURLError(f"{shown} has no template, which names the columns: {example}")
