"""ArduPilot as a profile: what makes a simulated vehicle behave as its firmware for the type does."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.version import provide_versions
from mavstack.sim.ardupilot.arming import PreArmWatch, arming_problems, prearm_problems
from mavstack.sim.ardupilot.behaviours import NoseWatch, Trail, trail_of
from mavstack.sim.ardupilot.commands import origin_of, register_commands
from mavstack.sim.ardupilot.failsafes import ArdupilotFailsafes
from mavstack.sim.ardupilot.flight_parameters import flight_parameters_of
from mavstack.sim.ardupilot.identity import version_of
from mavstack.sim.ardupilot.messages import ArdupilotMessages, guided_item
from mavstack.sim.ardupilot.mode_switch import ModeSwitch
from mavstack.sim.ardupilot.modes import BLOCKABLE, MODES, ROLES
from mavstack.sim.ardupilot.simulation_parameters import SimulationParameters
from mavstack.sim.ardupilot.texts import BootTexts, armed_text, disarmed_text
from mavstack.sim.autopilot.commands.home import home_position
from mavstack.sim.autopilot.interfaces import FirmwareProfile
from mavstack.sim.telemetry import publish_ardupilot
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.services import Address
    from mavstack.services.mission import MissionItem
    from mavstack.sim.ardupilot.base_flight_parameters import ArdupilotFlightParameters
    from mavstack.sim.autopilot.interfaces import Autopilot, Mode, Vehicle

_ALTITUDE_ONLY = 3
_WITH_NOSE = frozenset({VehicleType.COPTER, VehicleType.SUB})
_WITH_TRAIL = frozenset({VehicleType.COPTER, VehicleType.ROVER, VehicleType.BOAT})


class ArdupilotProfile(FirmwareProfile):
    """Copter, Plane, Rover or Sub."""

    refusal = ""

    def __init__(self, type: VehicleType) -> None:  # noqa: A002 (HEARTBEAT's name for it)
        self.type = type
        self.modes = MODES[type]
        roles = ROLES[type]
        self.initial, self.hold, self.guided = roles.initial, roles.hold, roles.guided
        self.mission, self.return_to_launch = roles.mission, roles.return_to_launch
        self.land, self.takeoff_mode = roles.land, roles.take_off

    def flight_parameters(self, vehicle: Vehicle) -> ArdupilotFlightParameters:
        """From its parameters."""
        return flight_parameters_of(vehicle)

    # At boot

    def register(self, vehicle: Vehicle) -> None:
        """Commands, watches, and what the parameters say about the body."""
        autopilot = vehicle.autopilot
        register_commands(vehicle)
        vehicle.engine.add(ArdupilotMessages(vehicle))
        flight_parameters_of(vehicle).follow(vehicle.body)
        if self.type in _WITH_TRAIL:
            autopilot.watches.append(Trail(autopilot))
        if self.type in _WITH_NOSE:
            autopilot.watches.append(NoseWatch(autopilot))
        autopilot.watches.append(PreArmWatch(autopilot))
        autopilot.watches.append(BootTexts(autopilot))
        ArdupilotFailsafes(autopilot, self.mode_failure)
        autopilot.watches.append(ModeSwitch(autopilot, self.mode_failure))
        SimulationParameters(vehicle)

    def provide(self, vehicle: Vehicle) -> None:
        """Telemetry and versions."""
        publish_ardupilot(vehicle)
        provide_versions(vehicle.messages, version_of(vehicle))

    def booted(self, vehicle: Vehicle) -> None:
        """The rest is said as things settle (`BootTexts`)."""
        vehicle.send_statustext("Initialising ArduPilot", common.MavSeverity.INFO)

    # Arming

    def prearm_problems(self, autopilot: Autopilot) -> Iterator[str]:
        """Without the mode and the throttle, which are looked at when arming is asked for."""
        return prearm_problems(autopilot)

    def arming_problems(self, autopilot: Autopilot) -> Iterator[str]:
        """With the prefix of an attempt to arm."""
        return (f"Arm: {problem}" for problem in arming_problems(autopilot))

    def armed(self, autopilot: Autopilot) -> None:
        """The motors were armed."""
        autopilot.vehicle.send_statustext(armed_text(self.type), common.MavSeverity.INFO)

    def disarmed(self, autopilot: Autopilot) -> None:
        """The motors were disarmed: the mission begins anew."""
        autopilot.vehicle.send_statustext(disarmed_text(self.type), common.MavSeverity.INFO)
        autopilot.mission.reset()
        autopilot.mission.restore(autopilot.mission.first)

    # Modes

    def mode_refusal(self, autopilot: Autopilot, mode: Mode) -> str | None:
        """As the firmware says it, the mode's name included."""
        if self._is_blocked(autopilot, mode):
            return f"Mode change to {mode.name} failed: GCS entry disabled (FLTMODE_GCSBLOCK)"
        return self.mode_failure(autopilot, mode)

    def mode_failure(self, autopilot: Autopilot, mode: Mode) -> str | None:
        """Why not even the autopilot itself can enter a mode now."""
        failed = f"Mode change to {mode.name} failed: "
        if mode.number == self.mission:
            reason = autopilot.mission.refusal()
            if reason is not None:
                return reason
        if not autopilot.armed:
            return None
        if mode.needs_position and not autopilot.has_position:
            return f"{failed}requires position"
        trail = trail_of(autopilot)
        if mode.name == "SMART_RTL" and (trail is None or trail.lost or not trail.points):
            return f"{failed}init failed"
        if mode.name == "AUTO_RTL" and autopilot.mission.landing_start() is None:
            return f"{failed}init failed"
        return None

    def _is_blocked(self, autopilot: Autopilot, mode: Mode) -> bool:
        blocked = int(autopilot.vehicle.parameters.get("FLTMODE_GCSBLOCK", 0))
        numbers = BLOCKABLE.get(self.type, ())
        return mode.number in numbers and bool(blocked >> numbers.index(mode.number) & 1)

    def take_off(self, autopilot: Autopilot, height: float) -> None:
        """Arm and leave the ground, whatever the mode was; what does not fly holds where it is."""
        if self.type is VehicleType.PLANE:
            autopilot.vehicle.parameters.set("TKOFF_ALT", height)
        autopilot.enter(self.takeoff_mode, "take-off")
        autopilot.arm(force=True)
        if self.type in (VehicleType.COPTER, VehicleType.VTOL):
            autopilot.guided.take_off(height)

    # Who counts

    def may_steer(self, vehicle: Vehicle, source: Address) -> bool:
        """Only the ground station of SYSID_MYGCS."""
        return source.system == int(vehicle.parameters.get("SYSID_MYGCS", 255))

    def is_ground(self, vehicle: Vehicle, source: Address) -> bool:
        """The same."""
        return self.may_steer(vehicle, source)

    # What is told at once

    def home_changed(self, vehicle: Vehicle) -> None:
        """HOME_POSITION and GPS_GLOBAL_ORIGIN, to everybody."""
        message = home_position(vehicle)
        if message is not None:
            vehicle.services.send(message)
            vehicle.services.send(origin_of(vehicle))

    def guided_items(self, vehicle: Vehicle) -> Callable[[MissionItem, int], int]:
        """The older way of saying where to go: `current` = 2, or 3 for the altitude alone."""
        return lambda item, current: guided_item(vehicle, item, altitude_only=current == _ALTITUDE_ONLY)
