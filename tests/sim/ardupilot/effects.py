"""A case for every command that an ArduPilot takes: how to be ready, what to send, what it must have done."""

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
    """`ready` prepares, `params` (or what makes them) are sent, and `seen` tells that it was done."""

    params: tuple[float, ...] | Callable[[ArdupilotHarness], tuple[float, ...]]
    seen: Callable[[ArdupilotHarness], bool]
    ready: Callable[[ArdupilotHarness], object] = lambda bench: None
    frame: int | None = None
    wait: float = 1.0


def fitted(*names: str) -> Callable[[ArdupilotHarness], None]:
    def ready(bench: ArdupilotHarness) -> None:
        for name in names:
            bench.vehicle.parameters.set(name, 1)

    return ready


def sent(kind: type) -> Callable[[ArdupilotHarness], bool]:
    return lambda bench: any(isinstance(message, kind) for message in bench.received)


def said(text: str) -> Callable[[ArdupilotHarness], bool]:
    return lambda bench: any(text in known for known in bench.texts)


def in_mode(*names: str) -> Callable[[ArdupilotHarness], bool]:
    return lambda bench: bench.mode in names


def there(bench: ArdupilotHarness) -> tuple[float, ...]:
    return (-1, 1, 0, 0, *bench.at(30, 40), -4 if bench.vehicle.vehicle_type == "sub" else 12)


def goes_there(bench: ArdupilotHarness) -> bool:
    target = bench.autopilot.target
    return (
        bench.mode == "GUIDED" and target is not None and abs(target[0] - 30) < 1 and abs(target[1] - 40) < 1
    )


def armed(bench: ArdupilotHarness) -> None:
    assert not bench.autopilot.arm(force=True)


def flying(bench: ArdupilotHarness) -> None:
    bench.lift(30.0 if bench.vehicle.vehicle_type == "plane" else 10.0)


def tagged(bench: ArdupilotHarness) -> None:
    tag = MissionItem(ardupilotmega.MavCmd.JUMP_TAG, param1=7, frame=common.MavFrame.MISSION)
    bench.load(bench.waypoint(10, 0, 10), tag, bench.waypoint(20, 0, 10))


def landable(bench: ArdupilotHarness) -> None:
    start = MissionItem(common.MavCmd.DO_LAND_START, frame=RELATIVE)
    bench.load(bench.waypoint(10, 0, 10), start, bench.waypoint(20, 0, 10))
    flying(bench)


def on_mission(bench: ArdupilotHarness) -> None:
    bench.load(bench.waypoint(100, 0, 10), bench.waypoint(200, 0, 10))
    flying(bench)
    bench.set_mode("AUTO")
    bench.run(2)


def missioned(bench: ArdupilotHarness) -> None:
    bench.load(
        bench.waypoint(100, 0, 0 if bench.vehicle.vehicle_type.on_surface else 10), bench.waypoint(200, 0, 10)
    )
    if bench.vehicle.vehicle_type == "sub":
        armed(bench)


def calibrated(bench: ArdupilotHarness) -> None:
    bench.command(CMD.DO_START_MAG_CAL)
    bench.vehicle.body.offset_compass(0.5)
    bench.run(10.7)


def parachute_out(bench: ArdupilotHarness) -> None:
    bench.accepted(CMD.DO_PARACHUTE, 1)
    flying(bench)


def forward_speed(bench: ArdupilotHarness) -> bool:
    maneuvers = bench.autopilot.maneuvers
    return maneuvers.speed == (3.0 if not bench.autopilot.maneuvers.circles else 20.0)


def speed(bench: ArdupilotHarness) -> tuple[float, ...]:
    return (1, 3.0) if not bench.autopilot.maneuvers.circles else (0, 20.0)


