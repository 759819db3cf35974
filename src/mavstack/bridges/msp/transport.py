"""URLs of flight controllers that speak MSP: `msp+serial`, `msp+tcp` and `msp+tcpin`.

Each stands for a link of Mavstack with other defaults: a serial port has 115,200 baud, at which flight
controllers offer MSP. The plain schemes and device paths are accepted too.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from mavstack.errors import LinkURLError
from mavstack.links import LinkURL, parse_url

#: Baud rate of MSP on a serial port; USB ports ignore it.
DEFAULT_BAUD: Final = 115200
#: The schemes, and the link that carries each.
SCHEMES: Final = {"msp+serial": "serial", "msp+tcp": "tcpout", "msp+tcpin": "tcpin"}
EXAMPLE: Final = "msp+serial:///dev/ttyACM0 or msp+tcp://127.0.0.1:5761"


def transport_url(text: str | LinkURL, baud: int | None = None) -> LinkURL:
    """Return the URL of the link that carries MSP.

    Args:
        text: A URL of MSP, a URL of a serial port or a TCP connection, or the path of a serial device.
        baud: Baud rate of a serial port; None: that of the URL, or 115,200.

    Returns:
        The URL of the link.

    Raises:
        LinkURLError: The URL is malformed, or its scheme carries no MSP.
    """
    words = str(text).strip()
    scheme, separator, rest = words.partition("://")
    if separator and scheme.lower() in SCHEMES:
        words = f"{SCHEMES[scheme.lower()]}://{rest}"
    url = parse_url(words)
    if url.scheme == "file":  # a device name, such as a symbolic link to a port
        url = replace(url, scheme="serial")
    if url.scheme not in SCHEMES.values() and url.scheme not in ("unix", "memory"):
        raise LinkURLError(
            f"{url.redacted} carries no MSP: use a serial port or a TCP connection, such as {EXAMPLE}"
        )
    if url.scheme == "serial":
        known = {"baud": str(DEFAULT_BAUD)} | dict(url.options)
        url = replace(url, options=known if baud is None else known | {"baud": str(baud)})
    return url


def msp_name(url: LinkURL) -> str:
    """Return the URL of a link as MSP's, without secrets, for error texts."""
    schemes = {carrier: scheme for scheme, carrier in SCHEMES.items()}
    return replace(url, scheme=schemes.get(url.scheme, url.scheme), options={}).redacted
