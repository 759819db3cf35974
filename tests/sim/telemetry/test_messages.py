"""What the messages say: units, signs, frames and markers, against the body's truth and estimate."""

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
    """A copter on its way somewhere, not level and not facing north."""
    flight = Flight(VehicleType.COPTER, request.param).fly()
    flight.body.go_to(80.0, 60.0, -30.0, speed=8.0)
    flight.run(4.0)
    return flight


def _ask(flight: Flight, kind: type, *, number: int | None = None):
    """The message as it is now, in the same step."""
    flight.packets.clear()
    flight.command(common.MavCmd.REQUEST_MESSAGE, number or kind.__mavlink_row__[0])
    flight.vehicle._settle()
    for _, data in flight.vehicle.data_to_send():
        for packet in flight._parser.feed(data, flight.now):
            if isinstance(packet.message, kind):
                return packet.message
    raise AssertionError(f"no {kind.__name__}")


def test_attitude_and_rates(flying):
    told, own = _ask(flying, common.Attitude), flying.body.estimate
    assert (told.roll, told.pitch, told.yaw) == pytest.approx((own.roll, own.pitch, own.yaw), abs=1e-5)
    assert told.rollspeed == pytest.approx(own.roll_rate, abs=1e-5)
    assert hypot(told.roll, told.pitch) > 0.01
    assert told.time_boot_ms == flying.vehicle.uptime_ms


def test_a_quaternion_is_the_same_attitude(flying):
    told, own = _ask(flying, common.AttitudeQuaternion), flying.body.estimate
    w, x, y, z = told.q1, told.q2, told.q3, told.q4
    assert w * w + x * x + y * y + z * z == pytest.approx(1.0, abs=1e-5)
    assert atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)) == pytest.approx(own.roll, abs=1e-4)
    assert asin(2 * (w * y - z * x)) == pytest.approx(own.pitch, abs=1e-4)
    assert atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)) == pytest.approx(own.yaw, abs=1e-4)


def test_global_position(flying):
    told, own = _ask(flying, common.GlobalPositionInt), flying.body.estimate
    north, east, down = flying.body.frame.to_local(told.lat / 1e7, told.lon / 1e7, told.alt / 1e3)
    assert (north, east, down) == pytest.approx((own.north, own.east, own.down), abs=0.02)
    assert told.relative_alt / 1e3 == pytest.approx(flying.vehicle.autopilot.altitude, abs=0.01)
    assert (told.vx, told.vy, told.vz) == pytest.approx(
        (own.velocity_north * 100, own.velocity_east * 100, own.velocity_down * 100), abs=1
    )
    assert told.hdg / 100 == pytest.approx(degrees(own.yaw) % 360.0, abs=0.01)


def test_local_position(flying):
    told, own = _ask(flying, common.LocalPositionNed), flying.body.estimate
    assert (told.x, told.y, told.z) == pytest.approx(own[:3], abs=1e-3)
    assert (told.vx, told.vy, told.vz) == pytest.approx(own[3:6], abs=1e-3)


def test_head_up_display(flying):
    told, own = _ask(flying, common.VfrHud), flying.body.estimate
    assert told.groundspeed == pytest.approx(hypot(own.velocity_north, own.velocity_east), abs=1e-3)
    assert told.climb == pytest.approx(-own.velocity_down, abs=1e-3)
    assert told.alt == pytest.approx(flying.body.frame.altitude - own.down, abs=0.01)
    assert told.heading == int(degrees(own.yaw) % 360.0)
    assert told.throttle == pytest.approx(flying.body.throttle * 100.0, abs=1.0)
    assert told.throttle > 10
    assert isnan(told.airspeed) == (flying.vehicle.firmware is PX4)


def test_inertial_readings(flying):
    felt = flying.body.sensors
    scaled = _ask(flying, common.ScaledImu2)
    assert scaled.zacc / 1000 * 9.80665 == pytest.approx(felt.acceleration_z, abs=0.01)
    assert scaled.xmag / 1000 == pytest.approx(felt.magnetic_x, abs=0.001)
    assert scaled.zacc < -500
    fine = _ask(flying, common.HighresImu)
    assert (fine.xacc, fine.zgyro, fine.ymag) == pytest.approx(
        (felt.acceleration_x, felt.gyro_z, felt.magnetic_y), abs=1e-4
    )
    assert fine.abs_pressure == pytest.approx(felt.pressure, abs=0.01)
    ground = flying.body.frame.altitude
    assert fine.pressure_alt == pytest.approx(ground - flying.body.truth.down, abs=25.0)


