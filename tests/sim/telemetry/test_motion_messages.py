"""Message contents: units, signs, frames and markers, against the body's true and estimated motion."""

from __future__ import annotations

from math import asin, atan2, degrees, hypot, isnan, pi

import pytest

from mavstack.dialects import ardupilotmega as dialect
from mavstack.dialects import common
from mavstack.sim.vehicle_types import Firmware, VehicleType
from tests.sim.telemetry.flight import Flight

PX4, ARDUPILOT = Firmware.PX4, Firmware.ARDUPILOT
BIT = common.MavSysStatusSensor
EKF = dialect.EkfStatusFlags


@pytest.fixture(scope="module", params=list(Firmware))
def flying(request):
    """A copter in flight, tilted and not facing north."""
    flight = Flight(VehicleType.COPTER, request.param).fly()
    flight.body.go_to(80.0, 60.0, -30.0, speed=8.0)
    flight.run(4.0)
    return flight


def _request(flight: Flight, message_type: type, *, number: int | None = None):
    """Return the message as it is now, in the same step."""
    flight.packets.clear()
    flight.command(common.MavCmd.REQUEST_MESSAGE, number or message_type.__mavlink_row__[0])
    flight.vehicle._settle()
    for _, data in flight.vehicle.data_to_send():
        for packet in flight._parser.feed(data, flight.now):
            if isinstance(packet.message, message_type):
                return packet.message
    raise AssertionError(f"no {message_type.__name__}")


@pytest.mark.fast_cases(1)
def test_attitude_and_rates(flying):
    message, estimate = _request(flying, common.Attitude), flying.body.estimate
    assert (message.roll, message.pitch, message.yaw) == pytest.approx(
        (estimate.roll, estimate.pitch, estimate.yaw), abs=1e-5
    )
    assert message.rollspeed == pytest.approx(estimate.roll_rate, abs=1e-5)
    assert hypot(message.roll, message.pitch) > 0.01
    assert message.time_boot_ms == flying.vehicle.uptime_ms


def test_quaternion_matches_the_attitude(flying):
    message, estimate = _request(flying, common.AttitudeQuaternion), flying.body.estimate
    w, x, y, z = message.q1, message.q2, message.q3, message.q4
    assert w * w + x * x + y * y + z * z == pytest.approx(1.0, abs=1e-5)
    assert atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)) == pytest.approx(estimate.roll, abs=1e-4)
    assert asin(2 * (w * y - z * x)) == pytest.approx(estimate.pitch, abs=1e-4)
    assert atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)) == pytest.approx(estimate.yaw, abs=1e-4)


@pytest.mark.fast_cases(1)
def test_global_position(flying):
    message, estimate = _request(flying, common.GlobalPositionInt), flying.body.estimate
    north, east, down = flying.body.frame.to_local(message.lat / 1e7, message.lon / 1e7, message.alt / 1e3)
    assert (north, east, down) == pytest.approx((estimate.north, estimate.east, estimate.down), abs=0.02)
    assert message.relative_alt / 1e3 == pytest.approx(flying.vehicle.autopilot.altitude, abs=0.01)
    assert (message.vx, message.vy, message.vz) == pytest.approx(
        (estimate.velocity_north * 100, estimate.velocity_east * 100, estimate.velocity_down * 100), abs=1
    )
    assert message.hdg / 100 == pytest.approx(degrees(estimate.yaw) % 360.0, abs=0.01)


def test_local_position(flying):
    message, estimate = _request(flying, common.LocalPositionNed), flying.body.estimate
    assert (message.x, message.y, message.z) == pytest.approx(estimate[:3], abs=1e-3)
    assert (message.vx, message.vy, message.vz) == pytest.approx(estimate[3:6], abs=1e-3)


def test_vfr_hud(flying):
    message, estimate = _request(flying, common.VfrHud), flying.body.estimate
    assert message.groundspeed == pytest.approx(
        hypot(estimate.velocity_north, estimate.velocity_east), abs=1e-3
    )
    assert message.climb == pytest.approx(-estimate.velocity_down, abs=1e-3)
    assert message.alt == pytest.approx(flying.body.frame.altitude - estimate.down, abs=0.01)
    assert message.heading == int(degrees(estimate.yaw) % 360.0)
    assert message.throttle == pytest.approx(flying.body.throttle * 100.0, abs=1.0)
    assert message.throttle > 10
    assert isnan(message.airspeed) == (flying.vehicle.firmware is PX4)


