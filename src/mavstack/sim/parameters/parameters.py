"""The parameters of one simulated vehicle, as its own program sees them.

The values lie in one ParameterTable, which outlives reboots; each boot makes another ParameterServer that
offers that table. So what a client sets counts at once, and what the vehicle sets is told to everybody.

    parameters = Parameters(Firmware.ARDUPILOT, VehicleType.COPTER, system=7)
    server = engine.add(parameters.new_server(local, engine.touch))
    parameters["RTL_ALT"]                                      # 1500
    parameters.on_change("WPNAV_SPEED", lambda speed: ...)     # until the next boot
    parameters.set("STAT_BOOTCNT", 2)

Whoever runs the server hands its ParameterWritten events to `written`, which calls those who watch. A name
that the vehicle does not have is a mistake of ours and raises KeyError.
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, TypeVar

from mavstack.services.parameters import Encoding, ParameterServer, ParameterTable
from mavstack.services.parameters.value import as_type, same
from mavstack.sim.parameters.tables import definitions
from mavstack.sim.vehicle_types import Firmware, VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.services import Address, Service
    from mavstack.services.parameters import ParameterWritten, Value

Default = TypeVar("Default")

_SYSTEM_NAMES = {Firmware.ARDUPILOT: "SYSID_THISMAV", Firmware.PX4: "MAV_SYS_ID"}
_ENCODINGS = {Firmware.ARDUPILOT: Encoding.C_CAST, Firmware.PX4: Encoding.BYTEWISE}


class Parameters:
    """A vehicle's handle on its table."""

    def __init__(self, firmware: Firmware, type: VehicleType, system: int = 1) -> None:  # noqa: A002
        self.table = ParameterTable()
        for definition in definitions(firmware, type):
            self.table.add(definition)
        self.encoding = _ENCODINGS[firmware]
        self._system_name = _SYSTEM_NAMES[firmware]
        identity = self.table[self._system_name]
        identity.value = identity.default = as_type(self._system_name, system, identity.kind)
        self._server: ParameterServer | None = None
        self._touch: Callable[[Service], None] | None = None
        self._forget_watchers()

    def __len__(self) -> int:
        return len(self.table)

    def __contains__(self, name: object) -> bool:
        return name in self.table

    def __getitem__(self, name: str) -> Value:
        """The value of a parameter."""
        return self.table[name].value

    def get(self, name: str, default: Default) -> Value | Default:
        """The value of a parameter, or `default` if this vehicle does not have it."""
        return self.table[name].value if name in self.table else default

    @property
    def system(self) -> int:
        """The system id that the vehicle takes at its next boot."""
        return int(self[self._system_name])

    def set(self, name: str, value: Value) -> None:
        """Set a parameter by the vehicle's own right, and tell everybody if it changed."""
        definition = self.table[name]
        held = as_type(name, value, definition.kind)
        if same(held, definition.value):
            return
        if self._server is None:
            definition.value = held
        else:
            self._server.set(name, held)
            if self._touch is not None:
                self._touch(self._server)
        self._changed(name)

    def reset(self) -> None:
        """Set whatever clients may set back to its default; counters stay."""
        for definition in self.table:
            if not definition.read_only and definition.default is not None:
                self.set(definition.name, definition.default)

    # Watching

    def on_change(self, name: str, callback: Callable[[Value], None]) -> None:
        """Call back with each new value of a parameter, whoever set it, until the next boot."""
        if name not in self.table:
            raise KeyError(name)
        self._watchers[name].append(callback)

    def on_any_change(self, callback: Callable[[str, Value], None]) -> None:
        """Call back with the name and new value of any parameter, until the next boot."""
        self._watchers_of_all.append(callback)

    def written(self, event: ParameterWritten) -> None:
        """A client set a parameter: tell those who watch."""
        self._changed(event.parameter.name)

    # Offering

    def new_server(self, local: Address, touch: Callable[[Service], None] | None = None) -> ParameterServer:
        """The server of a new boot; `touch` tells its engine that there is something to send.

        Those who watched during the boot before are forgotten.
        """
        self._forget_watchers()
        self._server, self._touch = ParameterServer(local, self.encoding), touch
        self._server.table = self.table
        return self._server

    def _changed(self, name: str) -> None:
        value = self[name]
        for tell in tuple(self._watchers.get(name, ())):
            tell(value)
        for tell_all in tuple(self._watchers_of_all):
            tell_all(name, value)

    def _forget_watchers(self) -> None:
        self._watchers: defaultdict[str, list[Callable[[Value], None]]] = defaultdict(list)
        self._watchers_of_all: list[Callable[[str, Value], None]] = []
