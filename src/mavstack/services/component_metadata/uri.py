"""URIs of metadata files (guide: MAVLink FTP URL scheme), of four kinds.

- `mftp://path`: a file of the component itself; `mftp:///path` has an absolute path.
- `mftp://comp=100:path`: a file of another component of the system, as the guide writes it.
- `mftp://[;comp=100]path`: the same, as QGroundControl and MAVSDK write it.
- `https://host/path`: a file on a web server.
"""

from __future__ import annotations

import re
from typing import Final, NamedTuple

from mavstack.errors import MetadataError

#: The largest number of letters of a URI; the messages hold 100.
MAX_LENGTH: Final = 500
_FTP: Final = re.compile(
    r"mftp://(?:\[;comp=(?P<old>\d{1,3})\]|comp=(?P<new>\d{1,3}):)?(?P<path>.+)", re.IGNORECASE
)
_WEB: Final = re.compile(r"https?://[^/\s]+\S*", re.IGNORECASE)
_MAX_ID: Final = 255


class FtpLocation(NamedTuple):
    """A file that MAVLink FTP serves; `component` is None for the component that named it."""

    path: str
    component: int | None = None


def parse_uri(uri: str) -> FtpLocation | str:
    """Return where a file is.

    Args:
        uri: The URI.

    Returns:
        The location on a component, or the URL of a file on a web server.

    Raises:
        MetadataError: The URI is of another scheme, malformed or too long.
    """
    if len(uri) > MAX_LENGTH or not uri.isprintable():
        raise MetadataError(f"{uri[:60]!r} is not a URI")
    if _WEB.fullmatch(uri):
        return uri
    found = _FTP.fullmatch(uri)
    if found is None:
        raise MetadataError(f"{uri!r} is not a URI of a file: mftp://, http:// or https://")
    number = found["old"] or found["new"]
    component = None if number is None else int(number)
    if component is not None and not 0 < component <= _MAX_ID:
        raise MetadataError(f"{uri!r} names component {component}, which cannot be")
    return FtpLocation(found["path"], component)
