"""ArduPilot's avoidance of obstacles on a copter with a proximity sensor (PRX1_TYPE).

With bit 1 of AVOID_ENABLE, Loiter and velocities in Guided stop AVOID_MARGIN before an obstacle. Flights to a
point (Auto, Guided, RTL) pass through obstacles unless OA_TYPE enables the path planner. AVOID_BEHAVE is not
simulated: the vehicle stops, it does not slide along.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega
from mavstack.sim.autopilot.avoidance import LimitedVelocity, PathStop

if TYPE_CHECKING:
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot

_MODE = ardupilotmega.CopterMode
_LIMITED: Final = frozenset({int(_MODE.LOITER), int(_MODE.GUIDED)})
_PLANNED: Final = frozenset({int(_MODE.AUTO), int(_MODE.GUIDED), int(_MODE.RTL)})
#: The bit of AVOID_ENABLE for proximity sensors, and the default of OA_MARGIN_MAX in metres.
_PROXIMITY, _PLANNER_MARGIN = 2, 5.0


def enable_avoidance(autopilot: SimulatedAutopilot) -> None:
    """Let a copter stop before obstacles, as its parameters say."""
    LimitedVelocity(autopilot, partial(_margin, autopilot))
    autopilot.watches.append(PathStop(autopilot, partial(_planner_margin, autopilot)))


def _margin(autopilot: SimulatedAutopilot) -> float | None:
    """Return AVOID_MARGIN; None if avoidance is off or the mode does not use it."""
    enabled = int(_number(autopilot, "AVOID_ENABLE", 0)) & _PROXIMITY
    if not enabled or not _senses(autopilot) or autopilot.mode.number not in _LIMITED:
        return None
    return max(_number(autopilot, "AVOID_MARGIN", 2.0), 0.0)


def _planner_margin(autopilot: SimulatedAutopilot) -> float | None:
    """Return OA_MARGIN_MAX; None if the path planner is off or the mode does not use it."""
    if not _number(autopilot, "OA_TYPE", 0) > 0 or not _senses(autopilot):
        return None
    if autopilot.mode.number not in _PLANNED:
        return None
    return _number(autopilot, "OA_MARGIN_MAX", _PLANNER_MARGIN)


def _senses(autopilot: SimulatedAutopilot) -> bool:
    return _number(autopilot, "PRX1_TYPE", 0) > 0


def _number(autopilot: SimulatedAutopilot, name: str, default: float) -> float:
    return float(autopilot.vehicle.parameters.get(name, default))
