"""Addresses of cameras that the station opens: `rtsp://`, `rtsps://`, and `rtp://` or `udp://` for RTP.

A client or a camera chooses the address. It must neither name files of the machine nor add options of the
library that opens it, so it is taken apart and written again.
"""

from __future__ import annotations

import re
from typing import Final, NamedTuple
from urllib.parse import urlsplit

from mavstack.errors import InvalidArgumentError
from mavstack.links.url import redact_options

MAX_LENGTH: Final = 512
_RTSP: Final = frozenset({"rtsp", "rtsps"})
_RTP: Final = frozenset({"rtp", "udp"})
_HOST: Final = re.compile(r"[A-Za-z0-9._-]{1,253}|\[[0-9A-Fa-f:.]{2,45}\]")
_REST: Final = re.compile(r"[A-Za-z0-9._~%!$&'()*+,;=:@/?-]*")
#: The most common RTP payload type of H.264 and H.265.
_PAYLOAD_TYPE: Final = 96


class CameraAddress(NamedTuple):
    """An address that may be opened.

    Attributes:
        url: The address of an RTSP stream; empty for RTP.
        description: The session description of an RTP stream; empty for RTSP.
    """

    url: str = ""
    description: str = ""


def read_address(text: str, *, is_h265: bool = False) -> CameraAddress:
    """Read the address of a camera.

    Args:
        text: The address; a number is the port to which RTP is sent.
        is_h265: True if an RTP stream is H.265, which its packets do not say.

    Returns:
        The address as it is opened.

    Raises:
        InvalidArgumentError: The address has another scheme, or is malformed.
    """
    text = text.strip()
    if text.isascii() and text.isdigit():
        text = f"rtp://0.0.0.0:{text}"
    try:
        parts = urlsplit(text)
        port = parts.port
    except ValueError:
        raise _refused(text, "it is malformed") from None
    if len(text) > MAX_LENGTH or not _REST.fullmatch(
        text.partition("://")[2].replace("[", "").replace("]", "")
    ):
        raise _refused(text, "it is malformed")
    host = (
        parts.netloc.rpartition("@")[2].partition(":")[0]
        if "[" not in parts.netloc
        else f"[{parts.hostname}]"
    )
    if not _HOST.fullmatch(host):
        raise _refused(text, "it has no host")
    if parts.scheme in _RTSP:
        return CameraAddress(url=text)
    if parts.scheme in _RTP and port:
        return CameraAddress(description=_description(host, port, is_h265=is_h265))
    raise _refused(text, "the station plays rtsp://, rtsps://, and rtp:// or udp:// with a port")


def _description(host: str, port: int, *, is_h265: bool) -> str:
    kind = "IP6" if host.startswith("[") else "IP4"
    address = host.strip("[]")
    lines = (
        "v=0",
        f"o=- 0 0 IN {kind} {address}",
        "s=video",
        f"c=IN {kind} {address}",
        "t=0 0",
        f"m=video {port} RTP/AVP {_PAYLOAD_TYPE}",
        f"a=rtpmap:{_PAYLOAD_TYPE} {'H265' if is_h265 else 'H264'}/90000",
    )
    return "".join(f"{line}\r\n" for line in lines)


def _refused(text: str, reason: str) -> InvalidArgumentError:
    return InvalidArgumentError(f"playing {redacted(text)[:80]!r} failed: {reason}")


def redacted(text: str) -> str:
    """Return an address without user, password and secret options; the page has the same rule."""
    # up to the last @, since a password may contain one
    return redact_options(re.sub(r"//.*@", "//***@", text.strip()))
