"""Mission items of the payload: servos, relays, gripper, winch, camera, gimbal."""

from __future__ import annotations

from math import inf, radians
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.sim.autopilot.payload import Gimbal

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.mission.rules import Step

_MIDDLE, _TRAVEL = 1500, 500
_ACTUATORS = 6
_PERCENT = 100.0


def set_servo(step: Step) -> Iterator[None]:
    """DO_SET_SERVO."""
    yield from ()
    step.autopilot.payload.set_servo(step.whole(1), step.whole(2))


def repeat_servo(step: Step) -> Iterator[None]:
    """DO_REPEAT_SERVO."""
    yield from ()
    step.autopilot.payload.repeat_servo(step.whole(1), step.whole(2), step.number(3), step.number(4))


def set_relay(step: Step) -> Iterator[None]:
    """DO_SET_RELAY."""
    yield from ()
    step.autopilot.payload.set_relay(step.whole(1), on=step.whole(2) == 1)


def repeat_relay(step: Step) -> Iterator[None]:
    """DO_REPEAT_RELAY."""
    yield from ()
    step.autopilot.payload.repeat_relay(step.whole(1), step.number(2), step.number(3))


def set_actuators(step: Step) -> Iterator[None]:
    """DO_SET_ACTUATOR: outputs from -1 to 1; NaN leaves an output unchanged."""
    yield from ()
    for index in range(1, _ACTUATORS + 1):
        value = step.number(index, inf)
        if value <= 1:
            step.autopilot.payload.set_servo(index, round(_MIDDLE + _TRAVEL * max(value, -1.0)))


def grip(step: Step) -> Iterator[None]:
    """DO_GRIPPER."""
    yield from ()
    step.autopilot.payload.grip(closed=step.whole(2) == common.GripperActions.GRAB)


def use_parachute(step: Step) -> Iterator[None]:
    """DO_PARACHUTE: disable, enable, release."""
    yield from ()
    payload, action = step.autopilot.payload, step.whole(1)
    if action == common.ParachuteAction.RELEASE:
        step.mission.later(payload.release_parachute)
    else:
        payload.parachute_enabled = action == common.ParachuteAction.ENABLE


def wind(step: Step) -> Iterator[None]:
    """DO_WINCH."""
    yield from ()
    step.autopilot.payload.wind(step.whole(2), step.number(3), step.number(4))


def spray(step: Step) -> Iterator[None]:
    """DO_SPRAYER."""
    yield from ()
    step.autopilot.payload.sprayer = step.whole(1) == 1


# Camera


def trigger_by_distance(step: Step) -> Iterator[None]:
    """DO_SET_CAM_TRIGG_DIST, OBLIQUE_SURVEY: a picture every param 1 metres; param 3 = 1 takes one now."""
    yield from ()
    payload = step.autopilot.payload
    payload.take_images_every(step.number(1))
    if step.whole(3) == 1 and step.number(1) <= 0:
        payload.take_image()


def trigger_by_time(step: Step) -> Iterator[None]:
    """DO_SET_CAM_TRIGG_INTERVAL: a picture every param 1 milliseconds."""
    yield from ()
    payload, interval = step.autopilot.payload, step.number(1) / 1000
    if interval > 0:
        payload.take_images(interval, inf)
    else:
        payload.stop_images()


def control_trigger(step: Step) -> Iterator[None]:
    """DO_TRIGGER_CONTROL: param 1 = 0 stops repeated pictures."""
    yield from ()
    if step.whole(1, default=1) == 0:
        step.autopilot.payload.stop_images()


def control_camera(step: Step) -> Iterator[None]:
    """DO_DIGICAM_CONTROL: param 5 = 1 takes a picture."""
    yield from ()
    if step.whole(5) == 1:
        step.autopilot.payload.take_image()


def start_images(step: Step) -> Iterator[None]:
    """IMAGE_START_CAPTURE: param 3 pictures (0: no limit), one every param 2 seconds."""
    yield from ()
    count = step.number(3)
    step.autopilot.payload.take_images(max(step.number(2), 0.0), count if count > 0 else inf)


def stop_images(step: Step) -> Iterator[None]:
    """IMAGE_STOP_CAPTURE."""
    yield from ()
    step.autopilot.payload.stop_images()


def start_video(step: Step) -> Iterator[None]:
    """VIDEO_START_CAPTURE."""
    yield from ()
    step.autopilot.payload.recording = True


def stop_video(step: Step) -> Iterator[None]:
    """VIDEO_STOP_CAPTURE."""
    yield from ()
    step.autopilot.payload.recording = False


def zoom(step: Step) -> Iterator[None]:
    """SET_CAMERA_ZOOM: param 2, in percent of the range."""
    yield from ()
    step.autopilot.payload.zoom = min(max(step.number(2), 0.0), _PERCENT)


def focus(step: Step) -> Iterator[None]:
    """SET_CAMERA_FOCUS."""
    yield from ()
    step.autopilot.payload.focus = min(max(step.number(2), 0.0), _PERCENT)


# Gimbal


def point_mount(step: Step) -> Iterator[None]:
    """DO_MOUNT_CONTROL: pitch, roll and yaw in degrees."""
    yield from ()
    pitch, roll, yaw = (_angle(step, index) for index in (1, 2, 3))
    step.autopilot.payload.region_of_interest = None
    step.autopilot.payload.gimbal = Gimbal(roll=roll, pitch=pitch, yaw=yaw)


def point_gimbal(step: Step) -> Iterator[None]:
    """DO_GIMBAL_MANAGER_PITCHYAW: pitch and yaw in degrees; NaN leaves an angle unchanged."""
    yield from ()
    payload = step.autopilot.payload
    now = payload.gimbal
    locked = bool(step.whole(5) & common.GimbalManagerFlags.YAW_LOCK)
    payload.region_of_interest = None
    payload.gimbal = Gimbal(
        roll=now.roll, pitch=_angle(step, 1, now.pitch), yaw=_angle(step, 2, now.yaw), yaw_locked=locked
    )


def _angle(step: Step, index: int, default: float = 0.0) -> float:
    degrees = step.number(index, inf)
    return default if degrees == inf else radians(min(max(degrees, -180.0), 180.0))
