"""ArduPilot's mission rules.

Item 0 is home, and is never flown. DO and CONDITION items run beside the next NAV item. Copter, Plane, Rover
and Sub differ in their status texts and in the end of a mission.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import ardupilotmega, common
from mavstack.services.frames import GLOBAL_FRAMES
from mavstack.sim.autopilot.item_checks import check_numbers, check_position
from mavstack.sim.autopilot.item_positions import as_global
from mavstack.sim.autopilot.mission.rules import MissionRules
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from mavstack.services.mission import MissionItem
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.mission.rules import Step
    from mavstack.sim.autopilot.mission.runner import MissionRunner

_CMD = ardupilotmega.MavCmd
_RESULT = common.MavMissionResult
_SEVERITY = common.MavSeverity

#: The commands that a mission may contain, with their names in status texts.
NAMES: Mapping[int, str] = {
    _CMD.NAV_WAYPOINT: "WP",
    _CMD.NAV_LOITER_UNLIM: "LoitUnlim",
    _CMD.NAV_LOITER_TURNS: "LoitTurns",
    _CMD.NAV_LOITER_TIME: "LoitTime",
    _CMD.NAV_RETURN_TO_LAUNCH: "RTL",
    _CMD.NAV_LAND: "Land",
    _CMD.NAV_TAKEOFF: "Takeoff",
    _CMD.NAV_CONTINUE_AND_CHANGE_ALT: "ContinueAndChangeAlt",
    _CMD.NAV_LOITER_TO_ALT: "LoitAltitude",
    _CMD.NAV_SPLINE_WAYPOINT: "SplineWP",
    _CMD.NAV_ALTITUDE_WAIT: "AltitudeWait",
    _CMD.NAV_VTOL_TAKEOFF: "VTOLTakeoff",
    _CMD.NAV_VTOL_LAND: "VTOLLand",
    _CMD.NAV_GUIDED_ENABLE: "GuidedEnable",
    _CMD.NAV_DELAY: "Delay",
    _CMD.NAV_PAYLOAD_PLACE: "PayloadPlace",
    _CMD.NAV_SET_YAW_SPEED: "SetYawSpd",
    _CMD.CONDITION_DELAY: "CondDelay",
    _CMD.CONDITION_DISTANCE: "CondDist",
    _CMD.CONDITION_YAW: "CondYaw",
    _CMD.DO_JUMP: "Jump",
    _CMD.JUMP_TAG: "JumpTag",
    _CMD.DO_JUMP_TAG: "DoJumpTag",
    _CMD.DO_CHANGE_SPEED: "ChangeSpeed",
    _CMD.DO_SET_HOME: "SetHome",
    _CMD.DO_SET_RELAY: "SetRelay",
    _CMD.DO_REPEAT_RELAY: "RepeatRelay",
    _CMD.DO_SET_SERVO: "SetServo",
    _CMD.DO_REPEAT_SERVO: "RepeatServo",
    _CMD.DO_LAND_START: "LandStart",
    _CMD.DO_RETURN_PATH_START: "ReturnPathStart",
    _CMD.DO_GO_AROUND: "GoAround",
    _CMD.DO_SET_ROI: "SetROI",
    _CMD.DO_SET_ROI_LOCATION: "SetROI",
    _CMD.DO_SET_ROI_NONE: "SetROI",
    _CMD.DO_DIGICAM_CONFIGURE: "DigiCamCfg",
    _CMD.DO_DIGICAM_CONTROL: "DigiCamCtrl",
    _CMD.DO_MOUNT_CONTROL: "MountControl",
    _CMD.DO_GIMBAL_MANAGER_PITCHYAW: "GimbalPitchYaw",
    _CMD.DO_SET_CAM_TRIGG_DIST: "SetCamTrigDst",
    _CMD.IMAGE_START_CAPTURE: "ImageStartCapture",
    _CMD.IMAGE_STOP_CAPTURE: "ImageStopCapture",
    _CMD.VIDEO_START_CAPTURE: "VideoStartCapture",
    _CMD.VIDEO_STOP_CAPTURE: "VideoStopCapture",
    _CMD.SET_CAMERA_ZOOM: "SetCameraZoom",
    _CMD.SET_CAMERA_FOCUS: "SetCameraFocus",
    _CMD.DO_FENCE_ENABLE: "FenceEnable",
    _CMD.DO_PARACHUTE: "Parachute",
    _CMD.DO_INVERTED_FLIGHT: "InvertedFlight",
    _CMD.DO_GRIPPER: "Gripper",
    _CMD.DO_GUIDED_LIMITS: "GuidedLimits",
    _CMD.DO_AUTOTUNE_ENABLE: "AutoTuneEnable",
    _CMD.DO_VTOL_TRANSITION: "VTOLTransition",
    _CMD.DO_SET_REVERSE: "SetReverse",
    _CMD.DO_ENGINE_CONTROL: "EngineControl",
    _CMD.DO_SET_RESUME_REPEAT_DIST: "SetRepeatDist",
    _CMD.DO_SPRAYER: "Sprayer",
    _CMD.DO_AUX_FUNCTION: "AuxFunction",
    _CMD.DO_WINCH: "Winch",
}
_PLACED_NAMES = """
    NAV_WAYPOINT NAV_LOITER_UNLIM NAV_LOITER_TURNS NAV_LOITER_TIME NAV_LAND NAV_TAKEOFF
    NAV_CONTINUE_AND_CHANGE_ALT NAV_LOITER_TO_ALT NAV_SPLINE_WAYPOINT NAV_VTOL_TAKEOFF NAV_VTOL_LAND
    NAV_PAYLOAD_PLACE DO_SET_HOME DO_LAND_START DO_RETURN_PATH_START DO_GO_AROUND DO_SET_ROI
    DO_SET_ROI_LOCATION
    """
_PLACED = frozenset(getattr(_CMD, name) for name in _PLACED_NAMES.split())
#: By command: the numbers of the params (1 to 4) that may be NaN.
_MAY_BE_NAN: Mapping[int, frozenset[int]] = {
    _CMD.NAV_WAYPOINT: frozenset({4}),
    _CMD.NAV_LAND: frozenset({4}),
    _CMD.NAV_TAKEOFF: frozenset({4}),
    _CMD.NAV_VTOL_TAKEOFF: frozenset({4}),
    _CMD.NAV_VTOL_LAND: frozenset({3, 4}),
    _CMD.DO_GIMBAL_MANAGER_PITCHYAW: frozenset({1, 2, 3, 4}),
    _CMD.IMAGE_START_CAPTURE: frozenset({4}),
}
#: Commands for which ArduPilot sends no MISSION_ITEM_REACHED, because its mission library runs them.
_SILENT_NAMES = """
    DO_GRIPPER DO_SET_SERVO DO_SET_RELAY DO_REPEAT_SERVO DO_REPEAT_RELAY DO_DIGICAM_CONFIGURE
    DO_DIGICAM_CONTROL DO_SET_CAM_TRIGG_DIST DO_PARACHUTE DO_SET_RESUME_REPEAT_DIST DO_SPRAYER
    DO_AUX_FUNCTION JUMP_TAG
    """
_SILENT = frozenset(getattr(_CMD, name) for name in _SILENT_NAMES.split())
_LAST_NAVIGATION = 95
_HIGHEST = 83000.0
_WINGS = frozenset({VehicleType.PLANE, VehicleType.VTOL})
_HOVERING = frozenset({VehicleType.COPTER, VehicleType.SUB})


class ArdupilotMissionRules(MissionRules):
    """The mission rules of Copter, Plane, Rover and Sub."""

    first = 1
    actions_meanwhile = True
    waypoints_fly_forward = True
    wing_stays_landed = True

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        super().__init__(autopilot)
        kind = self.vehicle.vehicle_type
        self.zero_altitude_is_here = kind in _HOVERING
        self.returns_in_mode = kind not in _HOVERING
        self.hold_counts = kind not in _WINGS
        self.radius_counts = self.passes_by = kind in _WINGS

    @property
    def restarts(self) -> bool:
        return self.vehicle.parameters.get("MIS_RESTART", 0) == 1

    # Uploads

    def check(self, item: MissionItem) -> int:
        if item.command not in NAMES:
            return _RESULT.UNSUPPORTED
        result = check_numbers(item, may_be_nan=_MAY_BE_NAN.get(item.command, frozenset()))
        if result != _RESULT.ACCEPTED or item.command not in _PLACED:
            return result
        result = check_position(as_global(item), highest=_HIGHEST)
        if result == _RESULT.ACCEPTED and item.frame not in GLOBAL_FRAMES | {common.MavFrame.MISSION}:
            return _RESULT.UNSUPPORTED_FRAME
        return result

    def may_replace(self, *, flying: bool, empty: bool) -> int:
        return _RESULT.ERROR if flying and empty else _RESULT.ACCEPTED

    def replaced(self, mission: MissionRunner, was: int) -> None:
        if mission.items:
            mission.send_statustext("Flight plan received")
        mission.set_current(was)
        if not mission.flying:
            return
        item = mission.items[was] if was < len(mission.items) else None
        if item != mission.flown and self.vehicle.vehicle_type not in _WINGS:
            mission.begin_at(was)
            ending = ", restarted command" if item is not None else " but failed to restart command"
            mission.send_statustext(f"Auto mission changed{ending}", _SEVERITY.CRITICAL)

    # Flying

    def navigates(self, item: MissionItem) -> bool:
        return item.command <= _LAST_NAVIGATION or item.command == _CMD.NAV_SET_YAW_SPEED

    def refusal(self, mission: MissionRunner) -> str | None:
        autopilot, kind = self.autopilot, self.vehicle.vehicle_type
        if kind in _WINGS or not (autopilot.armed or kind.on_surface):
            return None
        if not mission.exists:
            return (
                "No Mission. Can't set AUTO."
                if kind.on_surface
                else "Mode change to AUTO failed: init failed"
            )
        if kind is VehicleType.COPTER and autopilot.armed and autopilot.landed and not _takes_off(mission):
            return "Auto: Missing Takeoff Cmd"
        return None

    def started(self, step: Step) -> None:
        step.mission.send_statustext(f"Mission: {step.seq} {NAMES.get(step.item.command, '?')}")

    def arrived(self, step: Step, hold: float) -> None:
        kind = self.vehicle.vehicle_type
        if kind in _WINGS:
            away = step.maneuvers.distance(step.place())
            step.mission.send_statustext(f"Reached waypoint #{step.seq} dist {away:.0f}m")
        elif kind.on_surface:
            ending = f". Loiter for {hold:.0f} seconds" if hold > 0 else ""
            step.mission.send_statustext(f"Reached waypoint #{step.seq}{ending}")

    def waited(self, step: Step) -> None:
        if self.vehicle.vehicle_type in _HOVERING:
            step.mission.send_statustext(f"Reached command #{step.seq}")

    def reports(self, item: MissionItem) -> bool:
        return item.command not in _SILENT

    def finish(self, mission: MissionRunner) -> Iterator[None]:
        kind, autopilot = self.vehicle.vehicle_type, self.autopilot
        if self.grounded and kind in {VehicleType.COPTER, VehicleType.VTOL}:
            mission.later(lambda: autopilot.disarm("mission end"))
            while True:
                yield
        if kind in _WINGS:
            mission.send_statustext("Mission complete, changing mode to RTL")
            yield from mission.leave(autopilot.profile.return_to_launch, reason="mission end")
        if kind.on_surface:
            mission.send_statustext("Mission Complete", _SEVERITY.NOTICE)
        mission.set_course(mission.course.point or autopilot.maneuvers.place)
        while True:
            mission.keep_course()
            yield


def _takes_off(mission: MissionRunner) -> bool:
    """Return whether the next NAV item, except delays, is a takeoff."""
    begin = 0 if mission.rules.restarts else mission.sequence
    commands = (mission.items[seq].command for seq in mission.route.upcoming(begin))
    first = next((command for command in commands if command != _CMD.NAV_DELAY), None)
    return first in {_CMD.NAV_TAKEOFF, _CMD.NAV_VTOL_TAKEOFF}
