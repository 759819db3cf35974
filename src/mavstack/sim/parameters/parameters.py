"""The parameters of one simulated vehicle, as its firmware uses them.

The values are in one ParameterTable, which survives reboots; a power cycle reverts those that were not saved
yet. Each boot creates a ParameterServer that serves
this table. A value set by a client takes effect immediately, and a value set by the vehicle is broadcast.

    parameters = Parameters(Firmware.ARDUPILOT, VehicleType.COPTER, system=7)
    server = engine.add(parameters.new_server(local, engine.touch))
    parameters["RTL_ALT"]                                      # 1500
    parameters.on_change("WPNAV_SPEED", lambda speed: ...)     # until the next boot
    parameters.set("STAT_BOOTCNT", 2)

The owner of the server passes its ParameterWritten events to `written`, which calls the callbacks. The name
of a parameter that the vehicle does not have raises KeyError.
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
#: Seconds after the last change until the firmware saves changed parameters automatically.
AUTOSAVE_DELAYS = {Firmware.ARDUPILOT: 0.0, Firmware.PX4: 2.0}
_ENCODINGS = {Firmware.ARDUPILOT: Encoding.C_CAST, Firmware.PX4: Encoding.BYTEWISE}


class Parameters:
    """The parameters of one vehicle.

    Args:
        firmware: Selects the table and the encoding.
        vehicle_type: Selects the table.
        system: The system id, which is a parameter too.
    """

    def __init__(self, firmware: Firmware, vehicle_type: VehicleType, system: int = 1) -> None:
        self.table = ParameterTable()
        for definition in definitions(firmware, vehicle_type):
            self.table.add(definition)
        self.encoding = _ENCODINGS[firmware]
        self._autosave_delay = AUTOSAVE_DELAYS[firmware]
        #: By name: the saved value of each parameter that changed after it was saved.
        self._saved: dict[str, Value] = {}
        self._save_due: float | None = None
        self._now = 0.0
        self._system_name = _SYSTEM_NAMES[firmware]
        identity = self.table[self._system_name]
        identity.value = identity.default = as_type(self._system_name, system, identity.kind)
        self._server: ParameterServer | None = None
        self._touch: Callable[[Service], None] | None = None
        self._clear_callbacks()

    def __len__(self) -> int:
        return len(self.table)

    def __contains__(self, name: object) -> bool:
        return name in self.table

    def __getitem__(self, name: str) -> Value:
        """Return the value of a parameter."""
        return self.table[name].value

    def get(self, name: str, default: Default) -> Value | Default:
        """Return the value of a parameter, or `default` if the vehicle does not have it."""
        return self.table[name].value if name in self.table else default

    @property
    def system(self) -> int:
        """System id from the next boot on."""
        return int(self[self._system_name])

    def set(self, name: str, value: Value) -> None:
        """Set a parameter as the vehicle itself, and broadcast a changed value.

        Raises:
            KeyError: The vehicle does not have the parameter.
            LocalProtocolError: The parameter's type cannot hold the value.
        """
        definition = self.table[name]
        typed = as_type(name, value, definition.kind)
        if same(typed, definition.value):
            return
        self._changes(name, definition.value)
        if self._server is None:
            definition.value = typed
        else:
            self._server.set(name, typed)
            if self._touch is not None:
                self._touch(self._server)
        self._notify(name)

    def reset(self) -> None:
        """Set all parameters that clients may set to their defaults; counters keep their values."""
        for definition in self.table:
            if not definition.read_only and definition.default is not None:
                self.set(definition.name, definition.default)

    # Storage

    def tick(self, now: float) -> None:
        """Save changed values if it is time."""
        self._now = now
        if self._save_due is not None and now >= self._save_due:
            self.save()

    def save(self) -> None:
        """Save all values, so that they outlast a power cycle."""
        self._saved.clear()
        self._save_due = None

    def revert_unsaved(self) -> None:
        """Return to the saved values, as after a power cycle."""
        for name, value in self._saved.items():
            self.table[name].value = value
        self.save()

    def _changes(self, name: str, previous: Value) -> None:
        """Note that a value changes, and when it is saved."""
        if self._autosave_delay:
            self._saved.setdefault(name, previous)
            self._save_due = self._now + self._autosave_delay

    # Callbacks

    def on_change(self, name: str, callback: Callable[[Value], None]) -> None:
        """Call back with each new value of a parameter until the next boot."""
        if name not in self.table:
            raise KeyError(name)
        self._callbacks[name].append(callback)

    def on_any_change(self, callback: Callable[[str, Value], None]) -> None:
        """Call back with name and new value of any parameter until the next boot."""
        self._any_callbacks.append(callback)

    def written(self, event: ParameterWritten) -> None:
        """Call the callbacks after a client set a parameter."""
        self._changes(event.parameter.name, event.previous)
        self._notify(event.parameter.name)

    # Parameter protocol

    def new_server(self, local: Address, touch: Callable[[Service], None] | None = None) -> ParameterServer:
        """Return the server of a new boot, and remove the callbacks of the previous boot.

        Args:
            local: The address of the server.
            touch: Callback that notifies the engine when the service has something to send, or None.
        """
        self._clear_callbacks()
        self._server, self._touch = ParameterServer(local, self.encoding), touch
        self._server.table = self.table
        return self._server

    def _notify(self, name: str) -> None:
        """Call the callbacks of a parameter."""
        value = self[name]
        for callback in tuple(self._callbacks.get(name, ())):
            callback(value)
        for any_callback in tuple(self._any_callbacks):
            any_callback(name, value)

    def _clear_callbacks(self) -> None:
        """Remove all callbacks."""
        self._callbacks: defaultdict[str, list[Callable[[Value], None]]] = defaultdict(list)
        self._any_callbacks: list[Callable[[str, Value], None]] = []
