"""The mission of iNav: the rules by which its waypoints are written and kept.

Waypoints are numbered from 1. A mission is written waypoint by waypoint in this order, and is valid when
the last one has the flag LAST. While the vehicle is armed nothing can be written. `MSP_WP_MISSION_SAVE`
keeps the mission over a reboot.

Source: `navigation.c` of iNav, docs/development/msp of iNav.
"""

from __future__ import annotations

from typing import Final

from mavstack.msp.messages.navigation import LAST_WAYPOINT_FLAG, WaypointAction, Wp

#: Highest number of a waypoint.
MAX_WAYPOINTS: Final = 120
#: Bit of `parameter_3`: the altitude is above mean sea level, not above home.
ABOVE_SEA: Final = 1
#: Waypoint actions that need no position.
WITHOUT_POSITION: Final = frozenset((WaypointAction.RTH, WaypointAction.JUMP, WaypointAction.SET_HEADING))
#: Waypoint actions that iNav rejects.
NOT_TAKEN: Final = frozenset((WaypointAction.NONE, WaypointAction.POSHOLD_UNLIMITED))


class Mission:
    """The waypoints in memory, and those that were saved."""

    def __init__(self, saved: tuple[Wp, ...] = ()) -> None:
        self.waypoints: list[Wp] = []
        self.saved = saved

    @property
    def is_valid(self) -> bool:
        """True if the last waypoint has the flag LAST."""
        return bool(self.waypoints) and self.waypoints[-1].flag == LAST_WAYPOINT_FLAG

    def write(self, waypoint: Wp) -> bool:
        """Write a waypoint: number 1 begins a new mission, others follow the last one.

        Returns:
            True if the waypoint was taken.
        """
        if waypoint.action in NOT_TAKEN:
            return False
        if waypoint.index == 1:
            self.waypoints = []
        if not 1 <= waypoint.index <= MAX_WAYPOINTS or waypoint.index != len(self.waypoints) + 1:
            return False
        self.waypoints.append(waypoint)
        return True

    def read(self, number: int) -> Wp:
        """Return a waypoint of the mission; for other numbers a return to home, as iNav does."""
        if 1 <= number <= len(self.waypoints):
            return self.waypoints[number - 1]
        return Wp(number, WaypointAction.RTH, 0, 0, 0, 0, 0, 0, LAST_WAYPOINT_FLAG)

    def save(self) -> bool:
        """Keep the mission over a reboot; False if there is no valid one."""
        if self.is_valid:
            self.saved = tuple(self.waypoints)
        return self.is_valid

    def load(self) -> bool:
        """Read the saved mission; False if there is none."""
        if self.saved:
            self.waypoints = list(self.saved)
        return bool(self.saved)
