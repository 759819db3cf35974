"""URIs of metadata files: `mftp://` for files on a component, `http://` and `https://` for web servers."""

from __future__ import annotations

import re
from typing import Final

from mavstack.errors import MetadataError
from mavstack.services.ftp.uri import MAX_URI_LENGTH, FtpLocation, parse_ftp_uri

_WEB: Final = re.compile(r"https?://[^/\s]+\S*", re.IGNORECASE)


def parse_uri(uri: str) -> FtpLocation | str:
    """Return where a file is.

    Args:
        uri: The URI.

    Returns:
        The location on a component, or the URL of a file on a web server.

    Raises:
        MetadataError: The URI is of another scheme, malformed or too long.
    """
    if len(uri) > MAX_URI_LENGTH or not uri.isprintable():
        raise MetadataError(f"{uri[:60]!r} is not a URI")
    if _WEB.fullmatch(uri):
        return uri
    location = parse_ftp_uri(uri)
    if location is None:
        raise MetadataError(f"{uri!r} is not a URI of a file: mftp://, http:// or https://")
    return location
