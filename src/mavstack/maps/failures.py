"""The errors of maps, a part of the tree of `mavstack.errors`."""

from __future__ import annotations

from mavstack.errors import MavstackError


class MapError(MavstackError):
    """A map cannot be downloaded, read or written; the text names the server or the file, and the remedy."""
