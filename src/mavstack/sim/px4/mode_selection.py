"""Choosing PX4's modes: which numbers mean which, whether one may be entered now, and what is said if not.

Disarmed, every mode may be chosen; armed, only what can be flown. Land is never refused: without a position
it becomes Descend.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.services.modes.names import px4_custom_mode
from mavstack.sim.px4.modes import (
    DESCEND,
    LAND,
    MANUAL,
    MISSION,
    OFFBOARD,
    POSITION,
    RETURN,
    STABILIZED,
    TERMINATION,
)

if TYPE_CHECKING:
    from mavstack.sim.autopilot.interfaces import Autopilot, Mode, Vehicle

_FLAGS = common.MavModeFlag
#: Main modes that have sub modes.
AUTO: Final = 4
_POSCTL: Final = 3
_SLOW: Final = 2


def unavailable(name: str) -> str:
    """What is said when a mode cannot be entered."""
    return f"Switching to {name} is currently not available"


def refusal_of(autopilot: Autopilot, mode: Mode) -> str | None:
    """Why a mode may not be entered now; None if it may be."""
    return None if _may_enter(autopilot, mode) else unavailable(mode.name)


def choose_mode(vehicle: Vehicle, wanted: int) -> str | None:
    """Enter a mode as somebody wants it; gives what is said if it cannot be."""
    autopilot = vehicle.autopilot
    if wanted == LAND and autopilot.armed and not autopilot.has_position:
        wanted = DESCEND
    mode = autopilot.find_mode(wanted)
    if mode is None:
        return unavailable("that mode")
    refused = refusal_of(autopilot, mode)
    if refused is None and not autopilot.enter(wanted, "commanded", commanded=True):
        refused = unavailable(mode.name)
    return refused


def custom_mode_of(main: int, sub: int) -> int:
    """The `custom_mode` that the two numbers of DO_SET_MODE mean; Orbit is never entered by it."""
    if main == AUTO:
        return MISSION if sub == 0 else px4_custom_mode(main, sub)
    return px4_custom_mode(main, _SLOW if main == _POSCTL and sub == _SLOW else 0)


def mode_of_flags(flags: int) -> int | None:
    """The mode that DO_SET_MODE means by flags alone."""
    if flags & _FLAGS.AUTO_ENABLED:
        return MISSION
    if not flags & _FLAGS.MANUAL_INPUT_ENABLED:
        return None
    if flags & _FLAGS.GUIDED_ENABLED:
        return POSITION
    return STABILIZED if flags & _FLAGS.STABILIZE_ENABLED else MANUAL


def _may_enter(autopilot: Autopilot, mode: Mode) -> bool:
    if autopilot.terminated or autopilot.mode.number == TERMINATION:
        return mode.number == TERMINATION
    if not autopilot.armed:
        return True
    if mode.needs_position and not autopilot.has_position:
        return False
    if mode.manual_control:
        return autopilot.radio.present
    if mode.number == OFFBOARD:
        return autopilot.guided.stream_alive
    if mode.number == MISSION:
        return autopilot.mission.refusal() is None
    return mode.number != RETURN or autopilot.home is not None
