"""URIs of files on components (guide: MAVLink FTP, URL scheme).

- `mftp://path`: a file of the component that sent the URI; `mftp:///path` has an absolute path.
- `mftp://comp=100:path`: a file of another component of the system, as the guide writes it.
- `mftp://[;comp=100]path`: the same, as QGroundControl and MAVSDK write it.

`mavlinkftp://` means `mftp://`. Percent escapes in the path are decoded.
"""

from __future__ import annotations

import re
from typing import Final, NamedTuple
from urllib.parse import unquote

#: The largest number of letters of a URI; the messages hold 100.
MAX_URI_LENGTH: Final = 500
_URI: Final = re.compile(
    r"(?:mftp|mavlinkftp)://(?:\[;comp=(?P<old>\d{1,3})\]|comp=(?P<new>\d{1,3}):)?(?P<path>.+)", re.IGNORECASE
)
_MAX_COMPONENT: Final = 255


class FtpLocation(NamedTuple):
    """A file that MAVLink FTP serves; `component` is None for the component that sent the URI."""

    path: str
    component: int | None = None


def parse_ftp_uri(uri: str) -> FtpLocation | None:
    """Return the file that a URI names; None if it is no URI of MAVLink FTP, or malformed."""
    if len(uri) > MAX_URI_LENGTH or not uri.isprintable():
        return None
    found = _URI.fullmatch(uri)
    if found is None or found["path"] == "/":
        return None
    number = found["old"] or found["new"]
    component = None if number is None else int(number)
    if component is not None and not 0 < component <= _MAX_COMPONENT:
        return None
    return FtpLocation(unquote(found["path"]), component)
