"""What PX4 does when the setpoints of Offboard cease: COM_OBL_RC_ACT.

The pilot's modes need a pilot. Without one, what they stand for is tried in turn: return, land, or straight
down.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.sim.px4.modes import ALTITUDE, DESCEND, HOLD, LAND, POSITION, RETURN, STABILIZED

if TYPE_CHECKING:
    from mavstack.sim.autopilot.interfaces import Autopilot

_CRITICAL = common.MavSeverity.CRITICAL
#: Why such a mode was entered.
SETPOINTS_LOST: Final = "offboard failsafe"
_TERMINATE, _DISARM = 6, 7
_ACTIONS: Final = MappingProxyType({0: POSITION, 1: ALTITUDE, 2: STABILIZED, 3: RETURN, 4: LAND, 5: HOLD})
_FALLBACKS: Final = (RETURN, LAND, DESCEND, HOLD)


def setpoints_lost(autopilot: Autopilot) -> None:
    """Do it, and say so."""
    autopilot.vehicle.send_statustext("Failsafe activated", _CRITICAL)
    autopilot.failsafes.add("offboard")
    action = int(autopilot.vehicle.parameters["COM_OBL_RC_ACT"])
    if action == _TERMINATE:
        autopilot.terminate()
    elif action == _DISARM:
        autopilot.disarm("failsafe")
    else:
        _enter_first(autopilot, _ACTIONS.get(action, POSITION))


def _enter_first(autopilot: Autopilot, wanted: int) -> None:
    for number in (wanted, *_FALLBACKS):
        mode = autopilot.find_mode(number)
        if mode is None or (mode.manual_control and not autopilot.radio.present):
            continue
        if autopilot.enter(number, SETPOINTS_LOST):
            return
