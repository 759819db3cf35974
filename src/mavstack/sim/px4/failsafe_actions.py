"""Actions of PX4's failsafes, as selected by parameters, in order of urgency.

Of all requested actions the most urgent one is executed. A request ends when its condition clears, when the
mode changes, or never.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, IntEnum
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.sim.px4 import modes

if TYPE_CHECKING:
    from collections.abc import Mapping


class Action(IntEnum):
    """Actions in ascending urgency."""

    NONE = 0
    WARN = 1
    POSITION = 2
    ALTITUDE = 3
    STABILIZED = 4
    HOLD = 5
    RETURN = 6
    LAND = 7
    DESCEND = 8
    DISARM = 9
    TERMINATE = 10


class ActionEnd(Enum):
    """When a request ends."""

    CONDITION_CLEARS = "condition clears"
    MODE_CHANGES = "mode changes"
    NEVER = "never"


@dataclass(slots=True)
class ActionRequest:
    """An action that a check requests; `delayed` if a pilot has time to take over first."""

    action: Action
    cause: str = ""
    end: ActionEnd = ActionEnd.CONDITION_CLEARS
    delayed: bool = True
    #: True if the pilot may take control by a mode change.
    takeover: bool = True
    #: True while the condition that triggers the failsafe is present.
    failing: bool = True


#: Names of the actions in status texts and in PX4's events.
ACTION_NAMES: Final[Mapping[Action, str]] = MappingProxyType(
    {
        Action.POSITION: "Position mode",
        Action.ALTITUDE: "Altitude mode",
        Action.STABILIZED: "Stabilized mode",
        Action.HOLD: "Hold",
        Action.RETURN: "RTL",
        Action.LAND: "Land",
        Action.DESCEND: "Descend",
        Action.DISARM: "disarm",
        Action.TERMINATE: "terminate",
    }
)
#: Status texts of failsafes that warn without another action.
WARNINGS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "Low battery level": "Low battery level, return advised",
        "Critical battery level": "Critical battery level, land now",
        "Emergency battery level": "Emergency battery level, land immediately",
    }
)
#: Actions in which the pilot flies, in order of preference, and automatic actions.
MANUAL_ACTIONS: Final = (Action.POSITION, Action.ALTITUDE, Action.STABILIZED)
AUTOMATIC_ACTIONS: Final = (Action.HOLD, Action.RETURN, Action.LAND, Action.DESCEND)
MODES: Final[Mapping[Action, int]] = MappingProxyType(
    {
        Action.POSITION: modes.POSITION,
        Action.ALTITUDE: modes.ALTITUDE,
        Action.STABILIZED: modes.STABILIZED,
        Action.HOLD: modes.HOLD,
        Action.RETURN: modes.RETURN,
        Action.LAND: modes.LAND,
        Action.DESCEND: modes.DESCEND,
    }
)

_LINK_ACTIONS: Final = MappingProxyType(
    {1: Action.HOLD, 2: Action.RETURN, 3: Action.LAND, 5: Action.TERMINATE, 6: Action.DISARM}
)
_MOTOR_ACTIONS: Final = MappingProxyType(
    {1: Action.HOLD, 2: Action.LAND, 3: Action.RETURN, 4: Action.TERMINATE}
)
#: Actions by the value of COM_LOW_BAT_ACT, at the critical and at the emergency level.
_BATTERY_ACTIONS: Final = (
    MappingProxyType({1: Action.RETURN, 2: Action.LAND, 3: Action.RETURN, 4: Action.RETURN}),
    MappingProxyType({1: Action.RETURN, 2: Action.LAND, 3: Action.LAND, 4: Action.TERMINATE}),
)
BATTERY_CAUSES: Final = ("", *WARNINGS)
LOW, CRITICAL, EMERGENCY = 1, 2, 3


def link_loss(value: int, cause: str) -> ActionRequest:
    """Return the request of NAV_RCL_ACT or NAV_DLL_ACT."""
    action = _LINK_ACTIONS.get(value, Action.NONE)
    if action is Action.TERMINATE:
        return ActionRequest(action, cause, ActionEnd.NEVER, takeover=False)
    if action is Action.DISARM:
        return ActionRequest(action, cause, takeover=False)
    return ActionRequest(action, cause, ActionEnd.MODE_CHANGES)


def battery(value: int, warning: int) -> ActionRequest:
    """Return the request of COM_LOW_BAT_ACT for a warning level."""
    action = Action.WARN if warning == LOW else _BATTERY_ACTIONS[warning - CRITICAL].get(value, Action.WARN)
    return ActionRequest(action, BATTERY_CAUSES[warning])


def motor_failure(value: int) -> ActionRequest:
    """Return the request of COM_ACT_FAIL_ACT."""
    action = _MOTOR_ACTIONS.get(value, Action.WARN)
    ends = {
        Action.LAND: ActionEnd.MODE_CHANGES,
        Action.RETURN: ActionEnd.MODE_CHANGES,
        Action.TERMINATE: ActionEnd.NEVER,
    }
    return ActionRequest(action, end=ends.get(action, ActionEnd.CONDITION_CLEARS))
