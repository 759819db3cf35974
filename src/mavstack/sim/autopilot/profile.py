"""What distinguishes one firmware's autopilot from the other's, gathered in one place for each.

The behaviours, the mission and the watches are the same for all; a profile says which modes there are and
what each does, which flight parameters and rules the parameters give, which commands it takes, and what it says.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

from mavstack.dialects import common

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from mavstack.services import Address
    from mavstack.services.mission import MissionItem
    from mavstack.sim.autopilot.autopilot import Autopilot
    from mavstack.sim.autopilot.flight_parameters import FlightParameters
    from mavstack.sim.autopilot.mode import Mode
    from mavstack.sim.vehicle import SimulatedVehicle


class FirmwareProfile(ABC):
    """One firmware on one type of vehicle."""

    #: All modes, in the order in which they are listed.
    modes: Sequence[Mode]
    #: `custom_mode` of the modes that behaviours and watches enter by what they mean.
    initial: int
    hold: int
    guided: int
    mission: int
    return_to_launch: int
    land: int
    #: Whether a transmitter comes with the vehicle.
    transmitter = True
    #: What stands before the reason why a mode may not be entered.
    refusal = "Mode refused: "

    @abstractmethod
    def flight_parameters(self, vehicle: SimulatedVehicle) -> FlightParameters:
        """The flight parameters that this vehicle's parameters give."""

    @abstractmethod
    def arming_problems(self, autopilot: Autopilot) -> Iterator[str]:
        """Why the vehicle may not be armed now, as the firmware says it."""

    def prearm_problems(self, autopilot: Autopilot) -> Iterator[str]:
        """What the firmware's own checks find before anybody asks for arming."""
        return self.arming_problems(autopilot)

    @abstractmethod
    def register(self, vehicle: SimulatedVehicle) -> None:
        """Take the commands that the firmware takes, and begin its watches."""

    @abstractmethod
    def provide(self, vehicle: SimulatedVehicle) -> None:
        """Send the messages that the firmware sends, at its default rates."""

    def resting_state(self, autopilot: Autopilot) -> int:
        """MAV_STATE of a vehicle that is disarmed."""
        return common.MavState.STANDBY if autopilot.booted else common.MavState.BOOT

    def take_off(self, autopilot: Autopilot, height: float) -> None:
        """Arm and leave the ground, for who wants a vehicle in the air at once; what cannot fly holds."""
        raise NotImplementedError

    def mode_refusal(self, autopilot: Autopilot, mode: Mode) -> str | None:
        """Why nobody may enter a mode now, as the firmware says it; None if it may be entered."""
        if mode.needs_position and not autopilot.has_position and autopilot.armed:
            return f"{mode.name} requires position"
        return None

    def armed(self, autopilot: Autopilot) -> None:  # noqa: B027 (not every firmware says something)
        """The motors were armed: say what the firmware says."""

    def disarmed(self, autopilot: Autopilot) -> None:  # noqa: B027 (not every firmware says something)
        """The motors were disarmed: say what the firmware says."""

    def booted(self, vehicle: SimulatedVehicle) -> None:  # noqa: B027 (as above)
        """The autopilot has just started: say what the firmware says."""

    def home_changed(self, vehicle: SimulatedVehicle) -> None:  # noqa: B027 (as above)
        """There is another home: say what the firmware says."""

    def guided_items(self, vehicle: SimulatedVehicle) -> Callable[[MissionItem, int], int] | None:
        """What goes where single mission items say; None if the firmware does not know that."""
        return None

    def is_ground(self, vehicle: SimulatedVehicle, source: Address) -> bool:
        """Whether a ground station's silence is one that counts."""
        return True

    def may_steer(self, vehicle: SimulatedVehicle, source: Address) -> bool:
        """Whether the sticks and channels of a source count."""
        return True

    def setpoints_lost(self, autopilot: Autopilot) -> None:
        """The stream of setpoints that a mode follows has starved: do what the firmware does."""
        autopilot.enter(self.hold, "setpoints lost")