def test_satellites(flying):
    told, felt = _ask(flying, common.GpsRawInt), flying.body.sensors
    assert told.fix_type == felt.gps_fix >= 3
    assert (told.lat, told.lon) == (round(felt.gps_latitude * 1e7), round(felt.gps_longitude * 1e7))
    assert told.vel == pytest.approx(hypot(felt.gps_velocity_north, felt.gps_velocity_east) * 100, abs=1)
    assert 0 <= told.cog < 36000
    assert told.h_acc == pytest.approx(felt.gps_eph * 1000, abs=1)
    assert 30 <= told.eph <= 300
    expected = flying.now if flying.vehicle.firmware is PX4 else flying.vehicle.uptime
    assert told.time_usec == pytest.approx(expected * 1e6, abs=1000)


def test_battery(flying):
    told, battery = _ask(flying, common.BatteryStatus), flying.body.battery
    assert sum(cell for cell in told.voltages if cell != 65535) == pytest.approx(
        battery.voltage * 1000, abs=1
    )
    assert told.voltages[1:] == (65535,) * 9
    assert told.current_battery == pytest.approx(battery.current * 100, abs=1)
    assert told.current_battery > 100
    assert told.current_consumed == pytest.approx(battery.consumed, abs=1)
    assert told.time_remaining == pytest.approx(
        battery.remaining * battery.capacity * 3.6 / battery.current, rel=0.01
    )
    assert told.charge_state == common.MavBatteryChargeState.OK
    status = _ask(flying, common.SysStatus)
    assert status.voltage_battery == pytest.approx(battery.voltage * 1000, abs=1)
    assert status.battery_remaining == round(battery.remaining * 100)


def test_servos_and_sticks(flying):
    told = _ask(flying, common.ServoOutputRaw)
    outputs = [getattr(told, f"servo{number}_raw") for number in range(1, 17)]
    assert outputs == [round(pulse) for pulse in flying.body.servos]
    assert told.servo1_raw > 1100
    if flying.vehicle.firmware is ARDUPILOT:
        sticks = _ask(flying, common.RcChannels)
        assert sticks.chancount == 16
        channels = [getattr(sticks, f"chan{number}_raw") for number in range(1, 19)]
        assert tuple(channels) == flying.vehicle.autopilot.radio.channels
        assert sticks.rssi == flying.vehicle.autopilot.radio.rssi


def test_home_and_origin(flying):
    home = flying.vehicle.autopilot.home
    told = _ask(flying, common.HomePosition)
    assert (told.latitude, told.longitude) == (round(home.latitude * 1e7), round(home.longitude * 1e7))
    assert told.altitude == pytest.approx(home.altitude * 1e3, abs=1)
    origin = _ask(flying, common.GpsGlobalOrigin)
    assert origin.latitude == round(flying.body.frame.latitude * 1e7)


def test_on_the_way_the_target_is_told(flying):
    autopilot = flying.vehicle.autopilot
    autopilot.target = (100.0, 0.0, -40.0)
    told = _ask(flying, common.PositionTargetGlobalInt)
    autopilot.target = None
    place = flying.body.frame.to_local(told.lat_int / 1e7, told.lon_int / 1e7, told.alt)
    assert place == pytest.approx((100.0, 0.0, -40.0), abs=0.05)
    assert not told.type_mask & 7


def test_landed_state_follows_the_autopilot(flying):
    assert _ask(flying, common.ExtendedSysState).landed_state == flying.vehicle.autopilot.landed_state != 1


# States


@pytest.mark.parametrize("firmware", Firmware)
def test_before_the_first_position(firmware):
    flight = Flight(VehicleType.COPTER, firmware)
    flight.run(0.5)
    if firmware is PX4:
        assert flight.rates(1.0)["GlobalPositionInt"] == 0
    else:
        told = _ask(flight, common.GlobalPositionInt)
        assert (told.lat, told.lon) == (0, 0)
        assert _ask(flight, dialect.EkfStatusReport).flags & EKF.UNINITIALIZED


def test_satellites_lost():
    flight = Flight(VehicleType.COPTER, ARDUPILOT).fly(8.0)
    good = _ask(flight, common.SysStatus).onboard_control_sensors_health
    flight.body.fail_gps(True)
    flight.run(20.0)
    raw = _ask(flight, common.GpsRawInt)
    assert raw.fix_type <= 1
    assert (raw.eph, raw.epv, raw.vel, raw.cog) == (65535,) * 4
    status = _ask(flight, common.SysStatus)
    assert status.onboard_control_sensors_health == good & ~BIT.SENSOR_GPS
    assert status.onboard_control_sensors_present & BIT.SENSOR_GPS
    flags = _ask(flight, dialect.EkfStatusReport).flags
    assert flags & EKF.CONST_POS_MODE
    assert not flags & (EKF.POS_HORIZ_ABS | EKF.PRED_POS_HORIZ_ABS)
    assert flags & EKF.ATTITUDE


