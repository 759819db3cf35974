"""The place of a camera definition file, from `CameraInformation.definition_uri`.

MAVLink FTP: `mftp://[;comp=ID]/path` names a file of the camera's component, or of another component of its
system; `mftp:///path` and `mftp://path` are in use too. Other schemes are for ground stations with a web
client.
"""

from __future__ import annotations

import re
from typing import NamedTuple
from urllib.parse import unquote

_SCHEME = re.compile(r"(?:mftp|mavlinkftp)://", re.IGNORECASE)
_COMPONENT = re.compile(r"\[;comp=(\d{1,3})\]")
MAX_COMPONENT = 255


class FtpPlace(NamedTuple):
    """A file on a component of the camera's system; `component` None: on the camera's own."""

    path: str
    component: int | None


def ftp_place(uri: str) -> FtpPlace | None:
    """Return the file that a URI names; None if it is no URI of MAVLink FTP."""
    match = _SCHEME.match(uri)
    if match is None:
        return None
    rest = unquote(uri[match.end() :])
    component = None
    if found := _COMPONENT.match(rest):
        component, rest = int(found[1]), rest[found.end() :]
        if not 0 < component <= MAX_COMPONENT:
            return None
    path = rest if rest.startswith(("/", "@")) else f"/{rest}"
    return FtpPlace(path, component) if len(path) > 1 else None