def test_inertial_readings(flying):
    readings = flying.body.sensors
    scaled = _request(flying, common.ScaledImu2)
    assert scaled.zacc / 1000 * 9.80665 == pytest.approx(readings.acceleration_z, abs=0.01)
    assert scaled.xmag / 1000 == pytest.approx(readings.magnetic_x, abs=0.001)
    assert scaled.zacc < -500
    highres = _request(flying, common.HighresImu)
    assert (highres.xacc, highres.zgyro, highres.ymag) == pytest.approx(
        (readings.acceleration_x, readings.gyro_z, readings.magnetic_y), abs=1e-4
    )
    assert highres.abs_pressure == pytest.approx(readings.pressure, abs=0.01)
    ground = flying.body.frame.altitude
    assert highres.pressure_alt == pytest.approx(ground - flying.body.truth.down, abs=25.0)


def test_gps_raw(flying):
    message, readings = _request(flying, common.GpsRawInt), flying.body.sensors
    assert message.fix_type == readings.gps_fix >= 3
    assert (message.lat, message.lon) == (
        round(readings.gps_latitude * 1e7),
        round(readings.gps_longitude * 1e7),
    )
    assert message.vel == pytest.approx(
        hypot(readings.gps_velocity_north, readings.gps_velocity_east) * 100, abs=1
    )
    assert 0 <= message.cog < 36000
    assert message.h_acc == pytest.approx(readings.gps_eph * 1000, abs=1)
    assert 30 <= message.eph <= 300
    expected = flying.now if flying.vehicle.firmware is PX4 else flying.vehicle.uptime
    assert message.time_usec == pytest.approx(expected * 1e6, abs=1000)


def test_battery(flying):
    message, battery = _request(flying, common.BatteryStatus), flying.body.battery
    assert sum(cell for cell in message.voltages if cell != 65535) == pytest.approx(
        battery.voltage * 1000, abs=1
    )
    assert message.voltages[1:] == (65535,) * 9
    assert message.current_battery == pytest.approx(battery.current * 100, abs=1)
    assert message.current_battery > 100
    assert message.current_consumed == pytest.approx(battery.consumed, abs=1)
    assert message.time_remaining == pytest.approx(
        battery.remaining * battery.capacity * 3.6 / battery.current, rel=0.01
    )
    assert message.charge_state == common.MavBatteryChargeState.OK
    status = _request(flying, common.SysStatus)
    assert status.voltage_battery == pytest.approx(battery.voltage * 1000, abs=1)
    assert status.battery_remaining == round(battery.remaining * 100)


def test_servos_and_channels(flying):
    message = _request(flying, common.ServoOutputRaw)
    outputs = [getattr(message, f"servo{number}_raw") for number in range(1, 17)]
    assert outputs == [round(pulse) for pulse in flying.body.servos]
    assert message.servo1_raw > 1100
    if flying.vehicle.firmware is ARDUPILOT:
        sticks = _request(flying, common.RcChannels)
        assert sticks.chancount == 16
        channels = [getattr(sticks, f"chan{number}_raw") for number in range(1, 19)]
        assert tuple(channels) == flying.vehicle.autopilot.radio.channels
        assert sticks.rssi == flying.vehicle.autopilot.radio.rssi


def test_home_and_origin(flying):
    home = flying.vehicle.autopilot.home
    message = _request(flying, common.HomePosition)
    assert (message.latitude, message.longitude) == (round(home.latitude * 1e7), round(home.longitude * 1e7))
    assert message.altitude == pytest.approx(home.altitude * 1e3, abs=1)
    origin = _request(flying, common.GpsGlobalOrigin)
    assert origin.latitude == round(flying.body.frame.latitude * 1e7)


def test_position_target(flying):
    autopilot = flying.vehicle.autopilot
    autopilot.target = (100.0, 0.0, -40.0)
    message = _request(flying, common.PositionTargetGlobalInt)
    autopilot.target = None
    position = flying.body.frame.to_local(message.lat_int / 1e7, message.lon_int / 1e7, message.alt)
    assert position == pytest.approx((100.0, 0.0, -40.0), abs=0.05)
    assert not message.type_mask & 7


def test_landed_state(flying):
    assert (
        _request(flying, common.ExtendedSysState).landed_state == flying.vehicle.autopilot.landed_state != 1
    )


# States


@pytest.mark.parametrize("firmware", Firmware)
def test_before_the_first_position(firmware):
    flight = Flight(VehicleType.COPTER, firmware)
    flight.run(0.5)
    if firmware is PX4:
        assert flight.rates(1.0)["GlobalPositionInt"] == 0
    else:
        message = _request(flight, common.GlobalPositionInt)
        assert (message.lat, message.lon) == (0, 0)
        assert _request(flight, dialect.EkfStatusReport).flags & EKF.UNINITIALIZED


