"""The script of each MAV_CMD that a mission can hold.

Unlisted items are skipped: the firmware's rules refuse unknown items in an upload.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega
from mavstack.sim.autopilot.mission import actions, conditions, equipment, loitering, navigation

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.sim.autopilot.mission.rules import Script

_CMD = ardupilotmega.MavCmd

SCRIPTS: Final[Mapping[int, Script]] = {
    _CMD.NAV_WAYPOINT: navigation.waypoint,
    _CMD.NAV_SPLINE_WAYPOINT: navigation.waypoint,
    _CMD.CONDITION_GATE: navigation.waypoint,
    _CMD.NAV_TAKEOFF: navigation.take_off,
    _CMD.NAV_VTOL_TAKEOFF: navigation.vtol_take_off,
    _CMD.NAV_LAND: navigation.land,
    _CMD.NAV_VTOL_LAND: navigation.land,
    _CMD.NAV_RETURN_TO_LAUNCH: navigation.return_to_launch,
    _CMD.NAV_DELAY: navigation.delay,
    _CMD.NAV_CONTINUE_AND_CHANGE_ALT: navigation.change_altitude,
    _CMD.NAV_GUIDED_ENABLE: navigation.fly_guided,
    _CMD.NAV_SET_YAW_SPEED: navigation.turn_and_drive,
    _CMD.NAV_ALTITUDE_WAIT: navigation.wait_for_altitude,
    _CMD.NAV_PAYLOAD_PLACE: navigation.place_payload,
    _CMD.NAV_LOITER_UNLIM: loitering.loiter_forever,
    _CMD.NAV_LOITER_TIME: loitering.loiter_for_a_time,
    _CMD.NAV_LOITER_TURNS: loitering.loiter_turns,
    _CMD.NAV_LOITER_TO_ALT: loitering.loiter_to_altitude,
    _CMD.CONDITION_DELAY: conditions.condition_delay,
    _CMD.CONDITION_DISTANCE: conditions.condition_distance,
    _CMD.CONDITION_YAW: conditions.condition_yaw,
    _CMD.DO_CHANGE_SPEED: actions.change_speed,
    _CMD.DO_SET_HOME: actions.set_home,
    _CMD.DO_SET_ROI: actions.set_region,
    _CMD.NAV_ROI: actions.set_region,
    _CMD.DO_SET_ROI_LOCATION: actions.set_region,
    _CMD.DO_SET_ROI_NONE: actions.clear_region,
    _CMD.DO_FENCE_ENABLE: actions.switch_fence,
    _CMD.DO_VTOL_TRANSITION: actions.change_flight,
    _CMD.DO_GUIDED_LIMITS: actions.limit_guided,
    _CMD.DO_AUX_FUNCTION: actions.use_function,
    _CMD.COMPONENT_ARM_DISARM: actions.arm_or_disarm,
    _CMD.DO_SET_SERVO: equipment.set_servo,
    _CMD.DO_REPEAT_SERVO: equipment.repeat_servo,
    _CMD.DO_SET_RELAY: equipment.set_relay,
    _CMD.DO_REPEAT_RELAY: equipment.repeat_relay,
    _CMD.DO_SET_ACTUATOR: equipment.set_actuators,
    _CMD.DO_GRIPPER: equipment.grip,
    _CMD.DO_PARACHUTE: equipment.use_parachute,
    _CMD.DO_WINCH: equipment.wind,
    _CMD.DO_SPRAYER: equipment.spray,
    _CMD.DO_SET_CAM_TRIGG_DIST: equipment.trigger_by_distance,
    _CMD.OBLIQUE_SURVEY: equipment.trigger_by_distance,
    _CMD.DO_SET_CAM_TRIGG_INTERVAL: equipment.trigger_by_time,
    _CMD.DO_TRIGGER_CONTROL: equipment.control_trigger,
    _CMD.DO_DIGICAM_CONTROL: equipment.control_camera,
    _CMD.IMAGE_START_CAPTURE: equipment.start_images,
    _CMD.IMAGE_STOP_CAPTURE: equipment.stop_images,
    _CMD.VIDEO_START_CAPTURE: equipment.start_video,
    _CMD.VIDEO_STOP_CAPTURE: equipment.stop_video,
    _CMD.SET_CAMERA_ZOOM: equipment.zoom,
    _CMD.SET_CAMERA_FOCUS: equipment.focus,
    _CMD.DO_MOUNT_CONTROL: equipment.point_mount,
    _CMD.DO_GIMBAL_MANAGER_PITCHYAW: equipment.point_gimbal,
}


def script_of(command: int) -> Script:
    """Return the script of a MAV_CMD."""
    return SCRIPTS.get(command, actions.nothing)
