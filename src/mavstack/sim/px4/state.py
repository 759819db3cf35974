"""What one PX4 remembers from one command to the next; forgotten when it boots."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from mavstack.sim.px4.orbit import WantedOrbit

#: Why the motors were armed or disarmed, as STATUSTEXT says it.
BY_COMMAND: Final = "external command"
BY_SHELL: Final = "internal command"
BY_MISSION: Final = "mission start"
BY_LANDING: Final = "landing"
BY_INACTION: Final = "auto preflight disarming"
BY_FAILSAFE: Final = "failsafe"
BY_STICKS: Final = "stick gesture"


@dataclass(slots=True)
class Px4State:
    """Shared by the commands, the modes and the watches of one vehicle."""

    #: Where the next take-off goes, in metres above mean sea level; None or NaN: by MIS_TAKEOFF_ALT.
    takeoff_altitude: float | None = None
    #: The circle of the last DO_ORBIT.
    orbit: WantedOrbit | None = None
    #: Whether it left the ground since it was armed.
    has_flown: bool = False
    #: The mode to be in when the motors are disarmed.
    mode_after_disarming: int = 0
    arming_reason: str = BY_COMMAND
    disarming_reason: str | None = None
    #: Whether it could be armed in some mode.
    healthy: bool = False
    #: A calibration that is under way, "" if none is.
    calibrating: str = ""

    def forget(self, mode: int) -> None:
        """Begin anew, in a mode."""
        self.takeoff_altitude = self.orbit = None
        self.has_flown = False
        self.mode_after_disarming = mode
        self.arming_reason, self.disarming_reason = BY_COMMAND, None
        self.calibrating = ""
        self.healthy = False
