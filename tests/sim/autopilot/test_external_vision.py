"""External vision in the estimators of simulated vehicles of both firmwares."""

from __future__ import annotations

from math import cos, hypot, radians, sin
from typing import TYPE_CHECKING

import pytest

from mavstack.dialects import common
from mavstack.services.external import Frame, PoseEstimate
from mavstack.sim.ardupilot.arming import prearm_problems
from tests.sim.harness import SimulationHarness, VehicleHarness

if TYPE_CHECKING:
    from mavstack.sim.motion.readings import EstimateHealth

#: Parameters that let each firmware fly by vision alone.
VISION = {
    "ardupilot": {
        "VISO_TYPE": 1, "EK3_SRC1_POSXY": 6, "EK3_SRC1_VELXY": 6, "EK3_SRC1_POSZ": 6, "EK3_SRC1_YAW": 6,
        "GPS1_TYPE": 0,
    },
    "px4": {"EKF2_EV_CTRL": 15, "EKF2_GPS_CTRL": 0, "EKF2_HGT_REF": 3, "SYS_HAS_GPS": 0},
}  # fmt: skip


def vehicle(firmware: str, **changes: float) -> VehicleHarness:
    """Return a copter on the ground that has booted with the parameters of vision."""
    one = SimulationHarness().add("copter", firmware, **(VISION[firmware] | changes))
    if firmware == "px4":
        one.vehicle.body.fail_gps()
    one.vehicle.reboot()
    one.without_telemetry()
    return one.run(2)


def see(one: VehicleHarness, seconds: float, *, north: float = 0.0, **fields: float) -> VehicleHarness:
    """Send estimates ten times a second: the truth, moved north."""

    def odometry() -> common.Odometry:
        truth = one.vehicle.body.truth
        q = (1.0, 0.0, 0.0, 0.0)
        estimate = PoseEstimate(
            (truth.north + north, truth.east, truth.down), q, frame=Frame.NED, body_frame=Frame.FRD
        )
        message = estimate.to_odometry(
            round(one.vehicle.now * 1e6), only_frd=one.vehicle.firmware == "ardupilot"
        )
        yaw = truth.yaw / 2
        return message.replace(q=(cos(yaw), 0.0, 0.0, sin(yaw)), **fields)

    return one.run(seconds, lambda: one.send(odometry()))


def origin(one: VehicleHarness) -> None:
    one.send(common.SetGpsGlobalOrigin(target_system=1, latitude=470_000_000, longitude=85_000_000))


def health(one: VehicleHarness) -> EstimateHealth:
    return one.vehicle.body.health


def miss(one: VehicleHarness) -> float:
    """Return the metres between the estimate and the truth."""
    truth, estimate = one.vehicle.body.truth, one.vehicle.body.estimate
    return hypot(truth.north - estimate.north, truth.east - estimate.east)


@pytest.mark.parametrize("firmware", VISION)
def test_a_vehicle_without_gps_knows_its_place_by_vision(firmware):
    one = vehicle(firmware)
    one.run(10)
    assert not one.autopilot.has_position
    see(one, 5)
    assert not one.autopilot.has_position  # it has no origin
    origin(one)
    see(one, 3)
    assert one.autopilot.has_position
    assert health(one).horizontal
    assert miss(one) < 0.1
    see(one, 0.5, north=1.0)
    see(one, 3, north=1.0)
    assert miss(one) == pytest.approx(1.0, abs=0.2)  # it believes what it sees
    one.run(10)
    assert not one.autopilot.has_position


@pytest.mark.parametrize("firmware", VISION)
def test_a_jump_counts_with_a_new_reset_counter_or_after_a_second(firmware):
    one = vehicle(firmware)
    origin(one)
    see(one, 3)
    see(one, 0.6, north=10.0)
    assert miss(one) < 0.2
    see(one, 0.2)
    see(one, 0.2, north=10.0, reset_counter=1)
    assert miss(one) == pytest.approx(10.0, abs=0.2)
    see(one, 0.5, reset_counter=1)
    assert miss(one) > 9
    see(one, 1.5, reset_counter=1)
    assert miss(one) < 9


def test_ardupilot_reports_the_use_and_does_not_arm_without():
    one = vehicle("ardupilot").run(3)
    assert "VisOdom: not healthy" in list(prearm_problems(one.autopilot))
    origin(one)
    see(one, 2)
    assert "VisOdom: not healthy" not in list(prearm_problems(one.autopilot))
    assert "EKF3 IMU0 is using external nav data" in one.texts
    one.run(1)
    assert "EKF3 IMU0 stopped aiding" in one.texts


@pytest.mark.parametrize("changes", [{"VISO_TYPE": 0}, {"EK3_SRC1_POSXY": 3}])
def test_ardupilot_ignores_vision_without_its_parameters(changes):
    one = vehicle("ardupilot", **changes)
    origin(one)
    see(one, 8)
    assert not one.autopilot.has_position


@pytest.mark.parametrize(
    "fields",
    [
        {"frame_id": common.MavFrame.LOCAL_NED},
        {"child_frame_id": common.MavFrame.BODY_NED},
        {"quality": -1},
    ],
)
def test_ardupilot_takes_odometry_in_one_form(fields):
    one = vehicle("ardupilot")
    see(one, 2, **fields)
    assert one.autopilot.vision.received_at is None
    see(one, 1)
    assert one.autopilot.vision.aids_position


def test_px4_drops_what_its_parameters_exclude():
    one = vehicle("px4", EKF2_EV_QMIN=50)
    see(one, 1, quality=49)
    assert not one.autopilot.vision.aids_position
    see(one, 1, quality=50)
    assert one.autopilot.vision.aids_position
    one.set(EKF2_EV_CTRL=0).run(1)
    see(one, 1, quality=50)
    assert not one.autopilot.vision.aids_position


def test_px4_drops_what_is_too_old_by_its_clock():
    one = vehicle("px4")
    answers: list[common.Timesync] = []

    def answer() -> None:
        """Answer the requests of the vehicle with a clock that is 1000 s ahead."""
        for message in one.received:
            if isinstance(message, common.Timesync) and not message.tc1:
                tc1 = round((one.vehicle.now + 1000) * 1e9)
                answers.append(message)
                one.send(common.Timesync(tc1=tc1, ts1=message.ts1, target_system=1, target_component=1))
        one.received.clear()

    one.receiving = True
    see(one, 0.5)
    for _ in range(30):
        answer()
        one.run(0.1)
    assert answers
    ahead = 1000.0
    see(one, 0.5, time_usec=round((one.vehicle.now + ahead - 0.3) * 1e6))
    assert not one.autopilot.vision.aids_position
    see(one, 0.1, time_usec=round((one.vehicle.now + ahead - 0.1) * 1e6))
    assert one.autopilot.vision.aids_position


def test_the_heading_follows_vision():
    one = vehicle("ardupilot")
    one.vehicle.body.offset_compass(radians(20))
    see(one, 10)
    truth, estimate = one.vehicle.body.truth, one.vehicle.body.estimate
    assert abs(truth.yaw - estimate.yaw) < radians(3)
    one.set(EK3_SRC1_YAW=1)
    see(one, 10)
    assert abs(truth.yaw - one.vehicle.body.estimate.yaw) > radians(15)


def test_speeds_keep_the_position():
    one = vehicle("px4", EKF2_EV_CTRL=4)
    origin(one)
    one.run(12, lambda: one.send(common.VisionSpeedEstimate(round(one.vehicle.now * 1e6))))
    assert one.autopilot.has_position
    one.run(12, lambda: one.send(common.AttPosMocap()))
    assert not one.autopilot.has_position
