"""Arming and disarming as PX4 does it, whoever wants it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.sim.px4.checks import REFUSED
from mavstack.sim.px4.modes import LAND, ORBIT, RETURN, TAKEOFF
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from mavstack.sim.autopilot.interfaces import Vehicle
    from mavstack.sim.px4.state import Px4State

_CRITICAL = common.MavSeverity.CRITICAL
#: A VTOL does not go over to its wing in these.
_HOVERING_MODES: Final = frozenset({TAKEOFF, LAND, RETURN, ORBIT})
NOT_LANDED: Final = "Disarming denied: not landed"


def arm(vehicle: Vehicle, state: Px4State, reason: str, *, force: bool = False) -> bool:
    """Arm, or say why not; whether it is armed."""
    if state.calibrating:
        vehicle.send_statustext("Arming denied: calibrating", _CRITICAL)
        return False
    state.arming_reason = reason
    problems = vehicle.autopilot.arm(force=force)
    for problem in problems:
        vehicle.send_statustext(problem, _CRITICAL)
    if problems:
        vehicle.send_statustext(REFUSED, _CRITICAL)
    return not problems


def disarm(vehicle: Vehicle, state: Px4State, reason: str, *, force: bool = False) -> bool:
    """Disarm, in the air only if it is forced, or say why not; whether it is disarmed."""
    autopilot = vehicle.autopilot
    if autopilot.armed and not force and vehicle.type.flies and not autopilot.landed:
        vehicle.send_statustext(NOT_LANDED, _CRITICAL)
        return False
    state.disarming_reason = reason
    autopilot.disarm("commanded")
    state.disarming_reason = None
    return True


def change_over(vehicle: Vehicle, forward: bool) -> bool:
    """Have a VTOL fly on its wing or hover, in the air; whether it may now."""
    autopilot = vehicle.autopilot
    denied = forward and autopilot.mode.number in _HOVERING_MODES
    if vehicle.type is not VehicleType.VTOL or denied or not autopilot.armed or autopilot.landed:
        return False
    autopilot.body.transition_to(forward)
    if autopilot.mission.flying:
        autopilot.mission.keep_course()
    else:
        autopilot.restart_behaviour()
    return True
