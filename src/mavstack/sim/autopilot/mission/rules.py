"""What distinguishes one firmware's missions from the other's, gathered in one place for each.

The runner and the scripts of the items are the same for both. Rules say which items an upload may hold, where
a mission begins, what is said on the way, and what happens at its end.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from math import isfinite, isinf, isnan
from typing import TYPE_CHECKING

from mavstack.dialects import common

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.services.mission import MissionItem
    from mavstack.sim.autopilot.autopilot import Autopilot
    from mavstack.sim.autopilot.mission.runner import MissionRunner
    from mavstack.sim.autopilot.mission.step import Step

_RESULT = common.MavMissionResult


class MissionRules(ABC):
    """One firmware's missions on one vehicle."""

    #: The first item that is flown.
    first: int
    #: Whether items that only do something run beside the next one that navigates, or before it.
    actions_meanwhile: bool
    #: Whether an altitude of 0 above home means the altitude of now.
    zero_altitude_is_here: bool
    #: Whether a VTOL flies waypoints as a wing unless it was told to hover.
    waypoints_fly_forward: bool

    def __init__(self, autopilot: Autopilot) -> None:
        self.autopilot = autopilot
        self.vehicle = autopilot.vehicle

    @property
    def grounded(self) -> bool:
        """Whether it is one that flies, and stands on the ground."""
        return self.vehicle.type.flies and self.autopilot.landed

    @property
    def restarts(self) -> bool:
        """Whether a mission that is entered anew begins at its beginning."""
        return False

    # Uploads

    @abstractmethod
    def check(self, item: MissionItem) -> int:
        """Judge an item: MAV_MISSION_RESULT."""

    def may_replace(self, *, flying: bool, empty: bool) -> int:
        """Judge replacing the mission: MAV_MISSION_RESULT."""
        return _RESULT.ACCEPTED

    def replaced(self, mission: MissionRunner, was: int) -> None:  # noqa: B027 (not every firmware has something to say)
        """There is another mission; `was`: the current item before."""

    def problem(self, mission: MissionRunner) -> str | None:
        """Why the mission cannot be flown at all; None if it can, or if there is none."""
        return None

    def valid(self, mission: MissionRunner) -> bool:
        """Whether there is a mission that can be flown."""
        return mission.exists and self.problem(mission) is None

    # Flying

    @abstractmethod
    def navigates(self, item: MissionItem) -> bool:
        """Whether an item ends a leg."""

    @abstractmethod
    def refusal(self, mission: MissionRunner) -> str | None:
        """Why the mission may not be flown now; None if it may."""

    def began(self, mission: MissionRunner) -> None:  # noqa: B027 (not every firmware has something to say)
        """The mission is flown from now on: say so."""

    def started(self, step: Step) -> None:  # noqa: B027 (not every firmware has something to say)
        """An item was begun: say so."""

    def arrived(self, step: Step, hold: float) -> None:  # noqa: B027 (not every firmware has something to say)
        """A waypoint was reached, before its hold time: say so."""

    def waited(self, step: Step) -> None:  # noqa: B027 (not every firmware has something to say)
        """The hold time of a waypoint is over: say so."""

    def reports(self, item: MissionItem) -> bool:
        """Whether the end of an item is told by MISSION_ITEM_REACHED."""
        return True

    def reported(self, mission: MissionRunner, seq: int) -> None:  # noqa: B027 (not every firmware says it again)
        """An item was told to be reached."""

    def go_home(self, step: Step) -> Iterator[None]:
        """Change over to the mode that returns."""
        return step.mission.leave(self.autopilot.profile.return_to_launch, reason="mission item")

    @property
    def returns_in_mode(self) -> bool:
        """Whether NAV_RETURN_TO_LAUNCH changes the mode, rather than being flown as an item."""
        return True

    @property
    def wing_stays_landed(self) -> bool:
        """Whether a plane's landing never ends, but for its disarming."""
        return False

    @property
    def takeoff_goes_there(self) -> bool:
        """Whether a take-off is followed by the way to its item's place."""
        return False

    @property
    def hold_counts(self) -> bool:
        """Whether waypoints have a hold time."""
        return True

    @property
    def yaw_counts(self) -> bool:
        """Whether items have a heading of their own in param 4."""
        return False

    @property
    def passes_by(self) -> bool:
        """Whether a waypoint may be passed by the distance of param 3."""
        return False

    @property
    def radius_counts(self) -> bool:
        """Whether waypoints have an acceptance radius of their own."""
        return True

    @abstractmethod
    def finish(self, mission: MissionRunner) -> Iterator[None]:
        """What follows the last item."""


def bad_number(item: MissionItem, *, may_be_nan: frozenset[int] = frozenset()) -> int:
    """Which of params 1 to 4 is infinite, or NaN where it may not be, as MAV_MISSION_RESULT."""
    for index in range(1, 5):
        value: float = getattr(item, f"param{index}")
        if isinf(value) or (isnan(value) and index not in may_be_nan):
            return int(_RESULT.INVALID_PARAM1) + index - 1
    return _RESULT.ACCEPTED


def bad_place(item: MissionItem, *, highest: float, may_be_left_out: bool = False) -> int:
    """Which of params 5 to 7 is no place on Earth, as MAV_MISSION_RESULT."""
    limits = ((item.param5, 90.0, _RESULT.INVALID_PARAM5_X), (item.param6, 180.0, _RESULT.INVALID_PARAM6_Y))
    for value, limit, result in limits:
        if not abs(value) <= limit and not (may_be_left_out and isnan(value)):
            return result
    if (isfinite(item.param7) and abs(item.param7) < highest) or (may_be_left_out and isnan(item.param7)):
        return _RESULT.ACCEPTED
    return _RESULT.INVALID_PARAM7
