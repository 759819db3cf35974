"""Guided flight: setpoints in every frame, mixed axes, attitudes, takeoff, and streams that end."""

from __future__ import annotations

from math import cos, pi, radians, sin

import pytest

from mavstack.dialects import common
from mavstack.services.setpoints import AttitudeSetpoint, GlobalSetpoint, LocalSetpoint
from mavstack.sim.vehicle_types import VehicleType
from tests.sim.autopilot.harness import GUIDED, HOLD, AutopilotHarness, turned
from tests.sim.autopilot.setpoints import guided, send_setpoint, stream

F = common.MavFrame


def face(flight: AutopilotHarness, yaw: float) -> None:
    """Turn to a heading."""
    place = flight.autopilot.maneuvers.place
    flight.autopilot.guided.go_to(place, yaw=yaw)
    flight.run(5)
    assert abs(turned(flight.body.truth.yaw - yaw)) < 0.1


# Positions


@pytest.mark.flight
def test_a_local_position_is_relative_to_the_origin() -> None:
    flight = guided()
    send_setpoint(flight, LocalSetpoint(position=(12.0, -8.0, -20.0), yaw=pi / 2))
    flight.run(15)
    assert flight.distance((12.0, -8.0)) < 1.0
    assert flight.height == pytest.approx(20.0, abs=1.0)
    assert flight.body.truth.yaw == pytest.approx(pi / 2, abs=0.1)


@pytest.mark.flight
def test_an_offset_is_relative_to_the_position_at_its_arrival() -> None:
    flight = guided()
    flight.autopilot.guided.go_to((20.0, 10.0, -15.0))
    flight.run(12)
    send_setpoint(flight, LocalSetpoint(position=(5.0, 5.0, -3.0), frame=F.LOCAL_OFFSET_NED))
    flight.run(10)
    assert flight.distance((25.0, 15.0)) < 1.5
    assert flight.height == pytest.approx(18.0, abs=1.0)


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("frame", [F.BODY_NED, F.BODY_OFFSET_NED])
def test_body_frames_are_relative_to_the_heading(frame: int) -> None:
    flight = guided()
    face(flight, pi / 2)
    send_setpoint(flight, LocalSetpoint(position=(10.0, 4.0, 0.0), frame=frame))
    flight.run(12)
    assert flight.distance((-4.0, 10.0)) < 1.5


@pytest.mark.flight
def test_a_yaw_in_a_body_frame_is_relative_to_the_heading() -> None:
    flight = guided()
    face(flight, 1.0)
    send_setpoint(flight, LocalSetpoint(position=(0.0, 0.0, 0.0), yaw=0.5, frame=F.BODY_OFFSET_NED))
    flight.run(5)
    assert flight.body.truth.yaw == pytest.approx(1.5, abs=0.1)


@pytest.mark.flight
def test_frames_that_the_firmware_ignores_change_nothing() -> None:
    flight = guided(setpoint_frames=frozenset({F.LOCAL_NED}))
    assert not flight.autopilot.guided.set(LocalSetpoint(position=(9.0, 0.0, 0.0), frame=F.BODY_NED))
    assert flight.autopilot.guided.command is None


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize(
    ("frame", "altitude"),
    [(F.GLOBAL, 488.0 + 22.0), (F.GLOBAL_RELATIVE_ALT, 22.0), (F.GLOBAL_TERRAIN_ALT, 22.0)],
)
def test_the_altitude_of_a_global_position_is_relative_to_the_origin_of_its_frame(
    frame: int, altitude: float
) -> None:
    flight = guided()
    latitude, longitude, _ = flight.body.frame.to_global(15.0, 20.0, 0.0)
    send_setpoint(flight, GlobalSetpoint(latitude, longitude, altitude, frame=frame))
    flight.run(15)
    assert flight.distance((15.0, 20.0)) < 1.0
    assert flight.height == pytest.approx(22.0, abs=1.0)


@pytest.mark.flight
def test_a_relative_altitude_is_relative_to_a_moved_home_too() -> None:
    flight = guided()
    latitude, longitude, _ = flight.body.frame.to_global(0.0, 0.0, 0.0)
    flight.autopilot.set_home(latitude, longitude, 488.0 + 8.0)
    send_setpoint(flight, GlobalSetpoint(latitude, longitude, 15.0))
    flight.run(10)
    assert flight.height == pytest.approx(23.0, abs=1.0)


@pytest.mark.flight_cases(1)
@pytest.mark.flight
@pytest.mark.parametrize("kind", [VehicleType.ROVER, VehicleType.BOAT, VehicleType.SUB])
def test_rovers_boats_and_submarines_reach_a_position(kind: VehicleType) -> None:
    flight = guided(kind)
    send_setpoint(flight, LocalSetpoint(position=(12.0, -6.0, 4.0)))
    flight.run(40)
    assert flight.distance((12.0, -6.0)) < 2.5
    if kind is VehicleType.SUB:
        assert flight.body.truth.down == pytest.approx(4.0, abs=0.7)


