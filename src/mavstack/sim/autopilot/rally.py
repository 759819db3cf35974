"""Rally points: return destinations besides home.

ArduPilot returns to the nearest one within RALLY_LIMIT_KM, or home if RALLY_INCL_HOME is set and home is
nearer. PX4 returns to the nearest of them and home.
"""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.frames import GLOBAL_FRAMES
from mavstack.services.mission import PlanReplaced, PlanType
from mavstack.sim.autopilot.item_checks import check_position
from mavstack.sim.autopilot.item_positions import place_of
from mavstack.sim.vehicle_types import Firmware

if TYPE_CHECKING:
    from mavstack.services.mission import MissionItem
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.maneuvers import Point

_RESULT = common.MavMissionResult
_KILOMETRE = 1000.0
_HIGHEST = 83000.0
_TERRAIN = frozenset({common.MavFrame.GLOBAL_TERRAIN_ALT, common.MavFrame.GLOBAL_TERRAIN_ALT_INT})


class RallyPoints:
    """The rally points of one vehicle."""

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        self._autopilot = autopilot
        autopilot.vehicle.on_event(PlanReplaced, self._plan_replaced)

    @property
    def points(self) -> list[Point]:
        """All rally points in local metres."""
        items = self._autopilot.vehicle.plans.get(PlanType.RALLY).items
        return [place_of(self._autopilot, item) for item in items]

    def nearest(self) -> Point | None:
        """Return the nearest rally point at its own altitude; None if home is the destination."""
        maneuvers = self._autopilot.maneuvers
        nearest = min(self.points, key=maneuvers.distance, default=None)
        if nearest is None:
            return None
        away = maneuvers.distance(nearest)
        if away > self._limit or (self._home_counts and maneuvers.distance(self._home) <= away):
            return None
        return nearest

    def destination(self) -> Point:
        """Return the destination of a return: a rally point or home, at the altitude of home."""
        nearest = self.nearest()
        return self._home if nearest is None else (nearest[0], nearest[1], self._home[2])

    @property
    def _home(self) -> Point:
        return self._autopilot.home_position

    @property
    def _limit(self) -> float:
        limit = self._number("RALLY_LIMIT_KM")
        return limit * _KILOMETRE if limit > 0 else inf

    @property
    def _home_counts(self) -> bool:
        if self._autopilot.vehicle.firmware is Firmware.PX4:
            return True
        return self._number("RALLY_INCL_HOME") > 0

    def _number(self, name: str) -> float:
        value = float(self._autopilot.vehicle.parameters.get(name, 0.0))
        return value if abs(value) < inf else 0.0

    def _plan_replaced(self, event: PlanReplaced) -> None:
        vehicle = self._autopilot.vehicle
        if event.plan.type == PlanType.RALLY and event.plan.items and vehicle.firmware is Firmware.ARDUPILOT:
            vehicle.send_statustext("Rally points received")


def check_rally_item(item: MissionItem, firmware: Firmware) -> int:
    """Validate one rally point: MAV_MISSION_RESULT."""
    if item.command != common.MavCmd.NAV_RALLY_POINT:
        return _RESULT.UNSUPPORTED
    frames = GLOBAL_FRAMES - _TERRAIN if firmware is Firmware.PX4 else GLOBAL_FRAMES
    if item.frame not in frames:
        return _RESULT.UNSUPPORTED_FRAME
    return check_position(item, highest=_HIGHEST)
