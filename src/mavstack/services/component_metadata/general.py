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
        translation_uri: Where the summary of its translations is; empty if nowhere.
        translation_fallback_uri: Where the summary is if the first place has none; empty if nowhere.
    """

    type: int
    uri: str
    crc: int | None = None
    fallback_uri: str = ""
    fallback_crc: int | None = None
    translation_uri: str = ""
    translation_fallback_uri: str = ""

    @property
    def sources(self) -> tuple[tuple[str, int | None], ...]:
        """The places of the file with the CRC of each, in the order in which they are tried."""
        places = ((self.uri, self.crc), (self.fallback_uri, self.fallback_crc))
        return tuple(place for place in places if place[0])

    @property
    def translation_sources(self) -> tuple[str, ...]:
        """The places of the summary of its translations, in the order in which they are tried."""
        return tuple(filter(None, (self.translation_uri, self.translation_fallback_uri)))

    def to_json(self) -> dict[str, object]:
        """Return the entry of a general file."""
        entry: dict[str, object] = {"type": self.type, "uri": self.uri}
        optional = {
            "fileCrc": self.crc,
            "uriFallback": self.fallback_uri or None,
            "fileCrcFallback": self.fallback_crc,
            "translationUri": self.translation_uri or None,
            "translationUriFallback": self.translation_fallback_uri or None,
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
    kind, uri = entry.get("type"), _uri(entry.get("uri"))
    if type(kind) is not int or not uri:
        return None
    return MetadataFile(
        kind,
        uri,
        _crc(entry.get("fileCrc")),
        _uri(entry.get("uriFallback")),
        _crc(entry.get("fileCrcFallback")),
        _uri(entry.get("translationUri")),
        _uri(entry.get("translationUriFallback")),
    )


def _uri(value: object) -> str:
    return value if isinstance(value, str) else ""


def _crc(value: object) -> int | None:
    return value if type(value) is int and 0 <= value <= _MAX_CRC else None