@pytest.mark.nightly
@pytest.mark.parametrize("repeated", [False, True])
def test_a_plane_flies_to_a_position_and_circles(repeated: bool) -> None:
    flight = guided(VehicleType.PLANE, 40.0)
    setpoint = LocalSetpoint(position=(400.0, 300.0, -60.0))
    send_setpoint(flight, setpoint)
    for _ in range(45):
        if repeated:
            send_setpoint(flight, setpoint)
        flight.run(1)
    for _ in range(10):
        flight.run(1)
        assert flight.distance((400.0, 300.0)) == pytest.approx(60.0, abs=20.0)
        assert flight.height == pytest.approx(60.0, abs=6.0)


@pytest.mark.nightly
def test_a_vtol_flies_to_a_far_position_on_its_wing_and_hovers_there() -> None:
    flight = guided(VehicleType.VTOL, 40.0, forward_beyond=200.0)
    flight.autopilot.guided.go_to((800.0, 0.0, -40.0))
    flight.run_until(lambda: flight.body.transition == 1.0, timeout=20)
    flight.run_until(lambda: flight.body.transition == 0.0, timeout=90)
    flight.run(40)
    assert flight.distance((800.0, 0.0)) < 2.0
    flight.autopilot.guided.go_to((750.0, 0.0, -40.0))
    flight.run(20)
    assert flight.body.transition == 0.0
    assert flight.distance((750.0, 0.0)) < 2.0


# Velocities


@pytest.mark.flight
def test_a_velocity_is_flown_until_the_setpoint_timeout() -> None:
    flight = guided(setpoint_timeout=3.0)
    send_setpoint(flight, LocalSetpoint(velocity=(3.0, -2.0, -0.5)))
    flight.run(2.8)
    motion = flight.body.truth
    assert motion.velocity_north == pytest.approx(3.0, abs=0.6)
    assert motion.velocity_east == pytest.approx(-2.0, abs=0.6)
    assert motion.velocity_down == pytest.approx(-0.5, abs=0.3)
    flight.run(5)
    assert flight.speed < 0.5
    here = flight.body.truth
    flight.run(10)
    assert flight.distance(here[:2]) < 1.0


@pytest.mark.flight
def test_a_repeated_velocity_stays_in_effect() -> None:
    flight = guided(setpoint_timeout=1.0)
    stream(flight, LocalSetpoint(velocity=(2.0, 0.0, 0.0), yaw_rate=0.3), 8.0)
    assert flight.body.truth.velocity_north == pytest.approx(2.0, abs=0.5)
    assert flight.body.truth.yaw_rate == pytest.approx(0.3, abs=0.1)


@pytest.mark.flight
def test_a_velocity_in_a_body_frame_is_relative_to_the_heading() -> None:
    flight = guided()
    face(flight, pi / 2)
    stream(flight, LocalSetpoint(velocity=(2.0, 0.0, 0.0), frame=F.BODY_NED), 4.0)
    assert flight.body.truth.velocity_east == pytest.approx(2.0, abs=0.5)
    assert abs(flight.body.truth.velocity_north) < 0.5


@pytest.mark.flight
def test_velocities_of_a_global_setpoint_are_north_east_down() -> None:
    flight = guided()
    face(flight, pi / 2)
    stream(flight, GlobalSetpoint(velocity=(2.0, 0.0, 0.0)), 4.0)
    assert flight.body.truth.velocity_north == pytest.approx(2.0, abs=0.5)


@pytest.mark.flight
def test_a_position_with_a_velocity_is_followed_while_it_moves() -> None:
    flight = guided()
    for step in range(60):
        setpoint = LocalSetpoint(position=(step * 0.2, 5.0, -15.0), velocity=(2.0, 0.0, 0.0))
        stream(flight, setpoint, 0.1)
    assert flight.body.truth.north == pytest.approx(12.0, abs=1.5)
    assert flight.body.truth.east == pytest.approx(5.0, abs=1.0)


@pytest.mark.flight
def test_axes_may_be_mixed() -> None:
    flight = guided()
    stream(flight, LocalSetpoint(position=(None, None, -18.0), velocity=(1.5, 0.0, None)), 8.0)
    assert flight.height == pytest.approx(18.0, abs=1.0)
    assert flight.body.truth.velocity_north == pytest.approx(1.5, abs=0.4)


@pytest.mark.flight
def test_an_acceleration_changes_the_velocity() -> None:
    flight = guided()
    stream(flight, LocalSetpoint(acceleration=(1.0, 0.0, 0.0)), 4.0)
    assert flight.body.truth.velocity_north == pytest.approx(4.0, abs=1.2)


@pytest.mark.flight
def test_a_heading_alone_turns_the_vehicle_in_place() -> None:
    flight = guided()
    stream(flight, LocalSetpoint(yaw=2.0), 5.0)
    assert flight.body.truth.yaw == pytest.approx(2.0, abs=0.1)
    assert flight.distance() < 1.5


