"""PX4's profile, gathered: its modes, flight parameters, checks, commands, shell, texts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.modes import ModeChanged
from mavstack.services.version import provide_versions
from mavstack.sim.autopilot.interfaces import FirmwareProfile
from mavstack.sim.px4 import modes
from mavstack.sim.px4.arming import LandingWatch, PreflightWatch, problems_of
from mavstack.sim.px4.commands import register_commands
from mavstack.sim.px4.failsafes import Px4Failsafes, setpoints_lost
from mavstack.sim.px4.flight_parameters import Px4FlightParameters, flight_parameters_of
from mavstack.sim.px4.identity import version_of
from mavstack.sim.px4.mode_selection import refusal_of
from mavstack.sim.px4.shell import Console, Journal
from mavstack.sim.px4.state import BY_COMMAND, BY_FAILSAFE, BY_LANDING, Px4State
from mavstack.sim.telemetry import publish_px4

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.interfaces import Autopilot, Mode, Vehicle
    from mavstack.sim.vehicle_types import VehicleType

#: How PX4 calls the reasons for disarming that rooms shared by both firmwares give.
_REASONS = {"commanded": BY_COMMAND, "landed": BY_LANDING, "mission end": BY_LANDING}


class Px4Profile(FirmwareProfile):
    """PX4 on one vehicle."""

    initial = hold = guided = modes.HOLD
    mission = modes.MISSION
    return_to_launch = modes.RETURN
    #: Its simulations have none, and it flies without.
    transmitter = False
    refusal = ""

    def __init__(self, type: VehicleType) -> None:  # noqa: A002 (HEARTBEAT's name for it)
        self.type = type
        self.state = Px4State()
        self.modes = modes.modes_of(type, self.state)
        self.journal = Journal()
        self.land = modes.LAND if type.flies else modes.HOLD

    def flight_parameters(self, vehicle: Vehicle) -> Px4FlightParameters:
        """From the parameters; the limits of the body follow them until the next boot."""
        flight_parameters = flight_parameters_of(vehicle)
        flight_parameters.follow(vehicle.body)
        return flight_parameters

    def arming_problems(self, autopilot: Autopilot) -> Iterator[str]:
        """With "Preflight Fail:", as PX4 says them."""
        return problems_of(autopilot)

    def mode_refusal(self, autopilot: Autopilot, mode: Mode) -> str | None:
        """Why a mode may not be entered now."""
        return refusal_of(autopilot, mode)

    def resting_state(self, autopilot: Autopilot) -> int:
        """STANDBY only while nothing keeps it from being armed."""
        if self.state.calibrating:
            return common.MavState.CALIBRATING
        return common.MavState.STANDBY if self.state.healthy else common.MavState.UNINIT

    def register(self, vehicle: Vehicle) -> None:
        """Commands and watches of a new boot."""
        self.state.forget(self.hold)
        autopilot = vehicle.autopilot
        register_commands(vehicle, self.state)
        vehicle.on_event(ModeChanged, lambda event: self._mode_changed(vehicle, event))
        autopilot.watches.append(PreflightWatch(autopilot, self.state))
        if self.type.flies:
            autopilot.watches.append(LandingWatch(autopilot, self.state))
        Px4Failsafes(autopilot)
        self.journal.begin(vehicle)
        Console(vehicle, self.state, self.journal)

    def provide(self, vehicle: Vehicle) -> None:
        """Streams at PX4's rates, and the versions."""
        publish_px4(vehicle)
        provide_versions(vehicle.messages, version_of(vehicle))

    # What it says

    def armed(self, autopilot: Autopilot) -> None:
        """By whom."""
        autopilot.vehicle.send_statustext(f"Armed by {self.state.arming_reason}")
        self.state.has_flown = False  # it may be armed again before anybody looked at it disarmed
        self.state.arming_reason = BY_COMMAND

    def disarmed(self, autopilot: Autopilot) -> None:
        """By whom; and the mode is again the one that the take-off began in."""
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

    def setpoints_lost(self, autopilot: Autopilot) -> None:
        """By COM_OBL_RC_ACT."""
        setpoints_lost(autopilot)

    def take_off(self, autopilot: Autopilot, height: float) -> None:
        """Take off to a height above the ground, armed or not."""
        if self.type.flies:
            self.state.takeoff_altitude = (
                autopilot.body.frame.altitude - autopilot.maneuvers.place[2] + height
            )
            autopilot.enter(modes.TAKEOFF, "commanded", commanded=True)
        autopilot.arm()

    def _mode_changed(self, vehicle: Vehicle, event: ModeChanged) -> None:
        """Remember where to be after disarming: where one may arm, and does not take off."""
        number = event.mode.custom_mode
        if number == vehicle.modes.intended.custom_mode:
            vehicle.autopilot.failsafes.discard("offboard")  # somebody took over
        mode = vehicle.autopilot.find_mode(number)
        takes_off = number in (modes.TAKEOFF, modes.VTOL_TAKEOFF)
        if mode is not None and mode.may_arm and not takes_off:
            self.state.mode_after_disarming = number
