"""The settings of a flight controller as parameters: a parameter server whose values are on another device.

A request for a value is answered after the setting was read again, since the pilot changes settings by the
on-screen display too; a set is answered after the setting was written and read back. The program does both:

    SettingsRequested     read these settings, call `set` for each value, then `answer`
    SettingWritten        write the value, then call `written` with the value that was read back, or `refuse`

Until the program has loaded the settings, requests wait. Changes are lost at the next restart of the flight
controller unless they are saved (MAV_CMD_PREFLIGHT_STORAGE).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.services import Address, Event
from mavstack.services.parameters import ParameterServer
from mavstack.services.parameters.value import fitted

if TYPE_CHECKING:
    from mavstack.services.parameters import Value
    from mavstack.services.parameters.table import ParameterDefinition
    from mavstack.wire import Packet

#: Maximum number of waiting requests; further ones are dropped, and their clients ask again.
MAX_WAITING: Final = 256

_Key = tuple[Address, type, str | int]


@dataclass(frozen=True, slots=True)
class SettingsRequested(Event):
    """A client asks for values; `names` is empty for all of them."""

    names: tuple[str, ...]
    packet: Packet


@dataclass(frozen=True, slots=True)
class SettingWritten(Event):
    """A client sets a value, which is of the right type and within its limits."""

    name: str
    value: Value
    source: Address
    packet: Packet | None


class SettingsServer(ParameterServer):
    """The parameter server of a bridge."""

    def __init__(self, local: Address) -> None:
        super().__init__(local)
        self._loaded = False
        self._early: list[tuple[Packet, float]] = []
        self._reading: set[_Key] = set()
        self._writing: dict[str, Value] = {}

    @property
    def loaded(self) -> bool:
        """True once the program has loaded the settings."""
        return self._loaded

    def finish_loading(self) -> None:
        """Answer the requests that came before the settings were loaded, and all later ones."""
        self._loaded = True
        early, self._early = self._early, []
        for packet, now in early:
            super().receive(packet, now)

    def receive(self, packet: Packet, now: float) -> None:  # noqa: D102 (that of `Service`)
        if not self._loaded:
            if len(self._early) < MAX_WAITING:
                self._early.append((packet, now))
            return
        names = self._requested(packet)
        if names is None:
            super().receive(packet, now)
        elif (key := _key(packet)) not in self._reading and len(self._reading) < MAX_WAITING:
            self._reading.add(key)
            self.emit(SettingsRequested(names, packet))

    def answer(self, packet: Packet, now: float) -> None:
        """Answer the request of a `SettingsRequested` with the present values."""
        self._reading.discard(_key(packet))
        super().receive(packet, now)

    def written(self, event: SettingWritten, value: Value) -> None:
        """Answer a set with the value that was read back."""
        self._writing.pop(event.name, None)
        super()._write(self.table[event.name], value, event.source, event.packet)

    def refuse(self, event: SettingWritten, error: common.MavParamError) -> None:
        """Answer a set that failed with the reason, and with the unchanged value."""
        self._writing.pop(event.name, None)
        if event.packet is not None:
            self._send_refusal(event.packet, event.name, error, event.source)

    def _requested(self, packet: Packet) -> tuple[str, ...] | None:
        """Return the names of the settings to read again; None if the request needs none."""
        match packet.message:
            case common.ParamRequestList():
                return ()
            case common.ParamRequestRead(param_index=index, param_id=name):
                definition = self.table.find(name if index < 0 else index)
                return None if definition is None else (definition.name,)
        return None

    def _write(
        self, definition: ParameterDefinition, value: Value, source: Address, packet: Packet | None = None
    ) -> None:
        held = fitted(value, definition.kind)
        if held is None or self._writing.get(definition.name) == held:
            return  # the client repeats a request that is already being written
        self._writing[definition.name] = held
        self.emit(SettingWritten(definition.name, held, source, packet))


def _key(packet: Packet) -> _Key:
    source = Address(packet.system, packet.component)
    match packet.message:
        case common.ParamRequestRead(param_index=index, param_id=name):
            return source, common.ParamRequestRead, name if index < 0 else index
    return source, common.ParamRequestList, ""
