"""The metadata of a bridge's parameters: their texts, units and ranges, as a file that MAVLink FTP serves.

The definitions of the settings have the facts already; ground stations find the file by COMPONENT_METADATA.
The files are generated with the first request, and again when the flight controller has another firmware.
"""

from __future__ import annotations

import json
from functools import partial
from math import ceil, log10
from typing import TYPE_CHECKING, Final

from mavstack.bridges.msp.parameters import HAS_OSD, HAS_VTX, parameter_names, parameter_type
from mavstack.dialects import common
from mavstack.files.parameter_metadata.component_json import to_json
from mavstack.services.component_metadata import (
    GENERAL_NAME,
    ServedMetadata,
    provide_component_metadata,
)
from mavstack.services.ftp import FtpServer, MemoryStore
from mavstack.services.parameters import ParameterMetadata

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from mavstack.msp.settings import SettingDefinition
    from mavstack.node import Node

FOLDER: Final = "metadata"
_FILE: Final = "parameters.json"
#: The version of parameter.schema.json.
_VERSION: Final = 1
_EQUIPMENT: Final = (
    ParameterMetadata(name=HAS_OSD, short_description="There is an on-screen display", read_only=True),
    ParameterMetadata(name=HAS_VTX, short_description="There is a video transmitter", read_only=True),
)


class BridgedMetadata:
    """The metadata files of one bridge.

    Args:
        node: The node of the bridge.
        definitions: Returns the settings that the firmware has.
        uptime: Returns the seconds since the flight controller started.
    """

    def __init__(
        self,
        node: Node,
        definitions: Callable[[], Sequence[SettingDefinition]],
        uptime: Callable[[], float],
    ) -> None:
        self._definitions = definitions
        self._described: Sequence[SettingDefinition] | None = None
        self._served: ServedMetadata | None = None
        paths = (f"{FOLDER}/{name}.xz" for name in (GENERAL_NAME, _FILE))
        store = MemoryStore(virtual={path: partial(self._content, path) for path in paths})
        node.serve(FtpServer(node.address, store, read_only=True))
        provide_component_metadata(node.message_server, self.served, uptime)

    def served(self) -> ServedMetadata:
        """Return the files for the firmware of now."""
        definitions = self._definitions()
        if self._served is None or definitions != self._described:
            content = json.dumps({"version": _VERSION, "parameters": list(_entries(definitions))})
            kind = int(common.CompMetadataType.PARAMETER)
            self._served = ServedMetadata(FOLDER, {kind: (_FILE, content.encode())})
            self._described = definitions
        return self._served

    def _content(self, path: str) -> bytes:
        return self.served().files[path]


def _entries(definitions: Sequence[SettingDefinition]) -> Iterator[dict[str, object]]:
    for each in _EQUIPMENT:
        yield to_json(each, "Float")
    for definition in definitions:
        long = parameter_type(definition.type) != common.MavParamType.REAL32
        type_name = common.MavParamType(definition.type).name.capitalize() if long else "Float"
        for name in parameter_names(definition):
            yield to_json(_metadata(name, definition), type_name)


def _metadata(name: str, definition: SettingDefinition) -> ParameterMetadata:
    return ParameterMetadata(
        name=name,
        short_description=definition.description,
        unit=definition.unit,
        minimum=definition.minimum,
        maximum=definition.maximum,
        increment=definition.increment,
        decimal_places=max(0, ceil(-log10(definition.increment))),
        values=dict(definition.values.items()),
        group=name.split("_")[1],
    )
