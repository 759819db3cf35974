"""The general file of a component: its other metadata files by type (general.schema.json)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

from mavstack.errors import MetadataError
from mavstack.services.component_metadata.json_document import parse_json

#: The largest number of files that a general file may name; MAVLink defines six types.
MAX_TYPES: Final = 64
_MAX_CRC: Final = 0xFFFFFFFF


@dataclass(frozen=True, slots=True)
class MetadataFile:
    """A file that a general file names.

    Attributes:
        type: What it describes, a COMP_METADATA_TYPE.
        uri: Where it is.
        crc: Its CRC-32; None if its content may change.
        fallback_uri: Where it is if the first place has none; empty if nowhere.
        fallback_crc: The CRC-32 of the file there, or None.
    """

    type: int
    uri: str
    crc: int | None = None
    fallback_uri: str = ""
    fallback_crc: int | None = None

    @property
    def sources(self) -> tuple[tuple[str, int | None], ...]:
        """The places of the file with the CRC of each, in the order in which they are tried."""
        places = ((self.uri, self.crc), (self.fallback_uri, self.fallback_crc))
        return tuple(place for place in places if place[0])

    def to_json(self) -> dict[str, object]:
        """Return the entry of a general file."""
        entry: dict[str, object] = {"type": self.type, "uri": self.uri}
        optional = {
            "fileCrc": self.crc,
            "uriFallback": self.fallback_uri or None,
            "fileCrcFallback": self.fallback_crc,
        }
        return entry | {key: value for key, value in optional.items() if value is not None}


def parse_general(content: bytes) -> dict[int, MetadataFile]:
    """Return the files that a general file names, by COMP_METADATA_TYPE.

    Args:
        content: The uncompressed file.

    Returns:
        The files; entries without a type or a URI are left out.

    Raises:
        MetadataError: The content is not a general file.
    """
    entries = parse_json(content).get("metadataTypes")
    if not isinstance(entries, list):
        raise MetadataError("the general metadata has no array 'metadataTypes'")
    found = [_file(entry) for entry in entries[:MAX_TYPES] if isinstance(entry, dict)]
    return {file.type: file for file in found if file is not None}


def _file(entry: dict[str, Any]) -> MetadataFile | None:
    kind, uri, fallback = entry.get("type"), entry.get("uri"), entry.get("uriFallback")
    if type(kind) is not int or not isinstance(uri, str) or not uri:
        return None
    return MetadataFile(
        kind,
        uri,
        _crc(entry.get("fileCrc")),
        fallback if isinstance(fallback, str) else "",
        _crc(entry.get("fileCrcFallback")),
    )


def _crc(value: object) -> int | None:
    return value if type(value) is int and 0 <= value <= _MAX_CRC else None