CASES: dict[int, Case] = {
    # arming
    CMD.COMPONENT_ARM_DISARM: Case((1, 21196), lambda bench: bench.autopilot.armed),
    CMD.RUN_PREARM_CHECKS: Case(
        (), said("PreArm: "), lambda bench: (bench.set_mode("GUIDED"), lose_gps(bench))
    ),
    CMD.DO_FLIGHTTERMINATION: Case((1,), lambda bench: not bench.autopilot.armed, flying),
    # modes and movement
    CMD.DO_SET_MODE: Case(
        lambda bench: (1, bench.autopilot.profile.guided), lambda bench: bench.mode == "GUIDED"
    ),
    CMD.NAV_RETURN_TO_LAUNCH: Case((), in_mode("RTL"), flying),
    CMD.NAV_LOITER_UNLIM: Case((), in_mode("LOITER", "POSHOLD"), flying),
    CMD.NAV_LAND: Case((), in_mode("LAND", "SURFACE"), flying),
    CMD.NAV_VTOL_LAND: Case((), in_mode("LAND"), flying),
    CMD.NAV_TAKEOFF: Case(
        (0, 0, 0, 0, 0, 0, 12),
        lambda bench: bench.autopilot.altitude > 5,
        lambda bench: (bench.set_mode("GUIDED"), armed(bench)),
        wait=12,
    ),
    CMD.DO_REPOSITION: Case(there, goes_there, flying, frame=RELATIVE),
    CMD.DO_CHANGE_SPEED: Case(speed, forward_speed, flying),
    CMD.CONDITION_YAW: Case(
        (90, 0, 1, 0), lambda bench: abs(bench.vehicle.body.truth.yaw - 1.57) < 0.2, flying, wait=12
    ),
    CMD.GUIDED_CHANGE_SPEED: Case(
        (0, 20), lambda bench: bench.autopilot.maneuvers.speed == 20, flying, RELATIVE
    ),
    CMD.GUIDED_CHANGE_ALTITUDE: Case(
        (0, 0, 0, 0, 0, 0, 77),
        lambda bench: abs((bench.autopilot.target or (0, 0, 0))[2] + 77) < 1,
        flying,
        RELATIVE,
    ),
    CMD.GUIDED_CHANGE_HEADING: Case(
        (0, 90), lambda bench: (bench.autopilot.target or (0, 0, 0))[1] > 1000, flying, RELATIVE
    ),
    CMD.NAV_SET_YAW_SPEED: Case(
        (90, 2), lambda bench: bench.vehicle.body.truth.velocity_east > 0.5, flying, wait=3
    ),
    CMD.DO_VTOL_TRANSITION: Case((4,), lambda bench: bench.vehicle.body.flies_forward, flying, wait=5),
    # missions and fence
    CMD.MISSION_START: Case((), in_mode("AUTO"), missioned),
    CMD.DO_SET_MISSION_CURRENT: Case((2,), lambda bench: bench.vehicle.mission.current == 2, missioned),
    CMD.DO_JUMP_TAG: Case((7,), lambda bench: bench.vehicle.mission.current >= 2, tagged),
    CMD.DO_LAND_START: Case((), in_mode("AUTO"), landable),
    CMD.DO_PAUSE_CONTINUE: Case((0,), lambda bench: bench.autopilot.mission.paused, on_mission),
    CMD.DO_FENCE_ENABLE: Case((1,), lambda bench: bench.vehicle.parameters["FENCE_ENABLE"] == 1),
    # home and what is looked at
    CMD.DO_SET_HOME: Case(
        lambda bench: (0, 0, 0, 0, *bench.at(50, 60), 500),
        lambda bench: abs(bench.autopilot.home.altitude - 500) < 0.1 and bench.autopilot.home_locked,
    ),
    CMD.GET_HOME_POSITION: Case((), sent(common.HomePosition)),
    CMD.DO_SET_ROI: Case(
        lambda bench: (0, 0, 0, 0, *bench.at(50, 60), 0),
        lambda bench: bench.autopilot.payload.region_of_interest is not None,
    ),
    CMD.DO_SET_ROI_LOCATION: Case(
        lambda bench: (0, 0, 0, 0, *bench.at(50, 60), 0),
        lambda bench: bench.autopilot.payload.region_of_interest is not None,
    ),
    CMD.DO_SET_ROI_NONE: Case(
        (),
        lambda bench: bench.autopilot.payload.region_of_interest is None,
        lambda bench: setattr(bench.autopilot.payload, "region_of_interest", (1.0, 2.0, 3.0)),
    ),
    # payload
    CMD.DO_SET_SERVO: Case((9, 1700), lambda bench: bench.autopilot.payload.servos == {9: 1700}),
    CMD.DO_REPEAT_SERVO: Case(
        (9, 1700, 3, 2), lambda bench: bench.autopilot.payload.servos == {9: 1500}, wait=1.3
    ),
    CMD.DO_SET_RELAY: Case((0, 1), lambda bench: bench.autopilot.payload.relays.get(0)),
    CMD.DO_REPEAT_RELAY: Case(
        (0, 3, 2), lambda bench: bench.autopilot.payload.relays.get(0) is False, wait=1.3
    ),
    CMD.DO_GRIPPER: Case((1, 1), lambda bench: bench.autopilot.payload.gripper_closed, fitted("GRIP_ENABLE")),
    CMD.DO_PARACHUTE: Case((2,), lambda bench: not bench.autopilot.armed, parachute_out),
    CMD.DO_WINCH: Case((1, 1, 4, 0), lambda bench: bench.autopilot.payload.winch == 4, fitted("WINCH_TYPE")),
    CMD.DO_SPRAYER: Case((1,), lambda bench: bench.autopilot.payload.sprayer, fitted("SPRAY_ENABLE")),
    CMD.IMAGE_START_CAPTURE: Case(
        (0, 0.5, 3), lambda bench: bench.autopilot.payload.images == 3, fitted("CAM1_TYPE"), wait=2
    ),
    CMD.IMAGE_STOP_CAPTURE: Case(
        (),
        lambda bench: not bench.autopilot.payload.takes_images,
        lambda bench: (fitted("CAM1_TYPE")(bench), bench.accepted(CMD.IMAGE_START_CAPTURE, 0, 1, 0)),
    ),
    CMD.VIDEO_START_CAPTURE: Case((), lambda bench: bench.autopilot.payload.recording, fitted("CAM1_TYPE")),
    CMD.VIDEO_STOP_CAPTURE: Case(
        (),
        lambda bench: not bench.autopilot.payload.recording,
        lambda bench: (fitted("CAM1_TYPE")(bench), bench.accepted(CMD.VIDEO_START_CAPTURE)),
    ),
    CMD.DO_DIGICAM_CONTROL: Case((0, 0, 0, 0, 1), sent(common.CameraImageCaptured), fitted("CAM1_TYPE")),
    CMD.DO_SET_CAM_TRIGG_DIST: Case(
        (10,), lambda bench: bench.autopilot.payload.takes_images, fitted("CAM1_TYPE")
    ),
    CMD.SET_CAMERA_ZOOM: Case((2, 30), lambda bench: bench.autopilot.payload.zoom == 30, fitted("CAM1_TYPE")),
    CMD.SET_CAMERA_FOCUS: Case(
        (2, 40), lambda bench: bench.autopilot.payload.focus == 40, fitted("CAM1_TYPE")
    ),
    CMD.DO_MOUNT_CONTROL: Case(
        (-45, 0, 0, 0, 0, 0, 2),
        lambda bench: bench.autopilot.payload.gimbal.pitch < -0.7,
        fitted("MNT1_TYPE"),
    ),
    CMD.DO_GIMBAL_MANAGER_PITCHYAW: Case(
        (-45, 30), lambda bench: bench.autopilot.payload.gimbal.yaw > 0.5, fitted("MNT1_TYPE")
    ),
    # the vehicle itself
    CMD.PREFLIGHT_REBOOT_SHUTDOWN: Case((1,), lambda bench: bench.vehicle.boots == 2),
    CMD.PREFLIGHT_CALIBRATION: Case((0, 0, 1), said("Barometer calibration complete"), wait=4),
    CMD.PREFLIGHT_STORAGE: Case(
        (2,),
        lambda bench: bench.vehicle.parameters["FENCE_RADIUS"] != 77,
        lambda bench: bench.vehicle.parameters.set("FENCE_RADIUS", 77),
    ),
    CMD.DO_MOTOR_TEST: Case((1, 0, 20, 3), lambda bench: bench.autopilot.payload.motor_tested == 1),
    CMD.DO_START_MAG_CAL: Case((), sent(ardupilotmega.MagCalProgress)),
    CMD.DO_ACCEPT_MAG_CAL: Case(
        (), lambda bench: not calibrations_of(bench.autopilot).compass_ready, calibrated
    ),
    CMD.DO_CANCEL_MAG_CAL: Case(
        (),
        lambda bench: calibrations_of(bench.autopilot).compass_started is None,
        lambda bench: bench.accepted(CMD.DO_START_MAG_CAL),
    ),
    CMD.ACCELCAL_VEHICLE_POS: Case(
        (1,),
        said("Place vehicle on its LEFT side"),
        lambda bench: bench.accepted(CMD.PREFLIGHT_CALIBRATION, 0, 0, 0, 0, 1),
    ),
    CMD.BATTERY_RESET: Case((1, 50), lambda bench: abs(bench.vehicle.body.battery.remaining - 0.5) < 0.02),
    CMD.SET_EKF_SOURCE_SET: Case((2,), said("Using EKF Source Set 2")),
    CMD.DO_AUX_FUNCTION: Case((11, 2), lambda bench: bench.vehicle.parameters["FENCE_ENABLE"] == 1),
    CMD.DO_SEND_BANNER: Case((), said("V4.6")),
    # messages
    CMD.REQUEST_MESSAGE: Case((common.Attitude.__mavlink_row__[0],), sent(common.Attitude)),
    CMD.SET_MESSAGE_INTERVAL: Case(
        (common.Attitude.__mavlink_row__[0], 50_000),
        lambda bench: sum(isinstance(message, common.Attitude) for message in bench.received) > 15,
    ),
    CMD.GET_MESSAGE_INTERVAL: Case((common.Attitude.__mavlink_row__[0],), sent(common.MessageInterval)),
    CMD.REQUEST_AUTOPILOT_CAPABILITIES: Case((1,), sent(common.AutopilotVersion)),
    CMD.REQUEST_PROTOCOL_VERSION: Case((1,), sent(common.ProtocolVersion)),
}
CASES[CMD.NAV_VTOL_TAKEOFF] = CASES[CMD.NAV_TAKEOFF]


def lose_gps(bench: ArdupilotHarness) -> None:
    bench.vehicle.body.fail_gps(True)
    bench.run_until(lambda: not bench.autopilot.has_position)
