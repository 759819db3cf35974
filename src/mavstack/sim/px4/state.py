"""State that one PX4 keeps between commands; reset at boot."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.sim.autopilot.commands import number, whole

if TYPE_CHECKING:
    from mavstack.services.command import Command
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.maneuvers import Point

_YAW = common.OrbitYawBehaviour
_MIN_RADIUS: Final = 1.0
_MAX_SPEED: Final = 10.0
#: Reasons of arming and disarming, as status texts name them.
BY_COMMAND: Final = "external command"
BY_SHELL: Final = "internal command"
BY_MISSION: Final = "mission start"
BY_LANDING: Final = "landing"
BY_INACTION: Final = "auto preflight disarming"
BY_FAILSAFE: Final = "failsafe"


@dataclass(frozen=True, slots=True)
class OrbitRequest:
    """A circle; a positive radius (m) is clockwise."""

    centre: Point
    radius: float
    speed: float | None
    yaw_behaviour: int

    @classmethod
    def read(cls, autopilot: SimulatedAutopilot, command: Command, centre: Point) -> OrbitRequest:
        """Read DO_ORBIT; defaults replace what the command leaves out."""
        radius, speed = command.param1, abs(number(command.param2))
        if not isfinite(radius) or abs(radius) < _MIN_RADIUS:
            radius = autopilot.flight_parameters.circle_radius
        yaw = whole(command.param3)
        if yaw not in set(_YAW):
            yaw = int(autopilot.vehicle.parameters.get("MC_ORBIT_YAW_MOD", 0))
        return cls(centre, radius, min(speed, _MAX_SPEED) or None, yaw or 0)


@dataclass(slots=True)
class Px4State:
    """State shared by the commands, modes and periodic checks of one vehicle."""

    #: Altitude of the next take-off in metres above mean sea level; None or NaN uses MIS_TAKEOFF_ALT.
    takeoff_altitude: float | None = None
    #: The circle that the last DO_ORBIT requested.
    orbit: OrbitRequest | None = None
    #: True if the vehicle has left the ground since arming.
    has_flown: bool = False
    #: The mode to enter after disarming.
    mode_after_disarming: int = 0
    arming_reason: str = BY_COMMAND
    disarming_reason: str | None = None
    #: True if there is no problem that prevents arming.
    healthy: bool = False
    #: Name of the running calibration; empty if none is running.
    calibrating: str = ""
    #: True after a client has cancelled the running calibration.
    calibration_cancelled: bool = False

    def reset(self, mode: int) -> None:
        """Reset at boot, in a mode."""
        self.takeoff_altitude = self.orbit = None
        self.has_flown = False
        self.mode_after_disarming = mode
        self.arming_reason, self.disarming_reason = BY_COMMAND, None
        self.calibrating, self.calibration_cancelled = "", False
        self.healthy = False
