"""Behaviour limits: the ground station that may command and change a vehicle that flies.

While a vehicle is armed, one ground station commands it: one of `operators`, or without that option the first
one that sent it a command. Commands of others are refused. Its own pilot may stop the motors of a vehicle in
flight by a forced disarm, unless `forced_disarm` is false. On the ground all may command, as far as the rules
allow.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Final

from mavstack.dialects import common
from mavstack.router.firewall.detector import Detector, make_room
from mavstack.router.firewall.sources import source
from mavstack.security.acting import FLIGHT_KINDS, acting_ids
from mavstack.services import Address, message_ids

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.router.config import Table
    from mavstack.router.firewall.alerts import Alert
    from mavstack.wire import Packet

MAX_VEHICLES: Final = 256
#: The value of param 2 of MAV_CMD_COMPONENT_ARM_DISARM that forces disarming in flight.
_FORCE: Final = 21196
_SENSITIVE: Final = frozenset(
    {
        common.MavCmd.COMPONENT_ARM_DISARM,
        common.MavCmd.DO_SET_MODE,
        common.MavCmd.DO_FLIGHTTERMINATION,
        common.MavCmd.DO_SET_HOME,
        common.MavCmd.DO_REPOSITION,
        common.MavCmd.NAV_RETURN_TO_LAUNCH,
        common.MavCmd.NAV_LAND,
        common.MavCmd.NAV_TAKEOFF,
        common.MavCmd.MISSION_START,
        common.MavCmd.DO_SET_MISSION_CURRENT,
        common.MavCmd.PREFLIGHT_REBOOT_SHUTDOWN,
    }
)
_CHANGES: Final = acting_ids(*FLIGHT_KINDS)


@dataclass(slots=True)
class _Vehicle:
    armed: bool = False
    pilot: Address | None = None


class FlightBehaviour(Detector):
    """Refuses changes of a flying vehicle by others than its pilot."""

    name: ClassVar[str] = "behaviour"
    messages: frozenset[int] = message_ids(common.Heartbeat, common.CommandLong, common.CommandInt) | _CHANGES

    def __init__(self) -> None:
        self.operators: frozenset[Address] = frozenset()
        self.forced_disarm = True
        self._vehicles: dict[int, _Vehicle] = {}

    def configure(self, options: Table) -> None:
        """Read the options of the detector."""
        self.operators = frozenset(options.members("operators", source))
        self.forced_disarm = options.value("forced_disarm", bool, default=self.forced_disarm)

    def inspect(self, origin: str, packet: Packet, now: float) -> Iterator[Alert]:
        """Yield the alerts about a packet."""
        message = packet.message
        if isinstance(message, common.Heartbeat):
            self._heard(packet.system, message)
        elif isinstance(message, common.CommandLong | common.CommandInt):
            if message.command in _SENSITIVE:
                yield from self._change(origin, packet, _name(message))
        elif packet.message_id in _CHANGES:
            yield from self._change(origin, packet, str(packet.name))

    def _heard(self, system: int, heartbeat: common.Heartbeat) -> None:
        if heartbeat.autopilot == common.MavAutopilot.INVALID:
            return
        make_room(self._vehicles, MAX_VEHICLES)
        vehicle = self._vehicles.setdefault(system, _Vehicle())
        armed = bool(heartbeat.base_mode & common.MavModeFlag.SAFETY_ARMED)
        if vehicle.armed and not armed:
            vehicle.pilot = None  # disarmed: the flight has ended
        vehicle.armed = armed

    def _change(self, origin: str, packet: Packet, change: str) -> Iterator[Alert]:
        target = getattr(packet.message, "target_system", getattr(packet.message, "target", 0))
        targets = [target] if target else list(self._vehicles)
        sender = Address(packet.system, packet.component)
        for vehicle in (self._vehicles.get(system) for system in targets):
            if vehicle is None:
                continue
            if not self._may_change(vehicle, sender):
                others = "its operators command" if self.operators else f"{vehicle.pilot} commands"
                yield self.alert(origin, packet, f"{change} for a flying vehicle that {others}")
            elif vehicle.armed and not self.forced_disarm and _is_forced_disarm(packet.message):
                yield self.alert(origin, packet, "disarming by force while the vehicle flies")

    def _may_change(self, vehicle: _Vehicle, sender: Address) -> bool:
        if self.operators:
            return not vehicle.armed or sender in self.operators
        if vehicle.pilot is None or not vehicle.armed:
            vehicle.pilot = sender
        return sender == vehicle.pilot


def _name(message: common.CommandLong | common.CommandInt) -> str:
    command: Any = message.command
    return getattr(command, "name", str(command))


def _is_forced_disarm(message: Any) -> bool:  # noqa: ANN401 (a message of any class)
    if not isinstance(message, common.CommandLong | common.CommandInt):
        return False
    disarms = message.command == common.MavCmd.COMPONENT_ARM_DISARM and message.param1 == 0
    return disarms and message.param2 == _FORCE
