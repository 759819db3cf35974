"""PX4's mission rules.

Items run one after another, and any item can be the current one. Items without a position must be in the
frame MISSION. A completed mission ends in Hold.
"""

from __future__ import annotations

from math import isnan
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.sim.autopilot.item_checks import check_numbers, check_position
from mavstack.sim.autopilot.item_positions import place_of
from mavstack.sim.autopilot.mission.rules import MissionRules

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.services.mission import MissionItem
    from mavstack.sim.autopilot.mission.rules import Step
    from mavstack.sim.autopilot.mission.runner import MissionRunner

_CMD = common.MavCmd
_F = common.MavFrame
_RESULT = common.MavMissionResult
_SEVERITY = common.MavSeverity

#: Commands that have a position, in a global frame.
_PLACED_NAMES = """
    NAV_WAYPOINT NAV_LOITER_UNLIM NAV_LOITER_TIME NAV_LAND NAV_TAKEOFF NAV_LOITER_TO_ALT NAV_ROI
    DO_SET_ROI DO_SET_ROI_LOCATION NAV_VTOL_TAKEOFF NAV_VTOL_LAND CONDITION_GATE
    """
PLACED = frozenset(getattr(_CMD, name) for name in _PLACED_NAMES.split())
#: Commands that have no position, in MAV_FRAME_MISSION.
_PLACELESS_NAMES = """
    DO_JUMP NAV_ROI DO_SET_ROI DO_WINCH DO_GRIPPER DO_CHANGE_SPEED DO_SET_HOME DO_LAND_START
    DO_TRIGGER_CONTROL DO_DIGICAM_CONTROL DO_MOUNT_CONFIGURE DO_MOUNT_CONTROL DO_GIMBAL_MANAGER_PITCHYAW
    DO_GIMBAL_MANAGER_CONFIGURE SET_CAMERA_FOCUS SET_CAMERA_MODE SET_CAMERA_SOURCE IMAGE_START_CAPTURE
    IMAGE_STOP_CAPTURE VIDEO_START_CAPTURE VIDEO_STOP_CAPTURE DO_CONTROL_VIDEO DO_SET_CAM_TRIGG_DIST
    DO_SET_CAM_TRIGG_INTERVAL OBLIQUE_SURVEY DO_VTOL_TRANSITION NAV_DELAY CONDITION_DELAY
    NAV_RETURN_TO_LAUNCH DO_SET_ROI_WPNEXT_OFFSET DO_SET_ROI_NONE DO_SET_ACTUATOR DO_AUTOTUNE_ENABLE
    COMPONENT_ARM_DISARM
    """
PLACELESS = frozenset(getattr(_CMD, name) for name in _PLACELESS_NAMES.split())
_ALLOWED_ANYWHERE = frozenset({_CMD.COMPONENT_ARM_DISARM, _CMD.DO_AUTOTUNE_ENABLE})
_FRAMES = frozenset({_F.GLOBAL, _F.GLOBAL_RELATIVE_ALT, _F.GLOBAL_INT, _F.GLOBAL_RELATIVE_ALT_INT})
_REGIONS = frozenset({_CMD.NAV_ROI, _CMD.DO_SET_ROI})
_REGIONS_PLACED = frozenset({common.MavRoi.NONE, common.MavRoi.LOCATION})
_REGIONS_PLACELESS = frozenset({common.MavRoi.NONE, common.MavRoi.WPNEXT, common.MavRoi.WPINDEX})
_ALL = frozenset({1, 2, 3, 4})
_TAKEOFFS = frozenset({_CMD.NAV_TAKEOFF, _CMD.NAV_VTOL_TAKEOFF})
_HIGHEST = 1.0e5
#: Number of times that MISSION_ITEM_REACHED is repeated, once a second.
_REPEATS = 10


