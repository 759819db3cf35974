"""The profile of a firmware: its modes and flight parameters, its rules, commands and texts."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING

from mavstack.dialects import common

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from mavstack.services import Address
    from mavstack.services.mission import MissionItem
    from mavstack.services.modes import AvailableMode
    from mavstack.services.version import FirmwareVersion
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.behaviour import Behaviour
    from mavstack.sim.autopilot.flight_parameters import FlightParameters
    from mavstack.sim.vehicle import SimulatedVehicle

_FLAGS = common.MavModeFlag


@dataclass(frozen=True, slots=True)
class Mode:
    """A flight mode of a firmware: its number and name, its requirements, its behaviour and its successor."""

    available: AvailableMode
    behaviour: Callable[[SimulatedAutopilot], Behaviour]
    #: The `base_mode` in HEARTBEAT without the flags for armed and for custom mode.
    flags: int = _FLAGS.STABILIZE_ENABLED
    needs_position: bool = True
    #: True if the pilot's sticks fly the vehicle in this mode, so that the mode cannot continue without them.
    manual_control: bool = False
    #: True if the vehicle may be armed in the mode.
    may_arm: bool = True
    #: The `custom_mode` that is entered when the behaviour of this mode ends; None: the mode is not left.
    then: int | None = None
    #: The mode's name for standard modes, which have no name in AVAILABLE_MODES.
    label: str = ""

    @property
    def number(self) -> int:
        """HEARTBEAT's `custom_mode`."""
        return self.available.custom_mode

    @property
    def name(self) -> str:
        """The firmware's name of the mode."""
        return self.label or self.available.name


class FirmwareProfile(ABC):
    """The differences of one firmware on one vehicle type.

    Behaviours, missions and failsafes are shared by all firmwares; a profile defines the modes, the flight
    parameters, the rules of arming and modes, the commands, and the status texts.
    """

    #: The version of the firmware.
    version: FirmwareVersion
    #: All modes, in the order in which AVAILABLE_MODES lists them.
    modes: Sequence[Mode]
    #: `custom_mode` of the modes that behaviours and failsafes enter, named by purpose.
    initial: int
    hold: int
    guided: int
    mission: int
    return_to_launch: int
    land: int
    #: True if the vehicle has a radio-control transmitter by default.
    transmitter = True
    #: True if GLOBAL_POSITION_INT reports the altitude above the sea in `relative_alt`, as ArduRover before
    #: 4.2.
    reports_no_height = False
    #: The beginning of the status text that explains why a mode cannot be entered.
    refusal = "Mode refused: "

    @abstractmethod
    def flight_parameters(self, vehicle: SimulatedVehicle) -> FlightParameters:
        """Return the flight parameters of a vehicle."""

    def mav_type(self, vehicle: SimulatedVehicle) -> int:
        """Return the MAV_TYPE in HEARTBEAT."""
        return vehicle.vehicle_type.mav_type

    @abstractmethod
    def arming_problems(self, autopilot: SimulatedAutopilot) -> Iterator[str]:
        """Yield the firmware's texts of why the vehicle cannot be armed now."""

    def prearm_problems(self, autopilot: SimulatedAutopilot) -> Iterator[str]:
        """Yield the findings of the firmware's own checks before arming is commanded."""
        return self.arming_problems(autopilot)

    @abstractmethod
    def register(self, vehicle: SimulatedVehicle) -> None:
        """Register the firmware's commands and watches."""

    @abstractmethod
    def provide(self, vehicle: SimulatedVehicle) -> None:
        """Register the firmware's telemetry messages with their default rates."""

    def resting_state(self, autopilot: SimulatedAutopilot) -> int:
        """Return the MAV_STATE of a disarmed vehicle."""
        return common.MavState.STANDBY if autopilot.booted else common.MavState.BOOT

    def armed_state(self, autopilot: SimulatedAutopilot) -> int:
        """Return the MAV_STATE of an armed vehicle without a failsafe."""
        del autopilot
        return common.MavState.ACTIVE

    def reports_armed(self, autopilot: SimulatedAutopilot) -> bool:
        """Return whether HEARTBEAT says that the vehicle is armed."""
        return autopilot.armed

    def mode_refusal(self, autopilot: SimulatedAutopilot, mode: Mode) -> str | None:
        """Return the firmware's text of why a mode cannot be entered now; None if it can."""
        if mode.needs_position and not autopilot.has_position and autopilot.armed:
            return f"{mode.name} requires position"
        return None

    def armed(self, autopilot: SimulatedAutopilot) -> None:  # noqa: B027 (optional)
        """Send the firmware's texts after arming."""

    def disarmed(self, autopilot: SimulatedAutopilot) -> None:  # noqa: B027 (optional)
        """Send the firmware's texts after disarming."""

    def booted(self, vehicle: SimulatedVehicle) -> None:  # noqa: B027 (optional)
        """Send the firmware's texts after boot."""

    def sent_text(self, text: str) -> str:
        """Return a status text as the firmware sends it."""
        return text

    def home_changed(self, vehicle: SimulatedVehicle) -> None:  # noqa: B027 (optional)
        """Send the firmware's messages after a change of home."""

    def guided_items(self, vehicle: SimulatedVehicle) -> Callable[[MissionItem, int], int] | None:
        """Return the handler of single guided mission items; None if the firmware has none."""
        return None

    def is_ground(self, vehicle: SimulatedVehicle, source: Address) -> bool:
        """Return whether the silence of this ground station triggers the failsafe."""
        return True

    def may_steer(self, vehicle: SimulatedVehicle, source: Address) -> bool:
        """Return whether the sticks and channels of a source are accepted."""
        return True

    def setpoints_lost(self, autopilot: SimulatedAutopilot) -> None:
        """React to the end of the stream of setpoints that a mode follows."""
        autopilot.enter(self.hold, "setpoints lost")
