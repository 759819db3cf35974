"""The monitor of the gimbals that one component manages: abilities, control and attitude.

A gimbal device that is a component of its own reports its attitude itself, without a device id; then its
component id is the device id that the manager names. Older autopilots leave the device id of their own gimbal
0: it counts for the only gimbal of the manager.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeVar

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids
from mavstack.services.gimbal.reports import ALL_DEVICES, GimbalAttitude, GimbalInformation, GimbalStatus
from mavstack.services.service import Event, Service

if TYPE_CHECKING:
    from mavstack.wire import Packet

Key = TypeVar("Key")
Value = TypeVar("Value")

#: The largest number of gimbals of one manager, so that forged ids cannot fill the memory.
MAX_GIMBALS = 16


@dataclass(frozen=True, slots=True)
class GimbalFound(Event):
    """A gimbal manager told of a gimbal for the first time."""

    manager: Address
    information: GimbalInformation


@dataclass(frozen=True, slots=True)
class GimbalStatusChanged(Event):
    """Other components control a gimbal now, or its flags changed."""

    manager: Address
    status: GimbalStatus


class GimbalMonitor(Service):
    """The gimbals that one component manages, from its messages and those of their devices."""

    handles = message_ids(
        common.GimbalManagerInformation,
        common.GimbalManagerStatus,
        common.GimbalDeviceInformation,
        common.GimbalDeviceAttitudeStatus,
    )

    def __init__(self, local: Address, target: Address) -> None:
        super().__init__(local)
        self.target = target
        self.source_filter = Address(target.system, 0)
        self._informations: dict[int, GimbalInformation] = {}
        self._statuses: dict[int, GimbalStatus] = {}
        #: The attitudes by the component id of the sender and the device id in the message.
        self._attitudes: dict[tuple[int, int], GimbalAttitude] = {}
        self._names: dict[tuple[int, int], tuple[str, str]] = {}

    @property
    def informations(self) -> list[GimbalInformation]:
        """The gimbals of the manager, by device id."""
        return [self._named(self._informations[number]) for number in sorted(self._informations)]

    def information(self, device_id: int = ALL_DEVICES) -> GimbalInformation | None:
        """Return the abilities of a gimbal; of the first one for device id 0; None until received."""
        number = self._resolved(device_id)
        found = None if number is None else self._informations.get(number)
        return None if found is None else self._named(found)

    def status(self, device_id: int = ALL_DEVICES) -> GimbalStatus | None:
        """Return who controls a gimbal; None until received."""
        number = self._resolved(device_id)
        return None if number is None else self._statuses.get(number)

    def attitude(self, device_id: int = ALL_DEVICES) -> GimbalAttitude | None:
        """Return the last attitude of a gimbal; None until received."""
        own, number = self.target.component, self._resolved(device_id)
        if number is None:
            keys = [key for key in self._attitudes if key[0] == own]
        else:
            keys = [(own, number), (number, 0)]
            keys += [(own, 0)] if len(self._informations) <= 1 else []
        return next((self._attitudes[key] for key in keys if key in self._attitudes), None)

    def clear_cache(self, now: float) -> None:
        """Discard all state, because the component rebooted."""
        for table in (self._informations, self._statuses, self._attitudes, self._names):
            table.clear()

    def receive(self, packet: Packet, now: float) -> None:
        own = packet.component == self.target.component
        if packet.system != self.target.system:
            return
        match packet.message:
            case common.GimbalManagerInformation() as message if own:
                self._learn(GimbalInformation.read(message))
            case common.GimbalManagerStatus() as message if own:
                self._controlled(GimbalStatus.read(message))
            case common.GimbalDeviceInformation(gimbal_device_id=number) as message:
                names = (_text(message.vendor_name), _text(message.model_name))
                _store(self._names, (packet.component, int(number)), names)
            case common.GimbalDeviceAttitudeStatus(gimbal_device_id=number) as message:
                attitude = GimbalAttitude.read(message)
                if attitude is not None:
                    _store(self._attitudes, (packet.component, int(number)), attitude)

    def _resolved(self, device_id: int) -> int | None:
        """Return the device id of a gimbal; 0 stands for the first one that is known."""
        if device_id != ALL_DEVICES:
            return device_id
        return min((*self._informations, *self._statuses), default=None)

    def _learn(self, information: GimbalInformation) -> None:
        known = information.device_id in self._informations
        if _store(self._informations, information.device_id, information) and not known:
            self.emit(GimbalFound(self.target, information))

    def _controlled(self, status: GimbalStatus) -> None:
        before = self._statuses.get(status.device_id)
        if _store(self._statuses, status.device_id, status) and status != before:
            self.emit(GimbalStatusChanged(self.target, status))

    def _named(self, information: GimbalInformation) -> GimbalInformation:
        number = information.device_id
        names = self._names.get((self.target.component, number)) or self._names.get((number, 0))
        return information if names is None else replace(information, vendor=names[0], model=names[1])


def _store(table: dict[Key, Value], key: Key, value: Value) -> bool:
    """Store a value unless the table is full; return whether it was stored."""
    if key not in table and len(table) >= MAX_GIMBALS:
        return False
    table[key] = value
    return True


def _text(field: str | bytes) -> str:
    if isinstance(field, bytes):
        return field.partition(b"\0")[0].decode("utf-8", "replace")
    return field