def test_a_rover_turns_along_with_its_velocity() -> None:
    flight = guided(VehicleType.ROVER)
    stream(flight, LocalSetpoint(velocity=(1.5, 0.0, 0.0), yaw_rate=0.5, frame=F.BODY_NED), 6.0)
    motion = flight.body.truth
    along = motion.velocity_north * cos(motion.yaw) + motion.velocity_east * sin(motion.yaw)
    assert along == pytest.approx(1.5, abs=0.4)
    assert motion.yaw_rate == pytest.approx(0.5, abs=0.15)


# Attitudes


def lean(roll: float, pitch: float, yaw: float = 0.0) -> tuple[float, float, float, float]:
    cr, cp, cy = cos(roll / 2), cos(pitch / 2), cos(yaw / 2)
    sr, sp, sy = sin(roll / 2), sin(pitch / 2), sin(yaw / 2)
    return (
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    )


@pytest.mark.flight
def test_an_attitude_is_flown_with_its_thrust() -> None:
    flight = guided(setpoint_timeout=1.0)
    stream(flight, AttitudeSetpoint(lean(0.1, -0.15, 0.6), thrust=0.55), 2.0)
    motion = flight.body.truth
    assert motion.roll == pytest.approx(0.1, abs=0.05)
    assert motion.pitch == pytest.approx(-0.15, abs=0.05)
    assert motion.yaw == pytest.approx(0.6, abs=0.1)
    assert motion.velocity_down < -0.5
    flight.run(6)
    assert flight.speed < 0.5


@pytest.mark.fast_cases(2)
@pytest.mark.parametrize(("thrust", "climb"), [(0.5, 0.0), (0.9, 2.0), (0.2, -1.5)])
def test_thrust_is_a_climb_rate_for_some_firmwares(thrust: float, climb: float) -> None:
    flight = guided(height=30.0, thrust_is_climb=True, setpoint_timeout=1.0)
    stream(flight, AttitudeSetpoint(lean(0.0, 0.0), thrust=thrust), 5.0)
    assert flight.body.truth.velocity_down == pytest.approx(-climb, abs=0.35)


@pytest.mark.flight
def test_body_rates_are_flown() -> None:
    flight = guided()
    stream(flight, AttitudeSetpoint(rates=(0.0, 0.0, 0.7), thrust=0.5), 2.0)
    assert flight.body.truth.yaw_rate == pytest.approx(0.7, abs=0.15)


@pytest.mark.flight
def test_a_rover_drives_at_a_share_of_its_speed_to_a_heading() -> None:
    flight = guided(VehicleType.ROVER)
    stream(flight, AttitudeSetpoint(lean(0.0, 0.0, radians(90)), thrust=0.5), 8.0)
    assert flight.body.truth.velocity_east == pytest.approx(1.5, abs=0.4)


# Other modes, and vehicles on the ground


@pytest.mark.flight
def test_setpoints_are_not_followed_in_other_modes() -> None:
    flight = guided()
    flight.enter(HOLD)
    stream(flight, LocalSetpoint(velocity=(3.0, 0.0, 0.0)), 3.0)
    assert flight.distance() < 1.5


@pytest.mark.fast_cases(2)
@pytest.mark.parametrize("kind", [VehicleType.COPTER, VehicleType.PLANE, VehicleType.VTOL])
def test_on_the_ground_only_a_take_off_is_followed(kind: VehicleType) -> None:
    flight = AutopilotHarness(kind)
    flight.arm()
    flight.enter(GUIDED)
    flight.autopilot.guided.go_to((20.0, 0.0, -20.0))
    flight.run(4)
    assert flight.height == 0.0
    flight.autopilot.guided.take_off(30.0)
    flight.run_until(lambda: flight.height > 25.0, timeout=60)


@pytest.mark.flight
def test_guided_takes_off_then_follows_the_target() -> None:
    flight = AutopilotHarness()
    flight.arm()
    flight.enter(GUIDED)
    flight.autopilot.guided.take_off(10.0)
    flight.run(1)
    assert flight.autopilot.landed_state == common.MavLandedState.TAKEOFF
    flight.run(12)
    assert flight.height == pytest.approx(10.0, abs=1.0)
    assert flight.autopilot.landed_state == common.MavLandedState.IN_AIR
    flight.autopilot.guided.go_to((10.0, 0.0, -10.0), yaw=1.0, speed=2.0)
    flight.run(3)
    assert flight.speed < 2.5
    flight.run(8)
    assert flight.distance((10.0, 0.0)) < 1.0


@pytest.mark.flight
def test_a_vehicle_flown_into_the_ground_stays_there_and_disarms() -> None:
    flight = guided(height=5.0)
    for _ in range(20):
        send_setpoint(flight, LocalSetpoint(velocity=(0.0, 0.0, 1.0)))
        flight.run(0.5)
    assert flight.height == 0.0
    flight.run_until(lambda: not flight.autopilot.armed, timeout=15)


# Streams that must continue
