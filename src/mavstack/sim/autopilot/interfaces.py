"""The autopilot and the vehicle as everything around them sees them, and the profile of a firmware.

Behaviours, commands, missions, failsafes, firmware profiles and telemetry depend on these interfaces alone;
`SimulatedAutopilot` (`autopilot.py`) and `SimulatedVehicle` (`sim/vehicle.py`) implement them.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from mavstack.dialects import common
from mavstack.sim.autopilot.state import AutopilotState, VehicleState

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from mavstack.services import Address
    from mavstack.services.mission import MissionItem
    from mavstack.services.modes import AvailableMode
    from mavstack.services.version import FirmwareVersion
    from mavstack.sim.autopilot.control import FenceControl, GuidedControl, MissionControl, RunningBehaviour
    from mavstack.sim.autopilot.flight_parameters import FlightParameters
    from mavstack.sim.autopilot.payload import Payload
    from mavstack.sim.autopilot.radio import RadioControl
    from mavstack.sim.autopilot.rally import RallyPoints
    from mavstack.sim.autopilot.tasks import Tasks
    from mavstack.sim.storage import Storage

_FLAGS = common.MavModeFlag


class Vehicle(VehicleState, Protocol):
    """One simulated vehicle with its autopilot."""

    @property
    def autopilot(self) -> Autopilot:
        """The autopilot that flies the vehicle."""

    @property
    def profile(self) -> FirmwareProfile:
        """The firmware profile of the vehicle."""

    @property
    def storage(self) -> Storage:
        """The vehicle's files and logs."""

    def add_listener(self, listener: Callable[[Vehicle, str, str], None]) -> None:
        """Call `listener(vehicle, kind, text)` on each text, mode change and arming."""

    def mode_entered(self, mode: Mode, reason: str) -> None:
        """Publish that the autopilot entered a mode."""

    def announce(self, kind: str, text: str) -> None:
        """Tell the listeners of an event of a payload."""


class Autopilot(AutopilotState, Protocol):
    """One autopilot: its state, its mode and its parts."""

    payload: Payload
    radio: RadioControl
    rally: RallyPoints
    tasks: Tasks
    mode: Mode

    @property
    def vehicle(self) -> Vehicle:
        """The vehicle of the autopilot."""

    @property
    def profile(self) -> FirmwareProfile:
        """The firmware profile."""

    @property
    def behaviour(self) -> RunningBehaviour | None:
        """The behaviour of the current mode; None while disarmed."""

    @property
    def guided(self) -> GuidedControl:
        """Guided flight."""

    @property
    def mission(self) -> MissionControl:
        """The mission."""

    @property
    def fence(self) -> FenceControl:
        """The fence."""

    def find_mode(self, number: int) -> Mode | None:
        """Return the mode of a `custom_mode`; None if the firmware has none of that number."""

    def may_enter(self, available: AvailableMode, source: Address) -> str | None:
        """Return why a mode cannot be entered now; None if it can."""

    def entered(self, number: int, source: Address | None) -> None:
        """Begin a mode that was changed through the mode service."""


@dataclass(frozen=True, slots=True)
class Mode:
    """A flight mode of a firmware: its number and name, its requirements, its behaviour and its successor."""

    available: AvailableMode
    behaviour: Callable[[Autopilot], RunningBehaviour]
    #: HEARTBEAT's `base_mode` without the armed and custom bits.
    flags: int = _FLAGS.STABILIZE_ENABLED
    needs_position: bool = True
    #: True if the pilot's sticks fly the mode, so that it cannot continue without them.
    manual_control: bool = False
    #: True if the vehicle may be armed in the mode.
    may_arm: bool = True
    #: The `custom_mode` that follows when the behaviour ends; None: the mode stays.
    then: int | None = None
    #: The mode's name, where AVAILABLE_MODES has none because it is a standard mode.
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
    #: All modes, in the order in which they are listed.
    modes: Sequence[Mode]
    #: `custom_mode` of the modes that behaviours and failsafes enter by their purpose.
    initial: int
    hold: int
    guided: int
    mission: int
    return_to_launch: int
    land: int
    #: True if the vehicle has a radio-control transmitter.
    transmitter = True
    #: True if GLOBAL_POSITION_INT holds the altitude above the sea in place of the one above home.
    reports_no_height = False
    #: The text in front of the reason why a mode cannot be entered.
    refusal = "Mode refused: "

    @abstractmethod
    def flight_parameters(self, vehicle: Vehicle) -> FlightParameters:
        """Return the flight parameters of a vehicle."""

    def mav_type(self, vehicle: Vehicle) -> int:
        """Return the MAV_TYPE in HEARTBEAT."""
        return vehicle.vehicle_type.mav_type

    @abstractmethod
    def arming_problems(self, autopilot: Autopilot) -> Iterator[str]:
        """Yield the firmware's texts of why the vehicle cannot be armed now."""

    def prearm_problems(self, autopilot: Autopilot) -> Iterator[str]:
        """Yield the findings of the firmware's own checks before arming is commanded."""
        return self.arming_problems(autopilot)

    @abstractmethod
    def register(self, vehicle: Vehicle) -> None:
        """Register the firmware's commands and watches."""

    @abstractmethod
    def provide(self, vehicle: Vehicle) -> None:
        """Register the firmware's telemetry messages with their default rates."""

    def resting_state(self, autopilot: Autopilot) -> int:
        """Return the MAV_STATE of a disarmed vehicle."""
        return common.MavState.STANDBY if autopilot.booted else common.MavState.BOOT

    def armed_state(self, autopilot: Autopilot) -> int:
        """Return the MAV_STATE of an armed vehicle without a failsafe."""
        del autopilot
        return common.MavState.ACTIVE

    def reports_armed(self, autopilot: Autopilot) -> bool:
        """Return whether HEARTBEAT says that the vehicle is armed."""
        return autopilot.armed

    def mode_refusal(self, autopilot: Autopilot, mode: Mode) -> str | None:
        """Return the firmware's text of why a mode cannot be entered now; None if it can."""
        if mode.needs_position and not autopilot.has_position and autopilot.armed:
            return f"{mode.name} requires position"
        return None

    def armed(self, autopilot: Autopilot) -> None:  # noqa: B027 (optional)
        """Send the firmware's texts after arming."""

    def disarmed(self, autopilot: Autopilot) -> None:  # noqa: B027 (optional)
        """Send the firmware's texts after disarming."""

    def booted(self, vehicle: Vehicle) -> None:  # noqa: B027 (optional)
        """Send the firmware's texts after boot."""

    def sent_text(self, text: str) -> str:
        """Return a status text as the firmware sends it."""
        return text

    def home_changed(self, vehicle: Vehicle) -> None:  # noqa: B027 (optional)
        """Send the firmware's messages after a change of home."""

    def guided_items(self, vehicle: Vehicle) -> Callable[[MissionItem, int], int] | None:
        """Return the handler of single guided mission items; None if the firmware has none."""
        return None

    def is_ground(self, vehicle: Vehicle, source: Address) -> bool:
        """Return whether the silence of this ground station triggers the failsafe."""
        return True

    def may_steer(self, vehicle: Vehicle, source: Address) -> bool:
        """Return whether the sticks and channels of a source are accepted."""
        return True

    def setpoints_lost(self, autopilot: Autopilot) -> None:
        """React to the end of the stream of setpoints that a mode follows."""
        autopilot.enter(self.hold, "setpoints lost")
