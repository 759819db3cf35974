from __future__ import annotations

from math import inf, isnan, nan, sqrt

import numpy as np
import pytest

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, InvalidTypeError
from mavstack.services.external import Frame, PoseEstimate

FRAMES = common.MavFrame
HALF = sqrt(0.5)


def test_odometry_of_ros():
    estimate = PoseEstimate((1, 2, 3), (1, 0, 0, 0), (4, 5, 6), (0.1, 0.2, 0.3), reset_counter=7, quality=80)
    message = estimate.to_odometry(1234)
    assert (message.x, message.y, message.z) == (2, 1, -3)
    assert message.q == pytest.approx((HALF, 0, 0, HALF))
    assert (message.vx, message.vy, message.vz) == (4, -5, -6)
    assert (message.rollspeed, message.pitchspeed, message.yawspeed) == pytest.approx((0.1, -0.2, -0.3))
    assert (message.frame_id, message.child_frame_id) == (FRAMES.LOCAL_NED, FRAMES.BODY_FRD)
    assert (message.time_usec, message.reset_counter, message.quality) == (1234, 7, 80)
    assert isnan(message.pose_covariance[0])
    assert estimate.to_odometry(0, only_frd=True).frame_id == FRAMES.LOCAL_FRD
    assert PoseEstimate((1, 2, 3), frame=Frame.FLU).to_odometry(0).frame_id == FRAMES.LOCAL_FRD


def test_parts_that_are_not_known_are_nan():
    message = PoseEstimate(velocity=(1, 0, 0)).to_odometry(0)
    assert isnan(message.x)
    assert isnan(message.q[0])
    assert isnan(message.rollspeed)


def test_vision_has_a_velocity_of_the_world():
    position, speed = PoseEstimate((1, 2, 3), (1, 0, 0, 0), (2, 0, 0)).to_vision(5)
    assert (position.x, position.y, position.z, position.usec) == (2, 1, -3, 5)
    assert position.yaw == pytest.approx(1.5708, abs=1e-4)
    assert (speed.x, speed.y, speed.z) == pytest.approx((0, 2, 0), abs=1e-6)  # it looks east
    assert isnan(PoseEstimate((1, 2, 3)).to_vision(5)[0].yaw)
    with pytest.raises(InvalidArgumentError, match="needs its orientation"):
        PoseEstimate(velocity=(1, 0, 0)).to_vision(0)


def test_mocap_needs_a_whole_pose():
    message = PoseEstimate((1, 2, 3), (2, 0, 0, 0)).to_mocap(5)  # not normalised
    assert (message.x, message.y, message.z) == (2, 1, -3)
    assert message.q == pytest.approx((HALF, 0, 0, HALF))
    with pytest.raises(InvalidArgumentError, match="position and an orientation"):
        PoseEstimate((1, 2, 3)).to_mocap(5)


@pytest.mark.parametrize(
    "values",
    [
        {},
        {"position": (1, 2)},
        {"position": (1, 2, nan)},
        {"orientation": (0, 0, 0, 0)},
        {"orientation": (1e308, 1e308, 1e308, 1e308)},
        {"orientation": (1.2e308, 1.2e308, 0, 0)},
        {"orientation": (5e-324, 0, 0, 0)},
        {"orientation": (1, 0, 0)},
        {"position": (1, 2, 3), "frame": "XYZ"},
        {"position": (1, 2, 3), "body_frame": "ENU"},
        {"position": (1, 2, 3), "pose_covariance": (1.0,) * 20},
        {"position": (1, 2, 3), "reset_counter": 256},
        {"position": (1, 2, 3), "quality": 101},
    ],
)
def test_impossible_estimates_are_refused(values):
    with pytest.raises(InvalidArgumentError):
        PoseEstimate(**values)


@pytest.mark.parametrize("values", [{"reset_counter": 1.5}, {"reset_counter": 2.0}, {"quality": 50.5}])
def test_fractional_counters_are_refused(values):
    with pytest.raises(InvalidTypeError, match=f"{next(iter(values))} must be a whole number"):
        PoseEstimate((1, 2, 3), **values)


def test_covariances_of_numpy_are_taken():
    """The messages of ROS have arrays of numpy, whose truth is not defined."""
    covariance = np.diag([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).ravel()
    estimate = PoseEstimate(
        (1, 2, 3), (1, 0, 0, 0), pose_covariance=covariance, velocity_covariance=covariance
    )
    listed = PoseEstimate((1, 2, 3), (1, 0, 0, 0), pose_covariance=list(covariance), velocity_covariance=())
    assert estimate.to_odometry(1).pose_covariance == listed.to_odometry(1).pose_covariance
    assert estimate.to_odometry(1).velocity_covariance[0] == 1.0
    assert estimate.to_vision(1)[0].covariance == listed.to_vision(1)[0].covariance
    assert estimate.to_mocap(1).covariance == listed.to_mocap(1).covariance


@pytest.mark.parametrize("vector", [(nan, 0.0, 0.0), (0.0, inf, 0.0), (inf, nan, 0.0), (0.0, -inf, inf)])
def test_numbers_that_are_not_finite_are_refused(vector):
    with pytest.raises(InvalidArgumentError, match="3 finite numbers"):
        PoseEstimate(vector)
