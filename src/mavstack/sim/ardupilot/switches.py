"""Auxiliary functions of transmitter switches and DO_AUX_FUNCTION."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot


LOW, MIDDLE, HIGH = range(3)
#: Names of the modes that a switch enters at its high position, by the value of RCx_OPTION.
_MODES: Final[Mapping[int, tuple[str, ...]]] = MappingProxyType(
    {
        4: ("RTL",),
        16: ("AUTO", "Auto"),
        18: ("LAND",),
        33: ("BRAKE",),
        42: ("SMARTRTL", "SmartRTL"),
        51: ("MANUAL", "Manual"),
        52: ("ACRO", "Acro"),
        53: ("Steering",),
        54: ("Hold",),
        55: ("GUIDED", "Guided"),
        56: ("LOITER", "Loiter"),
        57: ("FOLLOW",),
        68: ("STABILIZE",),
        69: ("POSHOLD",),
        70: ("ALT_HOLD",),
        72: ("CIRCLE", "Circle"),
        77: ("TAKEOFF",),
        92: ("FLY_BY_WIRE_A", "FBWA"),
        150: ("CRUISE",),
    }
)
_RELAYS: Final[Mapping[int, int]] = MappingProxyType({28: 0, 34: 1, 35: 2, 36: 3, 66: 4, 67: 5})


def use_auxiliary_function(autopilot: SimulatedAutopilot, function: int, position: int) -> bool:
    """Set the switch of a function to a position; return False if the function is unknown."""
    if function in _MODES:
        return position != HIGH or _enter(autopilot, _MODES[function])
    if function in _RELAYS:
        return autopilot.payload.set_relay(_RELAYS[function], on=position == HIGH)
    return _use(autopilot, function, position)


def _use(autopilot: SimulatedAutopilot, function: int, position: int) -> bool:
    """Execute a function that is no mode and no relay."""
    payload, on = autopilot.payload, position == HIGH
    match function:
        case 9:
            if on:
                payload.take_image()
        case 11:
            autopilot.vehicle.parameters.set("FENCE_ENABLE", int(on))
        case 19:
            payload.grip(closed=on)
        case 31:
            if on:
                autopilot.disarm("motors stopped")
        case 65:
            autopilot.body.fail_gps(on)
        case 153:
            return _arm(autopilot, on=on)
        case _:
            return False
    return True


def _arm(autopilot: SimulatedAutopilot, *, on: bool) -> bool:
    """Arm or disarm."""
    if not on:
        autopilot.disarm("switch")
        return True
    problems = autopilot.arm()
    for problem in problems:
        autopilot.vehicle.send_statustext(problem)
    return not problems


def _enter(autopilot: SimulatedAutopilot, names: tuple[str, ...]) -> bool:
    """Enter the first mode with one of the names."""
    for mode in autopilot.profile.modes:
        if mode.name in names:
            return autopilot.profile.mode_refusal(autopilot, mode) is None and autopilot.enter(
                mode.number, "switch"
            )
    return False