def test_px4_tells_no_global_position_without_satellites():
    flight = Flight(VehicleType.COPTER, PX4).fly(8.0)
    flight.body.fail_gps(True)
    flight.run(20.0)
    heard = flight.rates(2.0)
    assert heard["GlobalPositionInt"] == 0
    assert heard["LocalPositionNed"] > 0
    assert not _ask(flight, common.EstimatorStatus).flags & EKF.POS_HORIZ_ABS


def test_compass_that_does_not_fit():
    flight = Flight(VehicleType.COPTER, ARDUPILOT)
    flight.run(3.0)
    flight.body.offset_compass(pi / 2)
    flight.run(5.0)
    assert not _ask(flight, common.SysStatus).onboard_control_sensors_health & BIT.SENSOR_3D_MAG


def test_what_forbids_arming_is_told():
    flight = Flight(VehicleType.COPTER, ARDUPILOT)
    flight.run(3.0)
    assert _ask(flight, common.SysStatus).onboard_control_sensors_health & BIT.PREARM_CHECK
    flight.vehicle.profile.problems.append("PreArm: something")
    flight.run(1.5)
    assert not _ask(flight, common.SysStatus).onboard_control_sensors_health & BIT.PREARM_CHECK


def test_radio_switched_off():
    flight = Flight(VehicleType.COPTER, ARDUPILOT)
    flight.run(3.0)
    assert _ask(flight, common.SysStatus).onboard_control_sensors_health & BIT.SENSOR_RC_RECEIVER
    flight.vehicle.autopilot.radio.switch(False)
    assert not _ask(flight, common.SysStatus).onboard_control_sensors_health & BIT.SENSOR_RC_RECEIVER
    assert _ask(flight, common.RcChannels).chan1_raw == 0


def test_px4_has_no_receiver_until_somebody_steers():
    flight = Flight(VehicleType.COPTER, PX4)
    flight.run(3.0)
    status = _ask(flight, common.SysStatus)
    assert not status.onboard_control_sensors_present & BIT.SENSOR_RC_RECEIVER
    assert flight.rates(2.0)["RcChannels"] == 0


@pytest.mark.parametrize(
    ("left", "state"), [(0.5, "OK"), (0.12, "LOW"), (0.06, "CRITICAL"), (0.02, "EMERGENCY")]
)
def test_px4_says_how_low_its_battery_is(left, state):
    flight = Flight(VehicleType.COPTER, PX4)
    flight.run(1.0)
    flight.body.recharge(left)
    flight.run(0.5)
    assert _ask(flight, common.BatteryStatus).charge_state == common.MavBatteryChargeState[state]


@pytest.mark.parametrize(("low", "critical", "state"), [(0, 0, "OK"), (99, 0, "LOW"), (99, 98, "CRITICAL")])
def test_ardupilot_goes_by_voltage(low, critical, state):
    flight = Flight(VehicleType.COPTER, ARDUPILOT, BATT_LOW_VOLT=low, BATT_CRT_VOLT=critical)
    flight.run(1.0)
    assert _ask(flight, common.BatteryStatus).charge_state == common.MavBatteryChargeState[state]


def test_a_vtols_state_is_what_it_flies_by():
    flight = Flight(VehicleType.VTOL, PX4).fly(20.0)
    state = common.MavVtolState
    assert _ask(flight, common.ExtendedSysState).vtol_state == state.MC
    flight.body.transition_to(True)
    flight.body.fly_velocity(20.0, 0.0, 0.0)
    flight.run(0.2)
    assert _ask(flight, common.ExtendedSysState).vtol_state == state.TRANSITION_TO_FW
    flight.run_until(lambda: flight.body.transition >= 1.0, timeout=40.0)
    assert _ask(flight, common.ExtendedSysState).vtol_state == state.FW
    flight.body.transition_to(False)
    flight.run(0.2)
    assert _ask(flight, common.ExtendedSysState).vtol_state == state.TRANSITION_TO_MC


@pytest.mark.parametrize("firmware", Firmware)
def test_the_wind_has_its_direction(firmware):
    flight = Flight(VehicleType.PLANE, firmware)
    flight.world.set_wind(speed=6.0, direction=270.0, turbulence=0.0)
    flight.run(5.0)
    speed = hypot(*flight.body.wind)
    assert speed > 1.0
    if firmware is PX4:  # where it goes to
        told = _ask(flight, common.WindCov)
        assert (told.wind_x, told.wind_y) == pytest.approx((0.0, speed), abs=0.01)
    else:  # where it comes from
        told = _ask(flight, dialect.Wind)
        assert told.direction % 360.0 == pytest.approx(270.0, abs=5.0)
        assert told.speed == pytest.approx(speed, abs=0.01)


