from __future__ import annotations

import pytest

from mavstack import Dialect, Parser, encode
from mavstack.dialects import ardupilotmega, common
from mavstack.router.high_latency import HighLatency
from tests.sim.harness import airborne

DIALECT = Dialect.load("all")
COPTER = {"autopilot": common.MavAutopilot.ARDUPILOTMEGA, "type": common.MavType.QUADROTOR}
PX4 = {"autopilot": common.MavAutopilot.PX4, "type": common.MavType.QUADROTOR}


def packet(message, system=1, component=1):
    return encode(message, system=system, component=component)


def decoded(packets):
    return [each.message for data in packets for each in Parser(DIALECT).feed(data)]


def summary(*messages, **heartbeat):
    """The HIGH_LATENCY2 of a vehicle that sent some messages."""
    profile = HighLatency(DIALECT, 5.0)
    for message in (common.Heartbeat(**{**COPTER, **heartbeat}), *messages):
        assert profile.receive(packet(message), 100.0) == []
    (data,) = profile.messages_to_send(profile.next_timeout())
    (found,) = Parser(DIALECT).feed(data)
    assert (found.system, found.component, found.name) == (1, 1, "HIGH_LATENCY2")
    return found.message


def test_interval():
    profile = HighLatency(DIALECT, 5.0)
    assert profile.next_timeout() is None
    profile.receive(packet(common.Heartbeat(**COPTER)), 100.0)
    assert profile.next_timeout() == 101.0
    assert profile.messages_to_send(100.5) == []
    assert len(profile.messages_to_send(101.0)) == 1
    assert profile.next_timeout() == 106.0
    profile.receive(packet(common.Heartbeat(**PX4), system=2), 103.0)
    assert [each.autopilot for each in decoded(profile.messages_to_send(106.0))] == [3, 12]


def test_a_vehicle_that_was_lost_is_not_reported():
    profile = HighLatency(DIALECT, 5.0)
    profile.receive(packet(common.Heartbeat(**COPTER)), 100.0)
    profile.messages_to_send(101.0)
    assert profile.messages_to_send(131.0) == []
    assert profile.next_timeout() is None


def test_scaling():
    found = summary(
        common.GlobalPositionInt(time_boot_ms=5000, lat=-353632610, lon=1491652300, alt=584_600, hdg=27_500),
        common.VfrHud(airspeed=15.2, groundspeed=12.4, throttle=43, climb=-2.5),
        common.VfrHud(airspeed=15.2, groundspeed=12.4, throttle=43, climb=0.5),
        common.NavControllerOutput(target_bearing=-90, wp_dist=1234, aspd_error=-1.0),
        common.PositionTargetGlobalInt(alt=650.4),
        common.GpsRawInt(h_acc=740, v_acc=1_000_000),
        common.ScaledPressure(temperature_press_diff=-1250),
        common.BatteryStatus(id=0, battery_remaining=80),
        common.BatteryStatus(id=1, battery_remaining=61),
        common.MissionCurrent(seq=7),
        ardupilotmega.Wind(direction=100, speed=6.1),
    )
    assert (found.timestamp, found.latitude, found.longitude) == (5000, -353632610, 1491652300)
    assert (found.altitude, found.heading, found.target_altitude) == (585, 137, 650)
    assert (found.airspeed, found.groundspeed, found.throttle) == (76, 62, 43)
    assert found.climb_rate == -25
    assert (found.target_heading, found.target_distance, found.airspeed_sp) == (135, 123, 71)
    assert (found.eph, found.epv) == (7, 255)
    assert (found.temperature_air, found.battery, found.wp_num) == (-12, 61, 7)
    assert (found.windspeed, found.wind_heading) == (30, 50)


def test_unknown_values():
    found = summary()
    assert (found.battery, found.eph, found.epv, found.wp_num) == (-1, 255, 255, 65535)
    assert found.temperature_air == -128


@pytest.mark.parametrize("value", [float("nan"), float("inf"), 1e30, -1e30])
def test_impossible_values_do_not_end_the_profile(value):
    found = summary(
        common.VfrHud(airspeed=value, groundspeed=value, climb=value),
        common.NavControllerOutput(alt_error=value, aspd_error=value),
        common.WindCov(wind_x=value, wind_y=value),
    )
    assert 0 <= found.airspeed <= 255


def test_firmwares_differ_in_mode_wind_and_armed():
    wind = common.WindCov(wind_x=0.0, wind_y=5.0)  # to the east
    copter = summary(wind, custom_mode=5, base_mode=0x80 | 1)
    assert (copter.custom_mode, copter.custom0, copter.wind_heading) == (5, 0x81 - 256, 135)
    px4 = summary(wind, **PX4, custom_mode=4 << 16 | 3 << 24, base_mode=0x80)
    assert (px4.custom_mode, px4.custom0, px4.wind_heading) == (4 | 3 << 8, -128, 45)


def test_failures_are_sensors_in_use_without_health():
    sensor = common.MavSysStatusSensor
    found = summary(
        common.SysStatus(
            onboard_control_sensors_present=sensor.SENSOR_GPS | sensor.AHRS | sensor.SENSOR_3D_MAG,
            onboard_control_sensors_enabled=sensor.SENSOR_GPS | sensor.AHRS | sensor.SENSOR_BATTERY,
            onboard_control_sensors_health=sensor.AHRS,
        )
    )
    assert found.failure_flags == common.HlFailureFlag.GPS


def test_only_awaited_packets_pass():
    profile = HighLatency(DIALECT, 5.0)

    def passes(message):
        return bool(profile.receive(packet(message), 100.0))

    assert not passes(common.Attitude())
    assert not passes(common.Heartbeat(**COPTER))
    assert passes(common.CommandAck(command=400))
    assert passes(common.MissionRequestInt(target_system=255, target_component=190))
    assert not passes(common.MissionRequestInt())
    assert passes(common.Statustext(severity=common.MavSeverity.WARNING, text="low battery"))
    assert not passes(common.Statustext(severity=common.MavSeverity.INFO, text="hello"))


def test_parameters_pass_after_a_request():
    profile, value = HighLatency(DIALECT, 5.0), packet(common.ParamValue(param_id="RTL_ALT"))
    assert profile.receive(value, 100.0) == []
    profile.receive_request(packet(common.ParamRequestRead(target_system=1), system=255), 100.0)
    assert profile.receive(value, 109.0) == [value]
    assert profile.receive(value, 110.0) == []


@pytest.mark.flight
@pytest.mark.parametrize("firmware", ["ardupilot", "px4"])
def test_simulated_flight(firmware):
    vehicle = airborne("copter", firmware)
    profile = HighLatency(DIALECT, 5.0)
    assert vehicle.port is not None
    vehicle.send_heartbeat()
    before = len(vehicle.received)
    vehicle.receiving = True
    vehicle.run(6.0)
    passed = [
        data for message in vehicle.received[before:] for data in profile.receive(packet(message), 100.0)
    ]
    (found,) = decoded(profile.messages_to_send(105.0))
    truth = next(each for each in reversed(vehicle.received) if isinstance(each, common.GlobalPositionInt))
    assert abs(found.latitude - truth.lat) < 1000
    assert abs(found.altitude - truth.alt / 1000) <= 1
    assert found.battery > 50
    assert sum(map(len, passed)) < 2000
    if firmware == "ardupilot":
        assert found.custom0 & common.MavModeFlag.SAFETY_ARMED
        assert found.custom_mode == vehicle.autopilot.mode.number
    else:
        assert found.custom_mode << 16 == vehicle.autopilot.mode.number
