"""ArduPilot's firmware profile: the behaviour of Copter, Plane, Rover and Sub by vehicle type."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.services.component_metadata import provide_component_metadata
from mavstack.services.version import provide_versions
from mavstack.sim.ardupilot.arming import PreArmReporter, arming_problems, prearm_problems
from mavstack.sim.ardupilot.avoidance import register_avoidance
from mavstack.sim.ardupilot.behaviours import RegionOfInterestYaw, ReturnPath, return_path_of
from mavstack.sim.ardupilot.commands import origin_of, register_commands
from mavstack.sim.ardupilot.empty_mission import EmptyMission
from mavstack.sim.ardupilot.external_gps import register_external_gps
from mavstack.sim.ardupilot.external_vision import register_external_vision
from mavstack.sim.ardupilot.failsafes import ArdupilotFailsafes
from mavstack.sim.ardupilot.flight_parameters import flight_parameters_of
from mavstack.sim.ardupilot.follow import is_enabled, refuse_entry, register_follow
from mavstack.sim.ardupilot.gps_port import GpsPort
from mavstack.sim.ardupilot.home_updates import watch_home
from mavstack.sim.ardupilot.identity import VERSION, version_of
from mavstack.sim.ardupilot.messages import ArdupilotMessages, guided_item
from mavstack.sim.ardupilot.mode_switch import ModeSwitch
from mavstack.sim.ardupilot.modes import BLOCKABLE, MODE_ROLES, MODES
from mavstack.sim.ardupilot.motor_calibration import CompassMotorCalibration, EscCalibration, compass_motor_of
from mavstack.sim.ardupilot.precision_landing import register_precision_landing
from mavstack.sim.ardupilot.sd_card import flash_from_sd_card
from mavstack.sim.ardupilot.simulation_parameters import SimulationParameters
from mavstack.sim.ardupilot.terrain import register_terrain
from mavstack.sim.ardupilot.texts import BootTexts, armed_text, disarmed_text
from mavstack.sim.ardupilot.traffic_avoidance import TrafficAvoidance
from mavstack.sim.ardupilot.traffic_evasion import CopterEvasion, PlaneEvasion
from mavstack.sim.ardupilot.transponder import TransponderPort
from mavstack.sim.autopilot.commands.home import home_position
from mavstack.sim.autopilot.external_range import ExternalRange
from mavstack.sim.autopilot.firmware_profile import FirmwareProfile
from mavstack.sim.autopilot.origin import OriginReceiver
from mavstack.sim.can import CanDevices
from mavstack.sim.parameters import served_metadata
from mavstack.sim.telemetry import HighLatency, publish_ardupilot
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.services import Address
    from mavstack.services.mission import MissionItem
    from mavstack.services.version import FirmwareVersion
    from mavstack.sim.ardupilot.flight_parameters import ArdupilotFlightParameters
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.firmware_profile import Mode
    from mavstack.sim.vehicle import SimulatedVehicle

_ALTITUDE_ONLY = 3
#: The value of RNGFND1_TYPE for a rangefinder of a companion computer, and the seconds that a report counts.
_RANGE_BY_MAVLINK: Final = 10
_RANGE_TIMEOUT: Final = 0.5
#: The first version of ArduRover that reports the altitude above home; older versions report the altitude
#: above the sea instead.
_ROVER_HEIGHT = (4, 2)
_WITH_YAW_CONTROL = frozenset({VehicleType.COPTER, VehicleType.SUB})
#: The parameter with the MAV_TYPE of a quadplane; the value 0 means the MAV_TYPE of a plane.
_QUADPLANE_TYPE = "Q_MAV_TYPE"
_WITH_AVOIDANCE = frozenset({VehicleType.COPTER, VehicleType.ROVER, VehicleType.BOAT})
_WITH_RETURN_PATH = frozenset({VehicleType.COPTER, VehicleType.ROVER, VehicleType.BOAT})


class ArdupilotProfile(FirmwareProfile):
    """ArduPilot on one vehicle: Copter, Plane, Rover or Sub."""

    refusal = ""

    def __init__(self, vehicle_type: VehicleType, version: FirmwareVersion = VERSION) -> None:
        self.vehicle_type, self.version = vehicle_type, version
        self.reports_no_height = vehicle_type.on_surface and version[:2] < _ROVER_HEIGHT
        self.modes = MODES[vehicle_type]
        roles = MODE_ROLES[vehicle_type]
        self.initial, self.hold, self.guided = int(roles.initial), int(roles.hold), int(roles.guided)
        self.mission, self.return_to_launch = int(roles.mission), int(roles.return_to_launch)
        self.land, self.takeoff_mode = int(roles.land), int(roles.take_off)

    def flight_parameters(self, vehicle: SimulatedVehicle) -> ArdupilotFlightParameters:
        """Return the flight parameters of a vehicle."""
        return flight_parameters_of(vehicle)

    def mav_type(self, vehicle: SimulatedVehicle) -> int:
        """Return the MAV_TYPE in HEARTBEAT; a quadplane is FIXED_WING unless Q_MAV_TYPE is set."""
        if self.vehicle_type is not VehicleType.VTOL:
            return super().mav_type(vehicle)
        return int(vehicle.parameters.get(_QUADPLANE_TYPE, 0)) or common.MavType.FIXED_WING

    # At boot

    def register(self, vehicle: SimulatedVehicle) -> None:
        """Register commands, periodic checks and the limits of the body at boot."""
        autopilot = vehicle.autopilot
        register_commands(vehicle)
        vehicle.engine.add(ArdupilotMessages(vehicle))
        flight_parameters_of(vehicle).apply_limits(vehicle.body)
        if self.vehicle_type in _WITH_RETURN_PATH:
            autopilot.watches.append(ReturnPath(autopilot))
        if self.vehicle_type in _WITH_YAW_CONTROL:
            autopilot.watches.append(RegionOfInterestYaw(autopilot))
        if self.vehicle_type is VehicleType.COPTER:
            autopilot.watches += [CompassMotorCalibration(autopilot), EscCalibration(autopilot)]
            TrafficAvoidance(autopilot, CopterEvasion(autopilot))
        if self.vehicle_type in _WITH_AVOIDANCE:
            register_avoidance(vehicle)
        watch_home(autopilot, self.vehicle_type)
        autopilot.watches.append(PreArmReporter(autopilot))
        autopilot.watches.append(BootTexts(autopilot))
        if self.vehicle_type in (VehicleType.PLANE, VehicleType.VTOL):
            autopilot.watches.append(EmptyMission(autopilot))
            TrafficAvoidance(autopilot, PlaneEvasion(autopilot))
        ArdupilotFailsafes(autopilot, self.mode_failure)
        autopilot.watches.append(ModeSwitch(autopilot, self.mode_failure))
        SimulationParameters(vehicle)
        register_external_gps(vehicle)
        vehicle.body.range_report = None
        if int(vehicle.parameters.get("RNGFND1_TYPE", 0)) == _RANGE_BY_MAVLINK:
            vehicle.engine.add(ExternalRange(vehicle, timeout=_RANGE_TIMEOUT, fallback=inf))
        register_external_vision(vehicle)
        OriginReceiver.add_to(vehicle)
        register_follow(vehicle)
        vehicle.engine.add(TransponderPort(vehicle))
        register_precision_landing(vehicle)
        CanDevices(vehicle)
        vehicle.engine.add(GpsPort(vehicle))
        register_terrain(vehicle)
        if _QUADPLANE_TYPE in vehicle.parameters:
            vehicle.parameters.on_change(_QUADPLANE_TYPE, lambda _: vehicle.services.refresh_type())

    def provide(self, vehicle: SimulatedVehicle) -> None:
        """Publish streams and versions, and the metadata, which a real ArduPilot does not serve."""
        publish_ardupilot(vehicle)
        provide_component_metadata(
            vehicle.messages,
            lambda: served_metadata(vehicle.firmware, self.vehicle_type),
            lambda: vehicle.uptime,
        )
        provide_versions(vehicle.messages, version_of(vehicle))
        HighLatency(vehicle)

    def booted(self, vehicle: SimulatedVehicle) -> None:
        """Send the first status text; `BootTexts` sends the others."""
        vehicle.send_statustext("Initialising ArduPilot", common.MavSeverity.INFO)
        flash_from_sd_card(vehicle)

    # Arming

    def prearm_problems(self, autopilot: SimulatedAutopilot) -> Iterator[str]:
        """Yield pre-arm problems, without mode and throttle."""
        return prearm_problems(autopilot)

    def arming_problems(self, autopilot: SimulatedAutopilot) -> Iterator[str]:
        """Yield problems that prevent arming, with the prefix of an arming attempt."""
        return (f"Arm: {problem}" for problem in arming_problems(autopilot))

    def armed(self, autopilot: SimulatedAutopilot) -> None:
        """Report arming."""
        autopilot.vehicle.send_statustext(armed_text(self.vehicle_type), common.MavSeverity.INFO)

    def disarmed(self, autopilot: SimulatedAutopilot) -> None:
        """Report disarming, and reset the mission."""
        autopilot.vehicle.send_statustext(disarmed_text(self.vehicle_type), common.MavSeverity.INFO)
        autopilot.mission.reset()
        autopilot.mission.set_current(autopilot.mission.first)

    def armed_state(self, autopilot: SimulatedAutopilot) -> int:
        """Return STANDBY for a copter or plane on the ground: they are active in the air only."""
        grounded = self.vehicle_type.flies and autopilot.landed
        return common.MavState.STANDBY if grounded else common.MavState.ACTIVE

    def reports_armed(self, autopilot: SimulatedAutopilot) -> bool:
        """Return whether the motors may run: also in tests and calibrations, except those of a quadplane."""
        if autopilot.armed or self.vehicle_type is VehicleType.VTOL:
            return autopilot.armed
        calibration = compass_motor_of(autopilot)
        calibrating = calibration is not None and calibration.started is not None
        return calibrating or bool(autopilot.payload.motor_tested)

    # Modes

    def mode_refusal(self, autopilot: SimulatedAutopilot, mode: Mode) -> str | None:
        """Return why a ground station may not enter a mode now; None if it may."""
        if self._is_blocked(autopilot, mode):
            return f"Mode change to {mode.name} failed: GCS entry disabled (FLTMODE_GCSBLOCK)"
        return self.mode_failure(autopilot, mode)

    def mode_failure(self, autopilot: SimulatedAutopilot, mode: Mode) -> str | None:
        """Return why even the autopilot itself cannot enter a mode now; None if it can."""
        failed = f"Mode change to {mode.name} failed: "
        if mode.number == self.mission:
            reason = autopilot.mission.refusal()
            if reason is not None:
                return reason
        if mode.name == "FOLLOW" and not is_enabled(autopilot.vehicle):
            return refuse_entry(autopilot.vehicle)
        if not autopilot.armed:
            return None
        if mode.needs_position and not autopilot.has_position:
            return f"{failed}requires position"
        path = return_path_of(autopilot)
        if mode.name == "SMART_RTL" and (path is None or path.lost or not path.points):
            return f"{failed}init failed"
        if mode.name == "AUTO_RTL" and autopilot.mission.landing_start() is None:
            return f"{failed}init failed"
        return None

    def _is_blocked(self, autopilot: SimulatedAutopilot, mode: Mode) -> bool:
        """Return whether FLTMODE_GCSBLOCK blocks a mode."""
        blocked = int(autopilot.vehicle.parameters.get("FLTMODE_GCSBLOCK", 0))
        numbers = BLOCKABLE.get(self.vehicle_type, ())
        return mode.number in numbers and bool(blocked >> numbers.index(mode.number) & 1)

    def take_off(self, autopilot: SimulatedAutopilot, height: float) -> None:
        """Arm and take off to a height in metres from any mode; other types hold their position."""
        if self.vehicle_type is VehicleType.PLANE:
            autopilot.vehicle.parameters.set("TKOFF_ALT", height)
        autopilot.enter(self.takeoff_mode, "take-off")
        autopilot.arm(force=True)
        if self.vehicle_type in (VehicleType.COPTER, VehicleType.VTOL):
            autopilot.guided.take_off(height)

    # Ground stations

    def may_steer(self, vehicle: SimulatedVehicle, source: Address) -> bool:
        """Return whether a source is the ground station of SYSID_MYGCS."""
        return source.system == int(vehicle.parameters.get("SYSID_MYGCS", 255))

    def is_ground(self, vehicle: SimulatedVehicle, source: Address) -> bool:
        """Return whether a source is the ground station of SYSID_MYGCS."""
        return self.may_steer(vehicle, source)

    # Broadcasts and guided items

    def home_changed(self, vehicle: SimulatedVehicle) -> None:
        """Broadcast HOME_POSITION and GPS_GLOBAL_ORIGIN."""
        message = home_position(vehicle)
        if message is not None:
            vehicle.services.send(message)
            vehicle.services.send(origin_of(vehicle))

    def guided_items(self, vehicle: SimulatedVehicle) -> Callable[[MissionItem, int], int]:
        """Return the handler of guided mission items: `current` = 2, or 3 for the altitude alone."""
        return lambda item, current: guided_item(vehicle, item, altitude_only=current == _ALTITUDE_ONLY)
