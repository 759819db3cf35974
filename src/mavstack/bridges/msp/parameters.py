"""The settings of a flight controller as parameters: joins `SettingsServer` and the controller's settings.

Programs disagree on how a generic autopilot encodes integers: MAVProxy expects casts, MAVSDK the bytes of the
integer. A float is the same in both, so settings of up to 16 bits are REAL32.
"""

from __future__ import annotations

import asyncio
import logging
from typing import TYPE_CHECKING

from mavstack.bridges.msp.settings_server import SettingsRequested, SettingsServer, SettingWritten
from mavstack.dialects import common
from mavstack.errors import (
    InvalidArgumentError,
    InvalidStateError,
    LinkError,
    MspError,
    MspSettingError,
    RemoteCancelled,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from mavstack.bridges.msp.controller_facts import ControllerFacts
    from mavstack.bridges.msp.flight_controller import FlightController
    from mavstack.msp.settings import SettingDefinition
    from mavstack.node import Node
    from mavstack.services.parameters import Value

#: Read-only parameters that show whether the board has an OSD and a VTX.
HAS_OSD, HAS_VTX = "MSP_HAS_OSD", "MSP_HAS_VTX"
#: Maximum length of a parameter name in characters.
_MAX_NAME = 16
_LONG_TYPES = (common.MavParamType.UINT32, common.MavParamType.INT32)
_FAILURES = (MspError, LinkError, RemoteCancelled, InvalidStateError)

logger = logging.getLogger("mavstack.bridges.msp")


class BridgedParameters:
    """The parameters of one bridge.

    Args:
        controller: The flight controller.
        node: The node of the bridge.
        report: Sends a status text with a MAV_SEVERITY.
    """

    def __init__(self, controller: FlightController, node: Node, report: Callable[[str, int], None]) -> None:
        self._controller, self._node, self._report = controller, node, report
        self.server = node.serve(SettingsServer(node.address))
        #: The setting for each parameter name, aliases included.
        self._names: dict[str, str] = {}

    async def load(self, facts: ControllerFacts) -> None:
        """Read all settings for the first time, or again after a restart; then requests are answered."""
        values = await self._controller.settings.all()
        for name, present in ((HAS_OSD, facts.has_osd), (HAS_VTX, facts.has_vtx)):
            if name not in self.server.table:
                self.server.add(name, int(present), common.MavParamType.REAL32, read_only=True)
        for definition in self._controller.settings.definitions():
            if definition.name in values:
                for name in parameter_names(definition):
                    self._names[name] = definition.name
                    self._put(name, definition, values[definition.name])
        self.server.finish_loading()
        self._node.wake(self.server)

    def _put(self, name: str, definition: SettingDefinition, value: Value) -> None:
        """Add a setting under one of its names, or set it."""
        if name in self.server.table:
            self.server.set(name, value)
        else:
            self.server.add(
                name,
                value,
                parameter_type(definition.type),
                minimum=definition.minimum,
                maximum=definition.maximum,
            )

    async def run(self) -> None:
        """Answer requests of clients, for ever."""
        async with (
            self._node.events(SettingsRequested, SettingWritten, of=self.server) as events,
            asyncio.TaskGroup() as tasks,
        ):
            async for event in events:
                match event:
                    case SettingsRequested():
                        tasks.create_task(self._refresh(event))
                    case SettingWritten():
                        tasks.create_task(self._write(event))

    async def _refresh(self, event: SettingsRequested) -> None:
        """Read settings again, then answer; if that fails, the last known values are sent."""
        try:
            values = await self._read(event.names)
        except _FAILURES as error:
            logger.warning("%s", error)
            values = {}
        self._update(values)
        self.server.answer(event.packet, self._node.now())
        self._node.wake(self.server)

    async def _read(self, names: tuple[str, ...]) -> Mapping[str, Value]:
        settings = self._controller.settings
        if not names:
            return await settings.all()
        wanted = [self._names[name] for name in names if name in self._names]
        return {name: await settings.get(name) for name in wanted}

    def _update(self, values: Mapping[str, Value]) -> None:
        for name, setting in self._names.items():
            if setting in values:
                self.server.table[name].value = values[setting]

    async def _write(self, event: SettingWritten) -> None:
        setting = self._names.get(event.name, event.name)
        try:
            value = await self._controller.settings.set(setting, event.value)
        except _FAILURES as error:
            self._refuse(event, error, common.MavParamError.PERMISSION_DENIED)
        except InvalidArgumentError as error:
            self._refuse(event, error, common.MavParamError.VALUE_OUT_OF_RANGE)
        else:
            self.server.written(event, value)
            self._update({setting: value})
        self._node.wake(self.server)

    def _refuse(self, event: SettingWritten, error: Exception, result: common.MavParamError) -> None:
        if isinstance(error, MspSettingError):
            result = common.MavParamError.VALUE_OUT_OF_RANGE
        self._report(f"{event.name}: {error}", common.MavSeverity.WARNING)
        self.server.refuse(event, result)


def parameter_names(definition: SettingDefinition) -> list[str]:
    """Return the names of a setting that are names of parameters too: some aliases are longer."""
    return [name for name in (definition.name, *definition.aliases) if len(name) <= _MAX_NAME]


def parameter_type(setting: int) -> int:
    """Return the type of a parameter; a setting of 32 bits keeps its own, since a float has 24 of them."""
    return setting if setting in _LONG_TYPES else common.MavParamType.REAL32
