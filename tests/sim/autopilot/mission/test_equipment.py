"""Items for equipment: servos, relays, actuators, grippers, winches, parachutes, cameras and gimbals."""

from __future__ import annotations

from math import inf, nan, radians

import pytest

from mavstack.dialects import common
from mavstack.sim.vehicle_types import Firmware
from tests.sim.autopilot.mission.harness import (
    CMD,
    MissionHarness,
    fly_items,
    fly_short_mission,
    item,
    land,
    takeoff,
    waypoint,
)

ARDUPILOT, PX4 = Firmware.ARDUPILOT, Firmware.PX4


@pytest.mark.flight
def test_servos_and_relays() -> None:
    payload = fly_short_mission(
        item(CMD.DO_SET_SERVO, 9, 1900), item(CMD.DO_SET_RELAY, 2, 1)
    ).autopilot.payload
    assert payload.servos == {9: 1900}
    assert payload.relays == {2: True}


@pytest.mark.flight
def test_servos_and_relays_to_and_fro() -> None:
    flight = fly_items(
        item(CMD.DO_REPEAT_SERVO, 9, 1900, 2, 2), item(CMD.DO_REPEAT_RELAY, 1, 2, 2), item(CMD.NAV_DELAY, 60)
    )
    servos, relays = [], []
    for _ in range(50):
        flight.run(0.1)
        servos.append(flight.autopilot.payload.servos.get(9))
        relays.append(flight.autopilot.payload.relays.get(1))
    assert [value for at, value in enumerate(servos) if at and servos[at - 1] != value][:3] == [
        1500,
        1900,
        1500,
    ]
    assert [value for at, value in enumerate(relays) if at and relays[at - 1] != value][-3:] == [
        False,
        True,
        False,
    ]


@pytest.mark.flight
def test_actuators() -> None:
    flight = fly_short_mission(item(CMD.DO_SET_ACTUATOR, 1, -1, nan, 0.5, nan, nan), firmware=PX4)
    assert flight.autopilot.payload.servos == {1: 2000, 2: 1000, 4: 1750}


@pytest.mark.parametrize("firmware", list(Firmware))
def test_gripper_and_winch(firmware: Firmware) -> None:
    payload = fly_short_mission(
        item(CMD.DO_GRIPPER, 1, common.GripperActions.GRAB), item(CMD.DO_WINCH, 1, 1, 3, 1), firmware=firmware
    ).autopilot.payload
    assert payload.gripper_closed
    assert payload.winch == pytest.approx(3)


def test_sprayer_parachute_and_functions() -> None:
    payload = fly_short_mission(
        item(CMD.DO_SPRAYER, 1),
        item(CMD.DO_PARACHUTE, 1),
        item(CMD.DO_AUX_FUNCTION, 28, 2),
        item(CMD.DO_AUX_FUNCTION, 19, 2),
        item(CMD.DO_AUX_FUNCTION, 9, 2),
    ).autopilot.payload
    assert payload.sprayer
    assert payload.parachute_enabled
    assert payload.relays == {0: True}
    assert payload.gripper_closed
    assert payload.images == 1


def test_the_parachute_ends_the_flight() -> None:
    flight = fly_items(item(CMD.DO_PARACHUTE, 1), item(CMD.DO_PARACHUTE, 2), waypoint(50, 0, 10))
    flight.run_until(lambda: not flight.autopilot.armed, timeout=10)
    assert flight.autopilot.payload.parachute_released


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("firmware", list(Firmware))
def test_pictures_by_distance(firmware: Firmware) -> None:
    flight = fly_items(
        item(CMD.DO_SET_CAM_TRIGG_DIST, 10), waypoint(50, 0, 10), item(CMD.DO_SET_CAM_TRIGG_DIST, 0),
        waypoint(0, 0, 10), firmware=firmware,
    )  # fmt: skip
    flight.ended()
    assert flight.autopilot.payload.images in (5, 6)
    pictures = [message for message in flight.sent if isinstance(message, common.CameraImageCaptured)]
    assert [picture.image_index for picture in pictures] == list(range(len(pictures)))


@pytest.mark.flight
def test_pictures_by_time() -> None:
    flight = fly_items(
        item(CMD.IMAGE_START_CAPTURE, 0, 2, 0, nan),
        item(CMD.NAV_DELAY, 9),
        item(CMD.IMAGE_STOP_CAPTURE),
        item(CMD.NAV_DELAY, 9),
        firmware=PX4,
    )
    flight.ended()
    assert flight.autopilot.payload.images == 5
    flight = fly_short_mission(
        item(CMD.DO_SET_CAM_TRIGG_INTERVAL, 500), item(CMD.NAV_DELAY, 2.2), firmware=PX4
    )
    assert flight.autopilot.payload.images >= 5


@pytest.mark.flight
def test_a_few_pictures_one_picture_and_video() -> None:
    payload = fly_short_mission(
        item(CMD.IMAGE_START_CAPTURE, 0, 0.1, 3), item(CMD.NAV_DELAY, 2)
    ).autopilot.payload
    assert payload.images == 3
    assert fly_short_mission(item(CMD.DO_DIGICAM_CONTROL, 0, 0, 0, 0, 1)).autopilot.payload.images == 1
    assert fly_short_mission(item(CMD.VIDEO_START_CAPTURE)).autopilot.payload.recording
    assert not fly_short_mission(
        item(CMD.VIDEO_START_CAPTURE), item(CMD.VIDEO_STOP_CAPTURE)
    ).autopilot.payload.recording
    payload = fly_short_mission(
        item(CMD.SET_CAMERA_ZOOM, 2, 40), item(CMD.SET_CAMERA_FOCUS, 2, 60)
    ).autopilot.payload
    assert (payload.zoom, payload.focus) == (40, 60)


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("firmware", list(Firmware))
def test_the_gimbal(firmware: Firmware) -> None:
    gimbal = fly_short_mission(
        item(CMD.DO_MOUNT_CONTROL, -45, 5, 30), firmware=firmware
    ).autopilot.payload.gimbal
    assert (gimbal.pitch, gimbal.roll, gimbal.yaw) == pytest.approx(
        [radians(angle) for angle in (-45, 5, 30)]
    )
    manager = item(CMD.DO_GIMBAL_MANAGER_PITCHYAW, -20, nan, nan, nan)
    gimbal = fly_short_mission(
        item(CMD.DO_MOUNT_CONTROL, -45, 5, 30), manager, firmware=firmware
    ).autopilot.payload.gimbal
    assert (gimbal.pitch, gimbal.yaw) == pytest.approx((radians(-20), radians(30)))


def test_px4_disarms_by_an_item() -> None:
    flight = MissionHarness(firmware=PX4, disarm_delay=inf, land_disarm_delay=inf)
    flight.load(takeoff(4), land(), item(CMD.COMPONENT_ARM_DISARM, 0))
    flight.start()
    flight.run_until(lambda: not flight.autopilot.armed, timeout=60)