@pytest.mark.flight
def test_gps_loss():
    flight = Flight(VehicleType.COPTER, ARDUPILOT).fly(8.0)
    good = _request(flight, common.SysStatus).onboard_control_sensors_health
    flight.body.fail_gps(True)
    flight.run(20.0)
    raw = _request(flight, common.GpsRawInt)
    assert raw.fix_type <= 1
    assert (raw.eph, raw.epv, raw.vel, raw.cog) == (65535,) * 4
    status = _request(flight, common.SysStatus)
    assert status.onboard_control_sensors_health == good & ~BIT.SENSOR_GPS
    assert status.onboard_control_sensors_present & BIT.SENSOR_GPS
    flags = _request(flight, dialect.EkfStatusReport).flags
    assert flags & EKF.CONST_POS_MODE
    assert not flags & (EKF.POS_HORIZ_ABS | EKF.PRED_POS_HORIZ_ABS)
    assert flags & EKF.ATTITUDE


@pytest.mark.nightly
@pytest.mark.flight
def test_px4_stops_global_position_without_gps():
    flight = Flight(VehicleType.COPTER, PX4).fly(8.0)
    flight.body.fail_gps(True)
    flight.run(20.0)
    counts = flight.rates(2.0)
    assert counts["GlobalPositionInt"] == 0
    assert counts["LocalPositionNed"] > 0
    assert not _request(flight, common.EstimatorStatus).flags & EKF.POS_HORIZ_ABS


def test_inconsistent_compass():
    flight = Flight(VehicleType.COPTER, ARDUPILOT)
    flight.run(3.0)
    flight.body.offset_compass(pi / 2)
    flight.run(5.0)
    assert not _request(flight, common.SysStatus).onboard_control_sensors_health & BIT.SENSOR_3D_MAG


def test_prearm_failure_is_reported():
    flight = Flight(VehicleType.COPTER, ARDUPILOT)
    flight.run(3.0)
    assert _request(flight, common.SysStatus).onboard_control_sensors_health & BIT.PREARM_CHECK
    flight.vehicle.profile.problems.append("PreArm: something")
    flight.run(1.5)
    assert not _request(flight, common.SysStatus).onboard_control_sensors_health & BIT.PREARM_CHECK


def test_radio_off():
    flight = Flight(VehicleType.COPTER, ARDUPILOT)
    flight.run(3.0)
    assert _request(flight, common.SysStatus).onboard_control_sensors_health & BIT.SENSOR_RC_RECEIVER
    flight.vehicle.autopilot.radio.switch(False)
    assert not _request(flight, common.SysStatus).onboard_control_sensors_health & BIT.SENSOR_RC_RECEIVER
    assert _request(flight, common.RcChannels).chan1_raw == 0


def test_px4_has_no_receiver_without_manual_control():
    flight = Flight(VehicleType.COPTER, PX4)
    flight.run(3.0)
    status = _request(flight, common.SysStatus)
    assert not status.onboard_control_sensors_present & BIT.SENSOR_RC_RECEIVER
    assert flight.rates(2.0)["RcChannels"] == 0


@pytest.mark.parametrize(
    ("left", "state"), [(0.5, "OK"), (0.12, "LOW"), (0.06, "CRITICAL"), (0.02, "EMERGENCY")]
)
def test_px4_battery_charge_state(left, state):
    flight = Flight(VehicleType.COPTER, PX4)
    flight.run(1.0)
    flight.body.recharge(left)
    flight.run(0.5)
    assert _request(flight, common.BatteryStatus).charge_state == common.MavBatteryChargeState[state]


@pytest.mark.parametrize(("low", "critical", "state"), [(0, 0, "OK"), (99, 0, "LOW"), (99, 98, "CRITICAL")])
def test_ardupilot_charge_state_follows_the_voltage(low, critical, state):
    flight = Flight(VehicleType.COPTER, ARDUPILOT, BATT_LOW_VOLT=low, BATT_CRT_VOLT=critical)
    flight.run(1.0)
    assert _request(flight, common.BatteryStatus).charge_state == common.MavBatteryChargeState[state]


@pytest.mark.nightly
def test_vtol_state():
    flight = Flight(VehicleType.VTOL, PX4).fly(20.0)
    state = common.MavVtolState
    assert _request(flight, common.ExtendedSysState).vtol_state == state.MC
    flight.body.transition_to(True)
    flight.body.fly_velocity(20.0, 0.0, 0.0)
    flight.run(0.2)
    assert _request(flight, common.ExtendedSysState).vtol_state == state.TRANSITION_TO_FW
    flight.run_until(lambda: flight.body.transition >= 1.0, timeout=40.0)
    assert _request(flight, common.ExtendedSysState).vtol_state == state.FW
    flight.body.transition_to(False)
    flight.run(0.2)
    assert _request(flight, common.ExtendedSysState).vtol_state == state.TRANSITION_TO_MC


