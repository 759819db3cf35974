"""The server's side: a component's metadata files, and the message that names them.

    metadata = ServedMetadata("etc/extras", {common.CompMetadataType.PARAMETER: ("parameters.json", content)})
    provide_component_metadata(messages, metadata, uptime)
    store.add(path, VirtualFile(lambda query: data))     # for each path and data in metadata.files

Files are compressed with xz, as the guide recommends. The CRC of the message is that of the uncompressed
general file, and the CRCs in it are those of the compressed files, as PX4 computes them.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, TypeAlias

from mavstack.dialects import common
from mavstack.services.component_metadata.general import MetadataFile
from mavstack.services.component_metadata.translation import to_ts
from mavstack.services.ftp import file_crc32

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.services.message_request import MessageServer

#: The name of the uncompressed general file.
GENERAL_NAME: Final = "component_general.json"
#: Texts by locale, then by their places in a file.
Translations: TypeAlias = Mapping[str, Mapping[str, str]]
_PRESET: Final = 6
_MAX_UPTIME_MS: Final = 0xFFFFFFFF


class ServedMetadata:
    """The metadata files of one component.

    Args:
        folder: The folder in which MAVLink FTP serves them: "etc/extras".
        contents: The name and the uncompressed content of each file, by COMP_METADATA_TYPE.
        translations: The translated texts of a file by type, then by locale, then by their places in it.
    """

    def __init__(
        self,
        folder: str,
        contents: Mapping[int, tuple[str, bytes]],
        translations: Mapping[int, Translations] = MappingProxyType({}),
    ) -> None:
        #: The compressed files, by path.
        self.files: dict[str, bytes] = {}
        entries = []
        for kind, (name, content) in contents.items():
            path, data = f"{folder}/{name}.xz", _compressed(content)
            self.files[path] = data
            summary = self._add_translations(folder, name, translations.get(kind, {}))
            file = MetadataFile(int(kind), f"mftp://{path}", file_crc32(data), translation_uri=summary)
            entries.append(file.to_json())
        general = json.dumps({"version": 1, "metadataTypes": entries}).encode()
        path = f"{folder}/{GENERAL_NAME}.xz"
        self.files[path] = _compressed(general)
        #: The URI of the general file, and the CRC of its uncompressed content.
        self.uri, self.crc = f"mftp://{path}", file_crc32(general)

    def _add_translations(self, folder: str, name: str, translations: Translations) -> str:
        """Add the files of the translations of a file; return the URI of their summary, empty for none."""
        if not translations:
            return ""
        summary = {}
        for locale, texts in translations.items():
            path = f"{folder}/{translation_name(name, locale)}.xz"
            self.files[path] = _compressed(to_ts(texts, locale))
            summary[locale] = {"url": f"mftp://{path}"}
        path = f"{folder}/{summary_name(name)}.xz"
        self.files[path] = _compressed(json.dumps(summary).encode())
        return f"mftp://{path}"


def summary_name(name: str) -> str:
    """Return the name of the summary of the translations of a file, such as "parameters.json"."""
    return f"{name.partition('.')[0]}_summary.json"


def translation_name(name: str, locale: str) -> str:
    """Return the name of the translation of a file to a locale."""
    return f"{name.partition('.')[0]}_{locale}.ts"


def provide_component_metadata(
    messages: MessageServer, metadata: Callable[[], ServedMetadata], uptime: Callable[[], float]
) -> None:
    """Answer requests for COMPONENT_METADATA.

    Args:
        messages: The message server of the component.
        metadata: Returns the files; called with each request.
        uptime: Returns the seconds since boot.
    """

    def produce(_: float) -> common.ComponentMetadata:
        files = metadata()
        milliseconds = min(max(round(uptime() * 1000), 0), _MAX_UPTIME_MS)
        return common.ComponentMetadata(time_boot_ms=milliseconds, file_crc=files.crc, uri=files.uri)

    messages.provide(common.ComponentMetadata, produce)


def _compressed(content: bytes) -> bytes:
    # imported here, because the import takes some milliseconds and not all vehicles have such files
    import lzma

    return lzma.compress(content, preset=_PRESET)