def test_air_hits_a_climbing_wing_from_below():
    flight = Flight(VehicleType.PLANE, ARDUPILOT).fly(20.0)
    told = _ask(flight, dialect.AoaSsa)
    assert -5.0 < told.AOA < 20.0
    assert abs(told.SSA) < 15.0


def test_simstate_is_the_truth_and_the_rest_is_not():
    flight = Flight(VehicleType.COPTER, ARDUPILOT).fly(10.0)
    flight.body.spoof_gps(80.0, 0.0)
    flight.run(15.0)
    true = _ask(flight, dialect.Simstate)
    believed = _ask(flight, common.GlobalPositionInt)
    place = flight.body.frame.to_global(*flight.body.truth[:3])
    assert (true.lat, true.lng) == pytest.approx((place[0] * 1e7, place[1] * 1e7), abs=2)
    assert abs(believed.lat - true.lat) > 1000


def test_a_rangefinder_is_told_if_the_parameters_have_one():
    flight = Flight(VehicleType.COPTER, ARDUPILOT).fly(10.0)
    assert flight.rates(1.0)["DistanceSensor"] == 0
    flight.vehicle.parameters.set("RNGFND1_TYPE", 1)
    told = _ask(flight, common.DistanceSensor)
    height = -flight.body.truth.down
    assert told.current_distance / 100 == pytest.approx(height, rel=0.3)
    assert told.orientation == common.MavSensorOrientation.PITCH_270
    assert _ask(flight, dialect.Rangefinder).distance == pytest.approx(height, rel=0.3)


def test_a_rangefinder_on_the_ground_reads_its_least():
    flight = Flight(VehicleType.COPTER, PX4)
    flight.run(3.0)
    told = _ask(flight, common.DistanceSensor)
    assert told.current_distance == told.min_distance


def test_px4_tells_the_truth_if_it_is_asked():
    flight = Flight(VehicleType.COPTER, PX4).fly(10.0)
    told, true = _ask(flight, common.HilStateQuaternion), flight.body.truth
    place = flight.body.frame.to_global(*true[:3])
    assert (told.lat, told.lon) == pytest.approx((place[0] * 1e7, place[1] * 1e7), abs=2)
    assert told.alt / 1e3 == pytest.approx(place[2], abs=0.01)
    assert told.vz == pytest.approx(true.velocity_down * 100, abs=1)
    assert told.zacc == pytest.approx(-1000, abs=250)


def test_a_fence_is_told_while_there_is_one():
    flight = Flight(VehicleType.COPTER, ARDUPILOT)
    flight.run(3.0)
    assert flight.rates(2.0)["FenceStatus"] == 0
    flight.vehicle.parameters.set("FENCE_ENABLE", 1)
    assert flight.rates(2.0)["FenceStatus"] == pytest.approx(8, abs=1)


def test_an_orbit_is_told_while_it_is_flown():
    flight = Flight(VehicleType.COPTER, PX4).fly(10.0)
    assert flight.rates(1.0)["OrbitExecutionStatus"] == 0
    autopilot = flight.vehicle.autopilot
    autopilot.enter(autopilot.profile.guided, "test")
    autopilot.guided.orbit((50.0, 0.0, -20.0), -15.0)
    told = flight.newest(common.OrbitExecutionStatus)
    assert told.radius == pytest.approx(-15.0)
    place = flight.body.frame.to_local(told.x / 1e7, told.y / 1e7, told.z)
    assert place == pytest.approx((50.0, 0.0, -20.0), abs=0.05)


def test_system_time_is_the_simulated_one():
    flight = Flight(VehicleType.COPTER, ARDUPILOT)
    flight.run(5.0)
    told = _ask(flight, common.SystemTime)
    assert told.time_unix_usec == pytest.approx(flight.now * 1e6, abs=10)
    assert told.time_boot_ms == pytest.approx(5000, abs=1)


def test_after_a_reboot_time_and_home_begin_anew():
    flight = Flight(VehicleType.COPTER, ARDUPILOT).fly(5.0)
    flight.vehicle.reboot()
    flight.run(1.5)
    assert flight.newest(common.Attitude).time_boot_ms < 3000
    assert _ask(flight, dialect.EkfStatusReport).flags & EKF.UNINITIALIZED