@pytest.mark.parametrize("firmware", Firmware)
def test_wind_direction(firmware):
    flight = Flight(VehicleType.PLANE, firmware)
    flight.world.set_wind(speed=6.0, direction=270.0, turbulence=0.0)
    flight.run(5.0)
    speed = hypot(*flight.body.wind)
    assert speed > 1.0
    if firmware is PX4:  # direction in which it blows
        message = _request(flight, common.WindCov)
        assert (message.wind_x, message.wind_y) == pytest.approx((0.0, speed), abs=0.01)
    else:  # direction of origin
        message = _request(flight, dialect.Wind)
        assert message.direction % 360.0 == pytest.approx(270.0, abs=5.0)
        assert message.speed == pytest.approx(speed, abs=0.01)


@pytest.mark.flight
def test_angle_of_attack_in_a_climb():
    flight = Flight(VehicleType.PLANE, ARDUPILOT).fly(20.0)
    message = _request(flight, dialect.AoaSsa)
    assert -5.0 < message.AOA < 20.0
    assert abs(message.SSA) < 15.0


@pytest.mark.flight
def test_simstate_is_the_true_position():
    flight = Flight(VehicleType.COPTER, ARDUPILOT).fly(10.0)
    flight.body.spoof_gps(80.0, 0.0)
    flight.run(15.0)
    true = _request(flight, dialect.Simstate)
    estimated = _request(flight, common.GlobalPositionInt)
    position = flight.body.frame.to_global(*flight.body.truth[:3])
    assert (true.lat, true.lng) == pytest.approx((position[0] * 1e7, position[1] * 1e7), abs=2)
    assert abs(estimated.lat - true.lat) > 1000


@pytest.mark.flight
def test_rangefinder_is_sent_if_enabled():
    flight = Flight(VehicleType.COPTER, ARDUPILOT).fly(10.0)
    assert flight.rates(1.0)["DistanceSensor"] == 0
    flight.vehicle.parameters.set("RNGFND1_TYPE", 1)
    message = _request(flight, common.DistanceSensor)
    height = -flight.body.truth.down
    assert message.current_distance / 100 == pytest.approx(height, rel=0.3)
    assert message.orientation == common.MavSensorOrientation.PITCH_270
    assert _request(flight, dialect.Rangefinder).distance == pytest.approx(height, rel=0.3)


def test_rangefinder_on_the_ground_reads_the_minimum():
    flight = Flight(VehicleType.COPTER, PX4)
    flight.run(3.0)
    message = _request(flight, common.DistanceSensor)
    assert message.current_distance == message.min_distance


@pytest.mark.flight
def test_px4_sends_the_true_state_on_request():
    flight = Flight(VehicleType.COPTER, PX4).fly(10.0)
    message, true = _request(flight, common.HilStateQuaternion), flight.body.truth
    position = flight.body.frame.to_global(*true[:3])
    assert (message.lat, message.lon) == pytest.approx((position[0] * 1e7, position[1] * 1e7), abs=2)
    assert message.alt / 1e3 == pytest.approx(position[2], abs=0.01)
    assert message.vz == pytest.approx(true.velocity_down * 100, abs=1)
    assert message.zacc == pytest.approx(-1000, abs=250)


def test_fence_status_while_enabled():
    flight = Flight(VehicleType.COPTER, ARDUPILOT)
    flight.run(3.0)
    assert flight.rates(2.0)["FenceStatus"] == 0
    flight.vehicle.parameters.set("FENCE_ENABLE", 1)
    assert flight.rates(2.0)["FenceStatus"] == pytest.approx(8, abs=1)


@pytest.mark.flight
def test_orbit_status_while_orbiting():
    flight = Flight(VehicleType.COPTER, PX4).fly(10.0)
    assert flight.rates(1.0)["OrbitExecutionStatus"] == 0
    autopilot = flight.vehicle.autopilot
    autopilot.enter(autopilot.profile.guided, "test")
    autopilot.guided.orbit((50.0, 0.0, -20.0), -15.0)
    message = flight.newest(common.OrbitExecutionStatus)
    assert message.radius == pytest.approx(-15.0)
    position = flight.body.frame.to_local(message.x / 1e7, message.y / 1e7, message.z)
    assert position == pytest.approx((50.0, 0.0, -20.0), abs=0.05)


def test_system_time_is_simulated_time():
    flight = Flight(VehicleType.COPTER, ARDUPILOT)
    flight.run(5.0)
    message = _request(flight, common.SystemTime)
    assert message.time_unix_usec == pytest.approx(flight.now * 1e6, abs=10)
    assert message.time_boot_ms == pytest.approx(5000, abs=1)


@pytest.mark.flight
def test_reboot_restarts_time_and_estimate():
    flight = Flight(VehicleType.COPTER, ARDUPILOT).fly(5.0)
    flight.vehicle.reboot()
    flight.run(1.5)
    assert flight.newest(common.Attitude).time_boot_ms < 3000
    assert _request(flight, dialect.EkfStatusReport).flags & EKF.UNINITIALIZED
