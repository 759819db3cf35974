"""PX4's firmware profile: modes, flight parameters, checks, commands, shell, status texts."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.services.component_metadata import provide_component_metadata
from mavstack.services.modes import ModeChanged
from mavstack.services.statustext import EVENT_MARK
from mavstack.services.version import provide_versions
from mavstack.sim.autopilot.avoidance import LimitedVelocity
from mavstack.sim.autopilot.external_range import ExternalRange
from mavstack.sim.autopilot.firmware_profile import FirmwareProfile
from mavstack.sim.autopilot.obstacle_input import ObstacleInput
from mavstack.sim.autopilot.origin import OriginReceiver
from mavstack.sim.parameters import served_metadata
from mavstack.sim.px4 import modes
from mavstack.sim.px4.arming import LandDetector, PreflightReporter, preflight_problems
from mavstack.sim.px4.collision_prevention import collision_margin
from mavstack.sim.px4.commands import register_commands
from mavstack.sim.px4.events import EventReporter, find_event
from mavstack.sim.px4.external_gps import register_external_gps
from mavstack.sim.px4.external_vision import register_external_vision
from mavstack.sim.px4.failsafes import Px4Failsafes, setpoints_lost
from mavstack.sim.px4.flight_parameters import Px4FlightParameters, flight_parameters_of
from mavstack.sim.px4.follow import register_follow
from mavstack.sim.px4.identity import VERSION, version_of
from mavstack.sim.px4.log_streaming import LogStreaming
from mavstack.sim.px4.mode_selection import mode_refusal_of
from mavstack.sim.px4.precision_landing import register_precision_landing
from mavstack.sim.px4.shell import Console, MessageLog
from mavstack.sim.px4.state import BY_COMMAND, BY_FAILSAFE, BY_LANDING, Px4State
from mavstack.sim.px4.traffic_avoidance import TrafficAvoidance
from mavstack.sim.px4.transponder import TransponderLink
from mavstack.sim.telemetry import HighLatency, publish_px4
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.firmware_profile import Mode
    from mavstack.sim.vehicle import SimulatedVehicle

#: Seconds that a distance of a companion computer counts, before that of the vehicle's own sensor again.
_RANGE_TIMEOUT: Final = 0.5
#: PX4's texts for the reasons of disarming that the autopilot base class uses.
_REASONS = {"commanded": BY_COMMAND, "landed": BY_LANDING, "mission end": BY_LANDING}


class Px4Profile(FirmwareProfile):
    """PX4 on one vehicle."""

    version = VERSION
    initial = hold = guided = modes.HOLD
    mission = modes.MISSION
    return_to_launch = modes.RETURN
    #: False, because PX4's simulators have no transmitter and permit flights without one.
    transmitter = False
    refusal = ""

    def __init__(self, vehicle_type: VehicleType) -> None:
        self.vehicle_type = vehicle_type
        self.state = Px4State()
        self.modes = modes.modes_of(vehicle_type, self.state)
        self.message_log = MessageLog()
        self.event_reporter = EventReporter()
        self.land = modes.LAND if vehicle_type.flies else modes.HOLD

    def flight_parameters(self, vehicle: SimulatedVehicle) -> Px4FlightParameters:
        """Return the flight parameters; the limits of the body follow them until the next boot."""
        flight_parameters = flight_parameters_of(vehicle)
        flight_parameters.apply_limits(vehicle.body)
        return flight_parameters

    def arming_problems(self, autopilot: SimulatedAutopilot) -> Iterator[str]:
        """Yield problems that prevent arming, as PX4 reports them."""
        return preflight_problems(autopilot)

    def mode_refusal(self, autopilot: SimulatedAutopilot, mode: Mode) -> str | None:
        """Return why a mode may not be entered now; None if it may."""
        return mode_refusal_of(autopilot, mode)

    def resting_state(self, autopilot: SimulatedAutopilot) -> int:
        """Return the MAV_STATE while disarmed: STANDBY only if nothing prevents arming."""
        if self.state.calibrating:
            return common.MavState.CALIBRATING
        return common.MavState.STANDBY if self.state.healthy else common.MavState.UNINIT

    def register(self, vehicle: SimulatedVehicle) -> None:
        """Register commands and periodic checks of a new boot."""
        self.state.reset(self.hold)
        autopilot = vehicle.autopilot
        register_commands(vehicle, self.state)
        vehicle.on_event(ModeChanged, lambda event: self._mode_changed(vehicle, event))
        autopilot.watches.append(PreflightReporter(autopilot, self.state))
        if self.vehicle_type.flies:
            autopilot.watches.append(LandDetector(autopilot, self.state))
        Px4Failsafes(autopilot)
        if self.vehicle_type is VehicleType.COPTER:
            autopilot.obstacle_input = vehicle.engine.add(ObstacleInput(vehicle))
            LimitedVelocity(autopilot, partial(collision_margin, autopilot))
        TrafficAvoidance(autopilot)
        register_external_gps(vehicle)
        vehicle.engine.add(ExternalRange(vehicle, timeout=_RANGE_TIMEOUT, fallback=None))
        vehicle.body.wind_report = None
        register_external_vision(vehicle)
        OriginReceiver.add_to(vehicle)
        autopilot.watches.append(LogStreaming(vehicle))
        register_follow(vehicle)
        register_precision_landing(vehicle)
        TransponderLink(vehicle)
        self.message_log.start(vehicle)
        self.event_reporter.start(vehicle)
        Console(vehicle, self.state, self.message_log)

    def provide(self, vehicle: SimulatedVehicle) -> None:
        """Publish PX4's streams, the versions and the metadata."""
        publish_px4(vehicle)
        provide_component_metadata(
            vehicle.messages,
            lambda: served_metadata(vehicle.firmware, self.vehicle_type),
            lambda: vehicle.uptime,
        )
        provide_versions(vehicle.messages, version_of(vehicle))
        HighLatency(vehicle)

    # Status texts

    def sent_text(self, text: str) -> str:
        """Return a status text with a tab at its end if an event is sent beside it."""
        return text if find_event(text) is None else f"{text}{EVENT_MARK}"

    def armed(self, autopilot: SimulatedAutopilot) -> None:
        """Report by whom the vehicle was armed."""
        autopilot.vehicle.send_statustext(f"Armed by {self.state.arming_reason}")
        # The periodic check also clears this flag, but may not run between two armings.
        self.state.has_flown = False
        self.state.arming_reason = BY_COMMAND

    def disarmed(self, autopilot: SimulatedAutopilot) -> None:
        """Report by whom the vehicle was disarmed, and restore the mode from before take-off."""
        reason = self.state.disarming_reason or _REASONS.get(autopilot.disarm_reason, BY_FAILSAFE)
        self.state.disarming_reason = None
        autopilot.failsafes.discard("offboard")
        if autopilot.terminated:
            autopilot.vehicle.send_statustext("Failsafe activated", common.MavSeverity.CRITICAL)
            autopilot.enter(modes.TERMINATION, "terminated")
            return
        autopilot.vehicle.send_statustext(f"Disarmed by {reason}")
        if autopilot.mode.number != self.state.mode_after_disarming:
            autopilot.enter(self.state.mode_after_disarming, "disarmed")

    def setpoints_lost(self, autopilot: SimulatedAutopilot) -> None:
        """Execute COM_OBL_RC_ACT."""
        setpoints_lost(autopilot)

    def take_off(self, autopilot: SimulatedAutopilot, height: float) -> None:
        """Take off to a height above the ground in metres, armed or not."""
        if self.vehicle_type.flies:
            self.state.takeoff_altitude = (
                autopilot.body.frame.altitude - autopilot.maneuvers.place[2] + height
            )
            autopilot.enter(modes.TAKEOFF, "commanded", commanded=True)
        autopilot.arm()

    def _mode_changed(self, vehicle: SimulatedVehicle, event: ModeChanged) -> None:
        """Store the mode to restore after disarming: one that allows arming and is no take-off."""
        number = event.mode.custom_mode
        if number == vehicle.modes.intended.custom_mode:
            vehicle.autopilot.failsafes.discard("offboard")  # the user selected another mode
        mode = vehicle.autopilot.find_mode(number)
        takes_off = number in (modes.TAKEOFF, modes.VTOL_TAKEOFF)
        if mode is not None and mode.may_arm and not takes_off:
            self.state.mode_after_disarming = number
