"""Selection of PX4's modes: mode numbers, whether a mode may be entered now, and the texts of a refusal.

While disarmed every mode may be selected; while armed only modes whose requirements hold. Land is never
refused: without a position it becomes Descend.
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
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.firmware_profile import Mode
    from mavstack.sim.vehicle import SimulatedVehicle

_FLAGS = common.MavModeFlag
#: Main modes that have sub modes.
AUTO: Final = 4
_POSCTL: Final = 3
_SLOW: Final = 2


def unavailable_text(name: str) -> str:
    """Return the text of a refused mode."""
    return f"Switching to {name} is currently not available"


def mode_refusal_of(autopilot: SimulatedAutopilot, mode: Mode) -> str | None:
    """Return why a mode may not be entered now; None if it may."""
    return None if _may_enter(autopilot, mode) else unavailable_text(mode.name)


def choose_mode(vehicle: SimulatedVehicle, number: int) -> str | None:
    """Enter a mode on request; return the text of a refusal, or None."""
    autopilot = vehicle.autopilot
    if number == LAND and autopilot.armed and not autopilot.has_position:
        number = DESCEND
    mode = autopilot.find_mode(number)
    if mode is None:
        return unavailable_text("that mode")
    reason = mode_refusal_of(autopilot, mode)
    if reason is None and not autopilot.enter(number, "commanded", commanded=True):
        reason = unavailable_text(mode.name)
    return reason


def custom_mode_of(main: int, sub: int) -> int:
    """Return the `custom_mode` of DO_SET_MODE's two numbers; Orbit cannot be entered this way."""
    if main == AUTO:
        return MISSION if sub == 0 else px4_custom_mode(main, sub)
    return px4_custom_mode(main, _SLOW if main == _POSCTL and sub == _SLOW else 0)


def mode_of_flags(flags: int) -> int | None:
    """Return the mode that DO_SET_MODE selects by flags alone."""
    if flags & _FLAGS.AUTO_ENABLED:
        return MISSION
    if not flags & _FLAGS.MANUAL_INPUT_ENABLED:
        return None
    if flags & _FLAGS.GUIDED_ENABLED:
        return POSITION
    return STABILIZED if flags & _FLAGS.STABILIZE_ENABLED else MANUAL


def _may_enter(autopilot: SimulatedAutopilot, mode: Mode) -> bool:
    """Return whether a mode may be entered now."""
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
