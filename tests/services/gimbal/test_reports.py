"""The values of the gimbal protocol on the wire and back."""

from __future__ import annotations

from math import nan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, InvalidTypeError
from mavstack.services import Address
from mavstack.services.gimbal import (
    GimbalAttitude,
    GimbalInformation,
    GimbalMotion,
    GimbalSetpoint,
    GimbalStatus,
    GimbalSticks,
    angles_of,
    quaternion_of,
)

FLAGS = common.GimbalDeviceFlags
angle = st.floats(-179, 179)
optional = st.none() | st.floats(-170, 170)
TARGET = Address(1, 1)


@given(angle, st.floats(-85, 85), angle)
def test_angles_survive_the_quaternion(roll, pitch, yaw) -> None:
    assert angles_of(quaternion_of(roll, pitch, yaw)) == pytest.approx((roll, pitch, yaw), abs=1e-6)


@pytest.mark.parametrize("quaternion", [(0, 0, 0, 0), (nan, 0, 0, 0), (1, float("inf"), 0, 0)])
def test_no_rotation(quaternion) -> None:
    assert angles_of(quaternion) is None
    assert GimbalAttitude.read(common.GimbalDeviceAttitudeStatus(q=quaternion)) is None


@given(pitch=optional, yaw=optional, pitch_rate=optional, yaw_rate=optional, lock=st.booleans())
def test_setpoints_survive_both_ways(pitch, yaw, pitch_rate, yaw_rate, lock) -> None:
    setpoint = GimbalSetpoint(pitch, yaw, pitch_rate=pitch_rate, yaw_rate=yaw_rate, yaw_lock=lock)
    for read in (
        GimbalSetpoint.from_command(setpoint.to_command(0)),
        GimbalSetpoint.from_message(setpoint.to_message(TARGET, 0)),
    ):
        assert read.yaw_lock == lock
        for name in ("pitch", "yaw", "pitch_rate", "yaw_rate"):
            before = getattr(setpoint, name)
            assert getattr(read, name) == (before if before is None else pytest.approx(before, abs=1e-3))


@given(angle, st.floats(-85, 85), angle)
def test_roll_is_sent_as_an_attitude(roll, pitch, yaw) -> None:
    message = GimbalSetpoint(pitch, yaw, roll, roll_rate=5.0).to_message(TARGET, 2)
    assert isinstance(message, common.GimbalManagerSetAttitude)
    read = GimbalSetpoint.from_message(message)
    assert (read.roll, read.pitch, read.yaw) == pytest.approx((roll, pitch, yaw), abs=1e-2)
    assert read.roll_rate == pytest.approx(5.0)


@pytest.mark.parametrize(
    ("setpoint", "error"),
    [
        (GimbalSetpoint(), InvalidArgumentError),
        (GimbalSetpoint(pitch=200), InvalidArgumentError),
        (GimbalSetpoint(yaw=nan), InvalidArgumentError),
        (GimbalSetpoint(pitch="down"), InvalidTypeError),
        (GimbalSticks(pitch=1.5), InvalidArgumentError),
    ],
)
def test_senseless_setpoints_are_refused(setpoint, error) -> None:
    with pytest.raises(error):
        setpoint.check()


def test_a_command_has_no_roll() -> None:
    with pytest.raises(InvalidArgumentError, match="no roll"):
        GimbalSetpoint(roll=3.0).to_command(0)


@pytest.mark.parametrize(
    ("flags", "delta", "yaw", "heading"),
    [
        (FLAGS.YAW_IN_VEHICLE_FRAME, 0.5, 20.0, 48.65),
        (FLAGS.YAW_IN_EARTH_FRAME, 0.5, -8.65, 20.0),
        (FLAGS.YAW_IN_EARTH_FRAME | FLAGS.YAW_LOCK, nan, None, 20.0),
        (FLAGS.YAW_LOCK, 0.5, None, 20.0),
        (0, 0.5, 20.0, None),
    ],
)
def test_the_frame_of_yaw(flags, delta, yaw, heading) -> None:
    message = common.GimbalDeviceAttitudeStatus(flags=flags, q=quaternion_of(0, 0, 20), delta_yaw=delta)
    attitude = GimbalAttitude.read(message)
    assert attitude.yaw == (yaw if yaw is None else pytest.approx(yaw, abs=0.01))
    assert attitude.heading == (heading if heading is None else pytest.approx(heading, abs=0.01))


@given(angle, angle, st.none() | angle)
def test_attitudes_survive(pitch, yaw, heading) -> None:
    before = GimbalAttitude(0.0, pitch / 2.2, yaw, heading, 1.0, None, 2.0, int(FLAGS.YAW_LOCK), 2)
    after = GimbalAttitude.read(before.to_message(5, 1))
    assert after.pitch == pytest.approx(before.pitch, abs=1e-3)
    assert after.yaw == pytest.approx(yaw, abs=1e-3)
    if heading is None:
        assert after.heading is None
    else:
        assert (after.heading - heading + 180) % 360 == pytest.approx(180, abs=1e-2)
    assert (after.roll_rate, after.pitch_rate, after.failures) == (pytest.approx(1.0), None, 2)


def test_information_and_status_survive() -> None:
    information = GimbalInformation(3, 0x121, (-1, 1), (-90, 20), (-180, 180))
    read = GimbalInformation.read(information.to_message(7))
    assert (read.device_id, read.capabilities) == (3, 0x121)
    assert read.pitch_range == pytest.approx((-90, 20), abs=1e-4)
    assert information.to_device_message(0).gimbal_device_id == 3
    status = GimbalStatus(3, Address(255, 190), None, 12)
    assert GimbalStatus.read(status.to_message(1)) == status
    assert status.is_controlled_by(Address(255, 190))
    assert not status.is_controlled_by(Address(1, 1))


@given(
    st.lists(
        st.tuples(optional, optional, optional, optional, st.booleans(), st.floats(-180, 180)), max_size=20
    )
)
def test_a_gimbal_stays_within_its_ranges_and_rates(steps) -> None:
    """Any sequence of setpoints and turns of the vehicle."""
    motion, now = GimbalMotion(GimbalInformation(yaw_range=(-100, 100)), max_rate=50.0), 100.0
    before = motion.advance(now, None)
    for pitch, yaw, pitch_rate, yaw_rate, lock, heading in steps:
        motion.apply(GimbalSetpoint(pitch, yaw, None, pitch_rate, yaw_rate, yaw_lock=lock), now)
        now += 0.1
        attitude = motion.advance(now, heading)
        assert -90 <= attitude.pitch <= 30
        assert -100 - 1e-6 <= attitude.yaw <= 100 + 1e-6
        assert abs(attitude.pitch - before.pitch) <= 5.0 + 1e-6
        before = attitude
