"""The server's side: a component's metadata files, and the message that names them.

    metadata = ServedMetadata("etc/extras", {common.CompMetadataType.PARAMETER: ("parameters.json", content)})
    provide_component_metadata(messages, metadata, uptime)
    store.add(path, VirtualFile(lambda query: data))     # for each path and data in metadata.files

Files are compressed with xz, as the guide recommends. The CRC of the message is that of the uncompressed
general file, and the CRCs in it are those of the compressed files, as PX4 computes them.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.services.component_metadata.general import MetadataFile
from mavstack.services.ftp import file_crc32

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from mavstack.services.message_request import MessageServer

#: The name of the uncompressed general file.
GENERAL_NAME: Final = "component_general.json"
_PRESET: Final = 6
_MAX_UPTIME_MS: Final = 0xFFFFFFFF


class ServedMetadata:
    """The metadata files of one component.

    Args:
        folder: The folder in which MAVLink FTP serves them: "etc/extras".
        contents: The name and the uncompressed content of each file, by COMP_METADATA_TYPE.
    """

    def __init__(self, folder: str, contents: Mapping[int, tuple[str, bytes]]) -> None:
        #: The compressed files, by path.
        self.files: dict[str, bytes] = {}
        entries = []
        for kind, (name, content) in contents.items():
            path, data = f"{folder}/{name}.xz", _compressed(content)
            self.files[path] = data
            entries.append(MetadataFile(int(kind), f"mftp://{path}", file_crc32(data)).to_json())
        general = json.dumps({"version": 1, "metadataTypes": entries}).encode()
        path = f"{folder}/{GENERAL_NAME}.xz"
        self.files[path] = _compressed(general)
        #: The URI of the general file, and the CRC of its uncompressed content.
        self.uri, self.crc = f"mftp://{path}", file_crc32(general)


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
