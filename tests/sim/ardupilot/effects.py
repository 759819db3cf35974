"""Cases of every command that ArduPilot supports: preparation, parameters, effect."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mavstack.dialects import ardupilotmega, common
from mavstack.services.mission import MissionItem
from mavstack.sim.ardupilot.sensor_calibration import calibrations_of

from .harness import CMD, RELATIVE, ArdupilotHarness

if TYPE_CHECKING:
    from collections.abc import Callable


@dataclass(frozen=True)
class Case:
    """`prepare` sets the state, `params` (or their result) are sent, and `has_acted` checks the effect."""

    params: tuple[float, ...] | Callable[[ArdupilotHarness], tuple[float, ...]]
    has_acted: Callable[[ArdupilotHarness], bool]
    prepare: Callable[[ArdupilotHarness], object] = lambda harness: None
    frame: int | None = None
    wait: float = 1.0


def enable(*names: str) -> Callable[[ArdupilotHarness], None]:
    def prepare(harness: ArdupilotHarness) -> None:
        for name in names:
            harness.vehicle.parameters.set(name, 1)

    return prepare


def has_sent(message_type: type) -> Callable[[ArdupilotHarness], bool]:
    return lambda harness: any(isinstance(message, message_type) for message in harness.received)


def has_text(text: str) -> Callable[[ArdupilotHarness], bool]:
    return lambda harness: any(text in known for known in harness.texts)


def in_mode(*names: str) -> Callable[[ArdupilotHarness], bool]:
    return lambda harness: harness.mode in names


def target_params(harness: ArdupilotHarness) -> tuple[float, ...]:
    return (-1, 1, 0, 0, *harness.at(30, 40), -4 if harness.vehicle.vehicle_type == "sub" else 12)


def flies_to_target(harness: ArdupilotHarness) -> bool:
    target = harness.autopilot.target
    return (
        harness.mode == "GUIDED"
        and target is not None
        and abs(target[0] - 30) < 1
        and abs(target[1] - 40) < 1
    )


def arm(harness: ArdupilotHarness) -> None:
    assert not harness.autopilot.arm(force=True)


def take_off(harness: ArdupilotHarness) -> None:
    harness.take_off(30.0 if harness.vehicle.vehicle_type == "plane" else 10.0)


def load_tagged_mission(harness: ArdupilotHarness) -> None:
    tag = MissionItem(ardupilotmega.MavCmd.JUMP_TAG, param1=7, frame=common.MavFrame.MISSION)
    harness.load(harness.waypoint(10, 0, 10), tag, harness.waypoint(20, 0, 10))


def load_landing_mission(harness: ArdupilotHarness) -> None:
    start = MissionItem(common.MavCmd.DO_LAND_START, frame=RELATIVE)
    harness.load(harness.waypoint(10, 0, 10), start, harness.waypoint(20, 0, 10))
    take_off(harness)


def fly_mission(harness: ArdupilotHarness) -> None:
    harness.load(harness.waypoint(100, 0, 10), harness.waypoint(200, 0, 10))
    take_off(harness)
    harness.set_mode("AUTO")
    harness.run(2)


def load_mission(harness: ArdupilotHarness) -> None:
    harness.load(
        harness.waypoint(100, 0, 0 if harness.vehicle.vehicle_type.on_surface else 10),
        harness.waypoint(200, 0, 10),
    )
    if harness.vehicle.vehicle_type == "sub":
        arm(harness)


def calibrate_compass(harness: ArdupilotHarness) -> None:
    harness.command(CMD.DO_START_MAG_CAL)
    harness.vehicle.body.offset_compass(0.5)
    harness.run(10.7)


def enable_parachute(harness: ArdupilotHarness) -> None:
    harness.accepted(CMD.DO_PARACHUTE, 1)
    take_off(harness)


def has_new_speed(harness: ArdupilotHarness) -> bool:
    maneuvers = harness.autopilot.maneuvers
    return maneuvers.speed == (3.0 if not harness.autopilot.maneuvers.circles else 20.0)


def speed_params(harness: ArdupilotHarness) -> tuple[float, ...]:
    return (1, 3.0) if not harness.autopilot.maneuvers.circles else (0, 20.0)


CASES: dict[int, Case] = {
    CMD.CAN_FORWARD: Case((1,), has_sent(common.CanFrame)),
    # arming
    CMD.COMPONENT_ARM_DISARM: Case((1, 21196), lambda harness: harness.autopilot.armed),
    CMD.RUN_PREARM_CHECKS: Case(
        (), has_text("PreArm: "), lambda harness: (harness.set_mode("GUIDED"), lose_gps(harness))
    ),
    CMD.DO_FLIGHTTERMINATION: Case((1,), lambda harness: not harness.autopilot.armed, take_off),
    # modes and movement
    CMD.DO_SET_MODE: Case(
        lambda harness: (1, harness.autopilot.profile.guided), lambda harness: harness.mode == "GUIDED"
    ),
    CMD.NAV_RETURN_TO_LAUNCH: Case((), in_mode("RTL"), take_off),
    CMD.NAV_LOITER_UNLIM: Case((), in_mode("LOITER", "POSHOLD"), take_off),
    CMD.NAV_LAND: Case((), in_mode("LAND", "SURFACE"), take_off),
    CMD.NAV_VTOL_LAND: Case((), in_mode("LAND"), take_off),
    CMD.NAV_TAKEOFF: Case(
        (0, 0, 0, 0, 0, 0, 12),
        lambda harness: harness.autopilot.altitude > 5,
        lambda harness: (harness.set_mode("GUIDED"), arm(harness)),
        wait=12,
    ),
    CMD.CONTROL_HIGH_LATENCY: Case((1,), has_text("High Latency enabled")),
    CMD.DO_FOLLOW: Case(
        (7,),
        lambda harness: harness.vehicle.parameters.get("FOLL_SYSID", 0) == 7,
        prepare=enable("FOLL_ENABLE"),
    ),
    CMD.DO_REPOSITION: Case(target_params, flies_to_target, take_off, frame=RELATIVE),
    CMD.DO_CHANGE_SPEED: Case(speed_params, has_new_speed, take_off),
    CMD.CONDITION_YAW: Case(
        (90, 0, 1, 0), lambda harness: abs(harness.vehicle.body.truth.yaw - 1.57) < 0.2, take_off, wait=12
    ),
    CMD.GUIDED_CHANGE_SPEED: Case(
        (0, 20), lambda harness: harness.autopilot.maneuvers.speed == 20, take_off, RELATIVE
    ),
    CMD.GUIDED_CHANGE_ALTITUDE: Case(
        (0, 0, 0, 0, 0, 0, 77),
        lambda harness: abs((harness.autopilot.target or (0, 0, 0))[2] + 77) < 1,
        take_off,
        RELATIVE,
    ),
    CMD.GUIDED_CHANGE_HEADING: Case(
        (0, 90), lambda harness: (harness.autopilot.target or (0, 0, 0))[1] > 1000, take_off, RELATIVE
    ),
    CMD.NAV_SET_YAW_SPEED: Case(
        (90, 2), lambda harness: harness.vehicle.body.truth.velocity_east > 0.5, take_off, wait=3
    ),
    CMD.DO_VTOL_TRANSITION: Case((4,), lambda harness: harness.vehicle.body.flies_forward, take_off, wait=5),
    # missions and fence
    CMD.MISSION_START: Case((), in_mode("AUTO"), load_mission),
    CMD.DO_SET_MISSION_CURRENT: Case(
        (2,), lambda harness: harness.vehicle.mission.current == 2, load_mission
    ),
    CMD.DO_JUMP_TAG: Case((7,), lambda harness: harness.vehicle.mission.current >= 2, load_tagged_mission),
    CMD.DO_LAND_START: Case((), in_mode("AUTO"), load_landing_mission),
    CMD.DO_PAUSE_CONTINUE: Case((0,), lambda harness: harness.autopilot.mission.paused, fly_mission),
    CMD.DO_FENCE_ENABLE: Case((1,), lambda harness: harness.vehicle.parameters["FENCE_ENABLE"] == 1),
    # home and region of interest
    CMD.DO_SET_HOME: Case(
        lambda harness: (0, 0, 0, 0, *harness.at(50, 60), 500),
        lambda harness: abs(harness.autopilot.home.altitude - 500) < 0.1 and harness.autopilot.home_locked,
    ),
    CMD.GET_HOME_POSITION: Case((), has_sent(common.HomePosition)),
    CMD.DO_SET_ROI: Case(
        lambda harness: (0, 0, 0, 0, *harness.at(50, 60), 0),
        lambda harness: harness.autopilot.payload.region_of_interest is not None,
    ),
    CMD.DO_SET_ROI_LOCATION: Case(
        lambda harness: (0, 0, 0, 0, *harness.at(50, 60), 0),
        lambda harness: harness.autopilot.payload.region_of_interest is not None,
    ),
    CMD.DO_SET_ROI_NONE: Case(
        (),
        lambda harness: harness.autopilot.payload.region_of_interest is None,
        lambda harness: setattr(harness.autopilot.payload, "region_of_interest", (1.0, 2.0, 3.0)),
    ),
    # payload
    CMD.DO_SET_SERVO: Case((9, 1700), lambda harness: harness.autopilot.payload.servos == {9: 1700}),
    CMD.DO_REPEAT_SERVO: Case(
        (9, 1700, 3, 2), lambda harness: harness.autopilot.payload.servos == {9: 1500}, wait=1.3
    ),
    CMD.DO_SET_RELAY: Case((0, 1), lambda harness: harness.autopilot.payload.relays.get(0)),
    CMD.DO_REPEAT_RELAY: Case(
        (0, 3, 2), lambda harness: harness.autopilot.payload.relays.get(0) is False, wait=1.3
    ),
    CMD.DO_GRIPPER: Case(
        (1, 1), lambda harness: harness.autopilot.payload.gripper_closed, enable("GRIP_ENABLE")
    ),
    CMD.DO_PARACHUTE: Case((2,), lambda harness: not harness.autopilot.armed, enable_parachute),
    CMD.DO_WINCH: Case(
        (1, 1, 0.5, 0), lambda harness: harness.autopilot.payload.winch == 0.5, enable("WINCH_TYPE")
    ),
    CMD.DO_SPRAYER: Case((1,), lambda harness: harness.autopilot.payload.sprayer, enable("SPRAY_ENABLE")),
    CMD.IMAGE_START_CAPTURE: Case(
        (0, 0.5, 3), lambda harness: harness.autopilot.payload.images == 3, enable("CAM1_TYPE"), wait=2
    ),
    CMD.IMAGE_STOP_CAPTURE: Case(
        (),
        lambda harness: not harness.autopilot.payload.takes_images,
        lambda harness: (enable("CAM1_TYPE")(harness), harness.accepted(CMD.IMAGE_START_CAPTURE, 0, 1, 0)),
    ),
    CMD.VIDEO_START_CAPTURE: Case(
        (), lambda harness: harness.autopilot.payload.recording, enable("CAM1_TYPE")
    ),
    CMD.VIDEO_STOP_CAPTURE: Case(
        (),
        lambda harness: not harness.autopilot.payload.recording,
        lambda harness: (enable("CAM1_TYPE")(harness), harness.accepted(CMD.VIDEO_START_CAPTURE)),
    ),
    CMD.DO_DIGICAM_CONTROL: Case((0, 0, 0, 0, 1), has_sent(common.CameraImageCaptured), enable("CAM1_TYPE")),
    CMD.DO_SET_CAM_TRIGG_DIST: Case(
        (10,), lambda harness: harness.autopilot.payload.takes_images, enable("CAM1_TYPE")
    ),
    CMD.SET_CAMERA_ZOOM: Case(
        (2, 30), lambda harness: harness.autopilot.payload.zoom == 30, enable("CAM1_TYPE")
    ),
    CMD.SET_CAMERA_FOCUS: Case(
        (2, 40), lambda harness: harness.autopilot.payload.focus == 40, enable("CAM1_TYPE")
    ),
    CMD.DO_MOUNT_CONTROL: Case(
        (-45, 0, 0, 0, 0, 0, 2),
        lambda harness: harness.autopilot.payload.gimbal.pitch < -0.7,
        enable("MNT1_TYPE"),
    ),
    CMD.DO_GIMBAL_MANAGER_PITCHYAW: Case(
        (-45, 30), lambda harness: harness.autopilot.payload.gimbal.yaw > 0.5, enable("MNT1_TYPE")
    ),
    # the vehicle itself
    CMD.PREFLIGHT_REBOOT_SHUTDOWN: Case((1,), lambda harness: harness.vehicle.boots == 2),
    CMD.PREFLIGHT_CALIBRATION: Case((0, 0, 1), has_text("Barometer calibration complete"), wait=4),
    CMD.PREFLIGHT_STORAGE: Case(
        (2,),
        lambda harness: harness.vehicle.parameters["FENCE_RADIUS"] != 77,
        lambda harness: harness.vehicle.parameters.set("FENCE_RADIUS", 77),
    ),
    CMD.DO_MOTOR_TEST: Case((1, 0, 20, 3), lambda harness: harness.autopilot.payload.motor_tested == 1),
    CMD.DO_START_MAG_CAL: Case((), has_sent(ardupilotmega.MagCalProgress)),
    CMD.DO_ACCEPT_MAG_CAL: Case(
        (), lambda harness: not calibrations_of(harness.autopilot).compass_ready, calibrate_compass
    ),
    CMD.DO_CANCEL_MAG_CAL: Case(
        (),
        lambda harness: calibrations_of(harness.autopilot).compass_started is None,
        lambda harness: harness.accepted(CMD.DO_START_MAG_CAL),
    ),
    CMD.ACCELCAL_VEHICLE_POS: Case(
        (1,),
        lambda harness: calibrations_of(harness.autopilot).position == 2,
        lambda harness: harness.accepted(CMD.PREFLIGHT_CALIBRATION, 0, 0, 0, 0, 1),
    ),
    CMD.BATTERY_RESET: Case(
        (1, 50), lambda harness: abs(harness.vehicle.body.battery.remaining - 0.5) < 0.02
    ),
    CMD.SET_EKF_SOURCE_SET: Case((2,), has_text("Using EKF Source Set 2")),
    CMD.DO_AUX_FUNCTION: Case((11, 2), lambda harness: harness.vehicle.parameters["FENCE_ENABLE"] == 1),
    CMD.DO_SEND_BANNER: Case((), has_text("V4.6")),
    # messages
    CMD.REQUEST_MESSAGE: Case((common.Attitude.__mavlink_row__[0],), has_sent(common.Attitude)),
    CMD.SET_MESSAGE_INTERVAL: Case(
        (common.Attitude.__mavlink_row__[0], 50_000),
        lambda harness: sum(isinstance(message, common.Attitude) for message in harness.received) > 15,
    ),
    CMD.GET_MESSAGE_INTERVAL: Case((common.Attitude.__mavlink_row__[0],), has_sent(common.MessageInterval)),
    CMD.REQUEST_AUTOPILOT_CAPABILITIES: Case((1,), has_sent(common.AutopilotVersion)),
    CMD.REQUEST_PROTOCOL_VERSION: Case((1,), has_sent(common.ProtocolVersion)),
}
CASES[CMD.NAV_VTOL_TAKEOFF] = CASES[CMD.NAV_TAKEOFF]


def lose_gps(harness: ArdupilotHarness) -> None:
    harness.vehicle.body.fail_gps(True)
    harness.run_until(lambda: not harness.autopilot.has_position)
