"""ArduPilot's avoidance of obstacles that a proximity sensor or a companion computer reports (PRX1_TYPE).

With bit 1 of AVOID_ENABLE, Loiter and velocities in Guided stop AVOID_MARGIN before an obstacle. Flights to a
point (Auto, Guided, RTL) pass through obstacles unless OA_TYPE enables the path planner: a copter stops
before them, a rover or boat moves around them. AVOID_BEHAVE is not simulated: the vehicle stops, it does not
slide along. With PRX1_TYPE 2 at boot OBSTACLE_DISTANCE counts.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega
from mavstack.sim.autopilot.avoidance import LimitedVelocity, PathAround, PathStop
from mavstack.sim.autopilot.obstacle_input import ObstacleInput

if TYPE_CHECKING:
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.vehicle import SimulatedVehicle

_MODE, _ROVER = ardupilotmega.CopterMode, ardupilotmega.RoverMode
_LIMITED: Final = frozenset({int(_MODE.LOITER), int(_MODE.GUIDED)})
_LIMITED_ON_SURFACE: Final = frozenset({int(_ROVER.GUIDED), int(_ROVER.STEERING)})
_PLANNED_ON_SURFACE: Final = frozenset({int(_ROVER.AUTO), int(_ROVER.GUIDED), int(_ROVER.RTL)})
_PLANNED: Final = frozenset({int(_MODE.AUTO), int(_MODE.GUIDED), int(_MODE.RTL)})
#: The bit of AVOID_ENABLE for proximity sensors, and the default of OA_MARGIN_MAX in metres.
_PROXIMITY, _PLANNER_MARGIN = 2, 5.0
#: The default of OA_BR_LOOKAHEAD in metres, and the value of PRX1_TYPE for a sensor that sends
#: OBSTACLE_DISTANCE.
_LOOKAHEAD: Final = 15.0
_BY_MAVLINK: Final = 2


def register_avoidance(vehicle: SimulatedVehicle) -> None:
    """Let a copter, a rover or a boat avoid obstacles, as its parameters say."""
    autopilot, kind = vehicle.autopilot, vehicle.vehicle_type
    if int(vehicle.parameters.get("PRX1_TYPE", 0)) == _BY_MAVLINK:
        autopilot.obstacle_input = vehicle.engine.add(ObstacleInput(vehicle))
    elif not vehicle.proximity:
        return
    if kind.on_surface:
        margin, lookahead = partial(_surface_margin, autopilot), partial(_lookahead, autopilot)
        autopilot.watches.append(PathAround(autopilot, margin, lookahead))
    LimitedVelocity(autopilot, partial(_margin, autopilot))
    if not kind.on_surface:
        autopilot.watches.append(PathStop(autopilot, partial(_planner_margin, autopilot)))


def _surface_margin(autopilot: SimulatedAutopilot) -> float | None:
    """Return OA_MARGIN_MAX of a rover; None if the path planner is off or the mode does not use it."""
    planned = autopilot.mode.number in _PLANNED_ON_SURFACE and _number(autopilot, "OA_TYPE", 0) > 0
    return _number(autopilot, "OA_MARGIN_MAX", _PLANNER_MARGIN) if planned and _senses(autopilot) else None


def _lookahead(autopilot: SimulatedAutopilot) -> float:
    return max(_number(autopilot, "OA_BR_LOOKAHEAD", _LOOKAHEAD), 1.0)


def _margin(autopilot: SimulatedAutopilot) -> float | None:
    """Return AVOID_MARGIN; None if avoidance is off or the mode does not use it."""
    enabled = int(_number(autopilot, "AVOID_ENABLE", 0)) & _PROXIMITY
    modes = _LIMITED_ON_SURFACE if autopilot.vehicle.vehicle_type.on_surface else _LIMITED
    if not enabled or not _senses(autopilot) or autopilot.mode.number not in modes:
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