class Px4MissionRules(MissionRules):
    """The mission rules of PX4."""

    first = 0
    actions_meanwhile = False
    zero_altitude_is_here = False
    waypoints_fly_forward = False
    takeoff_flies_to_position = yaw_counts = True

    #: An object that identifies the last reached item, so that repeats for older items stop.
    _reached: object = None

    # Uploads

    def check(self, item: MissionItem) -> int:
        if item.frame in _FRAMES:
            return self._check_placed(item)
        if item.frame != _F.MISSION:
            return _RESULT.UNSUPPORTED_FRAME
        if item.command not in PLACELESS:
            return _RESULT.UNSUPPORTED
        if item.command in _REGIONS and item.param1 not in _REGIONS_PLACELESS:
            return _RESULT.INVALID_PARAM1
        return check_numbers(item, may_be_nan=_ALL)

    def _check_placed(self, item: MissionItem) -> int:
        if item.command in _ALLOWED_ANYWHERE:
            return check_numbers(item, may_be_nan=_ALL)
        if item.command not in PLACED:
            return _RESULT.UNSUPPORTED
        if item.command in _REGIONS and item.param1 not in _REGIONS_PLACED:
            return _RESULT.INVALID_PARAM1
        result = check_numbers(item, may_be_nan=_ALL)
        if result != _RESULT.ACCEPTED:
            return result
        return check_position(item, highest=_HIGHEST, may_be_left_out=True)

    def replaced(self, mission: MissionRunner, was: int) -> None:
        self._reached = None
        problem = self.problem(mission)
        if problem is not None:
            mission.send_statustext(problem, _SEVERITY.CRITICAL)
        if mission.flying:
            mission.begin_at(mission.sequence)

    def problem(self, mission: MissionRunner) -> str | None:
        """Return why the uploaded mission cannot be flown; None if it can, or if there is none."""
        moved = False
        for seq, item in enumerate(mission.items):
            if seq == 0 and item.command == _CMD.NAV_LAND and self.grounded:
                return "Mission rejected: starts with landing"
            if item.command in _TAKEOFFS:
                if moved:
                    return "Mission rejected: takeoff not first waypoint item"
                if not isnan(item.param7) and self._height(item) <= 0:
                    return "Mission rejected: Takeoff altitude below home altitude!"
            moved = moved or (item.command in PLACED and item.command not in _REGIONS)
        return None

    def _height(self, item: MissionItem) -> float:
        return self.autopilot.home_position[2] - place_of(self.autopilot, item)[2]

    # Flying

    def navigates(self, item: MissionItem) -> bool:
        return item.command in PLACED and item.command not in _REGIONS | {_CMD.DO_SET_ROI_LOCATION}

    def refusal(self, mission: MissionRunner) -> str | None:
        if self.autopilot.armed and (not mission.exists or self.problem(mission) is not None):
            return "Switching to mode 'Mission' is currently not possible"
        return None

    def began(self, mission: MissionRunner) -> None:
        if mission.exists and self.problem(mission) is None:
            mission.send_statustext("Executing Mission")

    def started(self, step: Step) -> None:
        if step.item.command in _TAKEOFFS and self.grounded:
            step.mission.send_statustext(f"Climb to {self._height(step.item):.1f} meters above home")

    def reported(self, mission: MissionRunner, seq: int) -> None:
        self._reached = report = object()

        def repeat_report() -> None:
            if self._reached is report and mission.exists:
                mission.server.reached(seq)
                self.vehicle.touch(mission.server)

        for seconds in range(1, _REPEATS + 1):
            mission.later(repeat_report, after=seconds)

    def go_home(self, step: Step) -> Iterator[None]:
        mission, profile = step.mission, self.autopilot.profile
        was_last = mission.hand_over(step.seq)
        if was_last:
            mission.send_statustext("Mission finished, loitering")
        mission.send_statustext("Returning to launch")
        # After disarming PX4 enters Hold, so that the mission does not restart at the next arming.
        modes = (profile.hold, profile.return_to_launch) if was_last else (profile.return_to_launch,)
        return mission.leave(*modes, reason="mission item")

    def finish(self, mission: MissionRunner) -> Iterator[None]:
        """End the mission; on the ground the mode stays, and the vehicle is disarmed."""
        autopilot, where = self.autopilot, "landed" if self.grounded else "loitering"
        if not mission.exists:
            ending = "refusing takeoff" if self.grounded else where
            mission.send_statustext(f"No valid mission available, {ending}", _SEVERITY.CRITICAL)
        else:
            mission.send_statustext(f"Mission finished, {where}")
            if self.grounded:
                mission.later(self._disarm, after=autopilot.flight_parameters.land_disarm_delay)
                autopilot.body.idle()
                while True:
                    yield
        yield from mission.leave(autopilot.profile.hold, reason="mission end")

    def _disarm(self) -> None:
        """Disarm after a landing by the mission."""
        autopilot = self.autopilot
        if autopilot.landed and autopilot.mode.number == autopilot.profile.mission:
            autopilot.disarm("landed")
