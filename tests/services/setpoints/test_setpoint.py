from __future__ import annotations

from math import inf, nan

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import common as official

from mavstack.dialects import common
from mavstack.errors import SetpointError
from mavstack.services.setpoints import AttitudeSetpoint, GlobalSetpoint, LocalSetpoint
from tests.services.network import VEHICLE

F = common.MavFrame
number = st.floats(-1000, 1000, width=32)
axes = st.tuples(*[st.none() | number] * 3)


@pytest.mark.parametrize(
    ("setpoint", "mask"),
    [
        # The masks that PX4's and ArduPilot's documentation give as the usual ones.
        (LocalSetpoint(position=(1, 2, 3)), 0b110111111000),
        (LocalSetpoint(velocity=(1, 2, 3)), 0b110111000111),
        (LocalSetpoint(acceleration=(1, 2, 3)), 0b110000111111),
        (LocalSetpoint(position=(1, 2, 3), velocity=(0, 0, 0)), 0b110111000000),
        (LocalSetpoint(position=(1, 2, 3), yaw=0.0), 0b100111111000),
        (LocalSetpoint(velocity=(1, 2, 3), yaw_rate=0.0), 0b010111000111),
        (LocalSetpoint(acceleration=(0, 0, 9), force=True), 0b111000111111),
        (GlobalSetpoint(47.0, 8.0, 10.0), 0b110111111000),
        (AttitudeSetpoint(attitude=(1, 0, 0, 0), thrust=0.5), 0b00000111),
        (AttitudeSetpoint(rates=(0, 0, 1), thrust=0.5), 0b10000000),
        (AttitudeSetpoint(rates=(None, None, 1)), 0b11000011),
        (AttitudeSetpoint(thrust_body=(0.1, 0, 0)), 0b11100111),
    ],
)
def test_the_type_mask_names_the_fields_to_ignore(setpoint, mask):
    assert setpoint.to_message(VEHICLE).type_mask == mask


@given(axes, axes, axes, st.none() | number, st.none() | number, st.sampled_from([1, 7, 8, 9, 12]))
def test_a_local_setpoint_comes_back_as_it_was(position, velocity, acceleration, yaw, yaw_rate, frame):
    setpoint = LocalSetpoint(position, velocity, acceleration, yaw, yaw_rate, frame)
    if {*position, *velocity, *acceleration, yaw, yaw_rate} == {None}:
        with pytest.raises(SetpointError, match="at least one"):
            setpoint.to_message(VEHICLE)
    else:
        assert LocalSetpoint.read(setpoint.to_message(VEHICLE)) == setpoint


@given(st.integers(-900_000_000, 900_000_000), st.integers(-1_800_000_000, 1_800_000_000), number, axes)
def test_a_global_setpoint_comes_back_to_the_last_digit(latitude, longitude, altitude, velocity):
    setpoint = GlobalSetpoint(latitude / 1e7, longitude / 1e7, altitude, velocity)
    message = setpoint.to_message(VEHICLE)
    assert (message.lat_int, message.lon_int) == (latitude, longitude)
    assert GlobalSetpoint.read(message) == setpoint


@given(st.none() | st.just((1.0, 0.0, 0.0, 0.0)), axes, st.none() | st.just(-0.5))
def test_an_attitude_comes_back_as_it_was(attitude, rates, thrust):
    setpoint = AttitudeSetpoint(attitude, rates, thrust, (0.0, 0.5, 1.0))
    assert AttitudeSetpoint.read(setpoint.to_message(VEHICLE)) == setpoint


def test_global_frames_are_sent_as_px4_takes_them_and_read_in_both_forms():
    for meant, sent in ((F.GLOBAL, 5), (F.GLOBAL_RELATIVE_ALT, 6), (F.GLOBAL_TERRAIN_ALT, 11)):
        setpoint = GlobalSetpoint(1.0, 2.0, 3.0, frame=meant)
        message = setpoint.to_message(VEHICLE)
        assert message.coordinate_frame == sent
        assert GlobalSetpoint.read(message) == setpoint
        assert GlobalSetpoint.read(message.replace(coordinate_frame=meant)) == setpoint


def test_masks_of_pymavlinks_constants_are_read():
    mask = (
        official.POSITION_TARGET_TYPEMASK_VX_IGNORE
        | official.POSITION_TARGET_TYPEMASK_VY_IGNORE
        | official.POSITION_TARGET_TYPEMASK_VZ_IGNORE
        | official.POSITION_TARGET_TYPEMASK_AX_IGNORE
        | official.POSITION_TARGET_TYPEMASK_AY_IGNORE
        | official.POSITION_TARGET_TYPEMASK_AZ_IGNORE
        | official.POSITION_TARGET_TYPEMASK_YAW_RATE_IGNORE
    )
    message = common.SetPositionTargetLocalNed(coordinate_frame=1, type_mask=mask, x=1, vx=9, afx=9, yaw=2)
    assert LocalSetpoint.read(message) == LocalSetpoint(position=(1.0, 0.0, 0.0), yaw=2.0)


@pytest.mark.parametrize(
    "setpoint",
    [
        LocalSetpoint(),
        LocalSetpoint(position=(nan, 0, 0)),
        LocalSetpoint(velocity=(inf, 0, 0)),
        LocalSetpoint(velocity=(1e300, 0, 0)),
        LocalSetpoint(yaw=nan),
        LocalSetpoint(position=(1, 2, 3), frame=F.GLOBAL),
        LocalSetpoint(force=True),
        GlobalSetpoint(91.0, 0.0, 0.0),
        GlobalSetpoint(0.0, -181.0, 0.0),
        GlobalSetpoint(0.0, 0.0, nan),
        GlobalSetpoint(0.0, 0.0, 0.0, frame=F.LOCAL_NED),
        AttitudeSetpoint(),
        AttitudeSetpoint(attitude=(0, 0, 0, 0)),
        AttitudeSetpoint(attitude=(nan, 0, 0, 0)),
        AttitudeSetpoint(thrust=1.5),
        AttitudeSetpoint(thrust=nan),
        AttitudeSetpoint(rates=(nan, 0, 0)),
    ],
)
def test_what_no_vehicle_could_follow_is_our_own_misuse(setpoint):
    with pytest.raises(SetpointError):
        setpoint.to_message(VEHICLE)
