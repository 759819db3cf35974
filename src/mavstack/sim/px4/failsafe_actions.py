"""What PX4's failsafes do, as its parameters choose it, and how urgent each action is.

Of all actions that are wanted at a time the most urgent one is done. An action ends with what it was for, or
stays until somebody chooses another mode, or for ever.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, IntEnum
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.sim.px4 import modes

if TYPE_CHECKING:
    from collections.abc import Mapping


class Act(IntEnum):
    """Actions, each more urgent than those before."""

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


class Until(Enum):
    """How long an action lasts."""

    CONDITION_CLEARS = "condition clears"
    MODE_CHANGES = "mode changes"
    FOR_EVER = "for ever"


@dataclass(slots=True)
class Wanted:
    """An action that one of the checks wants; `delayed` if a pilot has time to take over before."""

    act: Act
    cause: str = ""
    until: Until = Until.CONDITION_CLEARS
    delayed: bool = True
    #: Whether a pilot may choose another mode meanwhile.
    takeover: bool = True
    #: Whether what it is for is still so.
    failing: bool = True


#: As PX4's events call the actions.
WORDS: Final[Mapping[Act, str]] = MappingProxyType(
    {
        Act.POSITION: "Position mode",
        Act.ALTITUDE: "Altitude mode",
        Act.STABILIZED: "Stabilized mode",
        Act.HOLD: "Hold",
        Act.RETURN: "RTL",
        Act.LAND: "Land",
        Act.DESCEND: "Descend",
        Act.DISARM: "disarm",
        Act.TERMINATE: "terminate",
    }
)
#: What is said when no more is done about it.
WARNINGS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "Low battery level": "Low battery level, return advised",
        "Critical battery level": "Critical battery level, land now",
        "Emergency battery level": "Emergency battery level, land immediately",
    }
)
#: The modes that a pilot's sticks take over, most wanted first, and those that need nobody.
BY_HAND: Final = (Act.POSITION, Act.ALTITUDE, Act.STABILIZED)
BY_ITSELF: Final = (Act.HOLD, Act.RETURN, Act.LAND, Act.DESCEND)
MODES: Final[Mapping[Act, int]] = MappingProxyType(
    {
        Act.POSITION: modes.POSITION,
        Act.ALTITUDE: modes.ALTITUDE,
        Act.STABILIZED: modes.STABILIZED,
        Act.HOLD: modes.HOLD,
        Act.RETURN: modes.RETURN,
        Act.LAND: modes.LAND,
        Act.DESCEND: modes.DESCEND,
    }
)

_OF_LINKS: Final = MappingProxyType(
    {1: Act.HOLD, 2: Act.RETURN, 3: Act.LAND, 5: Act.TERMINATE, 6: Act.DISARM}
)
_OF_MOTORS: Final = MappingProxyType({1: Act.HOLD, 2: Act.LAND, 3: Act.RETURN, 4: Act.TERMINATE})
#: COM_LOW_BAT_ACT, for critical and for emergency.
_OF_BATTERIES: Final = (
    MappingProxyType({1: Act.RETURN, 2: Act.LAND, 3: Act.RETURN, 4: Act.RETURN}),
    MappingProxyType({1: Act.RETURN, 2: Act.LAND, 3: Act.LAND, 4: Act.TERMINATE}),
)
CAUSES_OF_BATTERIES: Final = ("", *WARNINGS)
LOW, CRITICAL, EMERGENCY = 1, 2, 3


def link_loss(value: int, cause: str) -> Wanted:
    """NAV_RCL_ACT, NAV_DLL_ACT."""
    act = _OF_LINKS.get(value, Act.NONE)
    if act is Act.TERMINATE:
        return Wanted(act, cause, Until.FOR_EVER, takeover=False)
    if act is Act.DISARM:
        return Wanted(act, cause, takeover=False)
    return Wanted(act, cause, Until.MODE_CHANGES)


def battery(value: int, warning: int) -> Wanted:
    """COM_LOW_BAT_ACT, by how low it is."""
    act = Act.WARN if warning == LOW else _OF_BATTERIES[warning - CRITICAL].get(value, Act.WARN)
    return Wanted(act, CAUSES_OF_BATTERIES[warning])


def motor_failure(value: int) -> Wanted:
    """COM_ACT_FAIL_ACT."""
    act = _OF_MOTORS.get(value, Act.WARN)
    lasting = {Act.LAND: Until.MODE_CHANGES, Act.RETURN: Until.MODE_CHANGES, Act.TERMINATE: Until.FOR_EVER}
    return Wanted(act, until=lasting.get(act, Until.CONDITION_CLEARS))
