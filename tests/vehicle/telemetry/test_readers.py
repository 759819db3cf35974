"""Every telemetry value: known, reported as unknown, and never received."""

from __future__ import annotations

import asyncio
from dataclasses import fields, is_dataclass
from math import inf, nan, pi, radians

import pytest

from mavstack.dialects import ardupilotmega, common
from tests.vehicle.telemetry.harness import ARDUPILOT, PX4, with_telemetry

U8, I16, U16, I32 = 0xFF, 0x7FFF, 0xFFFF, 0x7FFFFFFF
NO_CELLS = (U16,) * 10
NAN3 = {"vx": nan, "vy": nan, "vz": nan}
HERE = {"lat": 473_977_418, "lon": 85_455_939}
EAST = (0.7071067811865476, 0.0, 0.0, 0.7071067811865476)  # yawed by 90 degrees
#: A quarter turn in pitch, as a tail-sitter sends it while it flies by its wings.
PITCHED = (0.7071067811865476, 0.0, 0.7071067811865476, 0.0)
LOCAL = common.LocalPositionNed(0, 1.5, -2.5, -10, 3, 4, 5)

KNOWN = [
    (
        common.GlobalPositionInt(
            **HERE, alt=488_270, relative_alt=-50, vx=-120, vy=250, vz=-10, hdg=35_990
        ),
        "position",
        {"latitude": 47.3977418, "longitude": 8.5455939, "altitude": 488.27, "relative_altitude": -0.05,
         "heading": 359.9},
    ),
    (
        common.GlobalPositionInt(**HERE, vx=-120, vy=250, vz=-10),
        "velocity",
        {"north": -1.2, "east": 2.5, "down": -0.1, "ground_speed": 2.7731},
    ),
    (LOCAL, "local_position", {"north": 1.5, "east": -2.5, "down": -10}),
    (LOCAL, "velocity", {"north": 3, "down": 5, "ground_speed": 5}),
    (
        common.Attitude(0, 0.1, -0.2, -pi / 2, 0.3, -0.4, 0.5),
        "attitude",
        {"roll": 5.7296, "pitch": -11.4592, "yaw": -90, "roll_rate": 17.1887, "yaw_rate": 28.6479,
         "heading": 270},
    ),
    (
        common.AttitudeQuaternion(0, *EAST, radians(10), radians(20), radians(30)),
        "attitude",
        {"roll": 0, "pitch": 0, "yaw": 90, "roll_rate": 10, "pitch_rate": 20, "yaw_rate": 30},
    ),
    (
        common.AttitudeQuaternion(
            0, PITCHED[0], 0, -PITCHED[2], 0, radians(10), radians(20), radians(30), repr_offset_q=PITCHED
        ),
        "attitude",
        {"roll": 0, "pitch": 0, "yaw": 0, "roll_rate": 30, "pitch_rate": 20, "yaw_rate": -10},
    ),
    (
        common.VfrHud(12.5, 10.25, 90, 55, 500, -1.5),
        "vfr_hud",
        {"airspeed": 12.5, "ground_speed": 10.25, "climb": -1.5, "throttle": 55},
    ),
    (
        common.GpsRawInt(
            0, common.GpsFixType.RTK_FIXED, **HERE, alt=480_100, eph=62, epv=101, vel=1234, cog=9000,
            satellites_visible=14, h_acc=800, v_acc=1300, yaw=36_000,
        ),
        "gps",
        {"fix": 6, "has_fix": True, "satellites": 14, "hdop": 0.62, "vdop": 1.01, "latitude": 47.3977418,
         "altitude": 480.1, "ground_speed": 12.34, "course": 90, "heading": 0, "horizontal_accuracy": 0.8,
         "vertical_accuracy": 1.3},
    ),
    (
        common.BatteryStatus(
            voltages=(4100, 4000, 3900, *(U16,) * 7), current_battery=1234, current_consumed=567,
            battery_remaining=81, temperature=2510, time_remaining=600, charge_state=1,
        ),
        "battery",
        {"id": 0, "voltage": 12.0, "cells": (4.1, 4.0, 3.9), "current": 12.34, "consumed": 567,
         "remaining": 81, "temperature": 25.1, "time_remaining": 600,
         "charge_state": common.MavBatteryChargeState.OK},
    ),
    (common.BatteryStatus(voltages=(16_800, *(U16,) * 9)), "battery", {"voltage": 16.8, "cells": ()}),
    (common.BatteryStatus(voltages=(65_534, 1_466, *(U16,) * 8)), "battery", {"voltage": 67.0, "cells": ()}),
    (
        common.BatteryStatus(voltages=(4000,) * 10, voltages_ext=(4000, 4000, 0, 0)),
        "battery",
        {"voltage": 48.0, "cells": (4.0,) * 12},
    ),
    (
        common.SysStatus(voltage_battery=16_800, current_battery=250, battery_remaining=77),
        "battery",
        {"voltage": 16.8, "current": 2.5, "remaining": 77, "consumed": None},
    ),
    (
        common.HomePosition(HERE["lat"], HERE["lon"], 488_000),
        "home",
        {"latitude": 47.3977418, "longitude": 8.5455939, "altitude": 488},
    ),
    (
        common.RcChannels(0, 3, 1500, 1100, U16, 0, rssi=200),
        "rc",
        {"channels": (1500, 1100, None), "rssi": 200},
    ),
    (
        common.RcChannelsRaw(0, 0, 1500, 1100, U16, 0, 1900, 1000, 1000, 2000, 120),
        "rc",
        {"channels": (1500, 1100, None, None, 1900, 1000, 1000, 2000), "rssi": 120},
    ),
    (common.WindCov(0, 3, 4, -1), "wind", {"north": 3, "east": 4, "down": -1, "speed": 5}),
    (
        ardupilotmega.Wind(90, 5, 0.5),
        "wind",
        {"north": 0, "east": -5, "speed": 5, "direction": 90, "down": 0.5},
    ),
    (
        common.HighresImu(0, 1, 2, -9.8, radians(1), radians(2), radians(3), 0.2, 0.1, 0.4, temperature=31.5),
        "imu",
        {"acceleration": (1, 2, -9.8), "rotation": (1, 2, 3), "magnetic_field": (0.2, 0.1, 0.4),
         "temperature": 31.5},
    ),
    (
        common.ScaledImu(0, 0, 0, -1000, 1000, 0, 0, 200, 0, 400, temperature=2550),
        "imu",
        {"acceleration": (0, 0, -9.80665), "rotation": (57.29578, 0, 0), "magnetic_field": (0.2, 0, 0.4),
         "temperature": 25.5},
    ),
    (
        common.RawImu(0, 0, 0, -1000, 0, 0, 0, 200, 0, 400),
        "imu",
        {"acceleration": (0, 0, -9.80665), "temperature": None},
    ),
    (
        common.Odometry(0, common.MavFrame.LOCAL_NED, common.MavFrame.BODY_FRD, 1, 2, 3, EAST, 4, 5, 6,
                        radians(1), radians(2), radians(3), quality=90, reset_counter=7),
        "odometry",
        {"frame": common.MavFrame.LOCAL_NED, "child_frame": common.MavFrame.BODY_FRD, "position": (1, 2, 3),
         "quaternion": EAST, "velocity": (4, 5, 6), "rotation": (1, 2, 3), "quality": 90, "resets": 7},
    ),
    (
        common.Odometry(0, common.MavFrame.LOCAL_NED, common.MavFrame.BODY_FRD, 1, 2, 3, EAST),
        "local_position",
        {"north": 1, "east": 2, "down": 3},
    ),
]  # fmt: skip


def shown(value, name):
    found = getattr(value, name)
    return (
        list(found) if isinstance(found, tuple) and all(isinstance(each, float) for each in found) else found
    )


@pytest.mark.parametrize(
    ("message", "name", "expected"), KNOWN, ids=[f"{type(m).__name__}-{n}" for m, n, _ in KNOWN]
)
def test_reported_values(message, name, expected):
    async def scenario(harness):
        harness.heartbeat()
        harness.receive(message)
        value = getattr(harness.vehicle, name)
        for field, wanted in expected.items():
            found = shown(value, field)
            if isinstance(found, list):
                assert found == pytest.approx(list(wanted), abs=1e-4), field
            elif isinstance(wanted, float | int):
                assert found == pytest.approx(wanted, abs=1e-4), field
            else:
                assert found == wanted, field

    with_telemetry(scenario)


UNKNOWN = [
    (common.GlobalPositionInt(0, 0, 0, 500), "position", None),
    (common.GlobalPositionInt(0, I32, I32), "position", None),
    (common.GlobalPositionInt(0, 910_000_000, 0), "position", None),
    (common.GlobalPositionInt(**HERE, hdg=U16), "position", {"heading"}),
    (
        common.GlobalPositionInt(**HERE, alt=I32, relative_alt=I32),
        "position",
        {"altitude", "relative_altitude"},
    ),
    (common.GlobalPositionInt(0, 0, 0, 500), "velocity", None),
    (common.GlobalPositionInt(**HERE, vx=I16), "velocity", None),
    (common.LocalPositionNed(0, nan, 1, 2), "local_position", None),
    (common.LocalPositionNed(0, 1, 1, 2, **NAN3), "velocity", None),
    (common.Odometry(frame_id=common.MavFrame.BODY_FRD), "local_position", None),
    (common.Attitude(0, nan, 0, 0), "attitude", None),
    (common.Attitude(0, 0, 0, 0, nan, nan, nan), "attitude", {"roll_rate", "pitch_rate", "yaw_rate"}),
    (common.AttitudeQuaternion(0, 0, 0, 0, 0), "attitude", None),
    (common.AttitudeQuaternion(0, nan, 0, 0, 0), "attitude", None),
    (common.AttitudeQuaternion(0, inf, 0, 0, 0), "attitude", None),
    (common.VfrHud(nan, nan, 0, U16, 0, nan), "vfr_hud", {"airspeed", "ground_speed", "climb", "throttle"}),
    (
        common.GpsRawInt(0, 1, **HERE, eph=U16, epv=U16, vel=U16, cog=U16, satellites_visible=U8),
        "gps",
        {"satellites", "hdop", "vdop", "latitude", "longitude", "altitude", "ground_speed", "course",
         "heading", "horizontal_accuracy", "vertical_accuracy"},
    ),
    (common.GpsRawInt(0, 3, **HERE, yaw=U16), "gps", {"heading", "horizontal_accuracy", "vertical_accuracy"}),
    (
        common.BatteryStatus(
            voltages=NO_CELLS, current_battery=-1, current_consumed=-1, energy_consumed=-1,
            battery_remaining=-1, temperature=I16,
        ),
        "battery",
        {"voltage", "current", "remaining", "consumed", "temperature", "time_remaining", "charge_state"},
    ),
    (common.SysStatus(voltage_battery=U16, current_battery=-1, battery_remaining=-1), "battery", None),
    (common.HomePosition(), "home", None),
    (common.RcChannels(0, 2, U16, 0, rssi=U8), "rc", {"rssi"}),
    (common.RcChannelsRaw(rssi=U8), "rc", {"rssi"}),
    (common.WindCov(0, nan, nan, nan), "wind", None),
    (common.WindCov(0, 1, 2, nan), "wind", {"down"}),
    (ardupilotmega.Wind(nan, 1), "wind", None),
    (common.HighresImu(0, nan), "imu", None),
    (common.HighresImu(xmag=nan, temperature=nan), "imu", {"magnetic_field", "temperature"}),
    (common.ScaledImu(), "imu", {"temperature"}),
    (
        common.Odometry(0, 1, 1, nan, 0, 0, (nan, 0, 0, 0), nan, 0, 0, nan),
        "odometry",
        {"position", "quaternion", "velocity", "rotation", "quality"},
    ),
    (common.ExtendedSysState(), "landed_state", None),
    (common.ExtendedSysState(), "vtol_state", None),
]  # fmt: skip


@pytest.mark.parametrize(
    ("message", "name", "unknown"),
    UNKNOWN,
    ids=[f"{type(m).__name__}-{n}-{i}" for i, (m, n, _) in enumerate(UNKNOWN)],
)
def test_values_reported_as_unknown(message, name, unknown):
    async def scenario(harness):
        harness.heartbeat()
        harness.receive(message)
        value = getattr(harness.vehicle, name)
        if unknown is None:
            assert value is None
        else:
            assert is_dataclass(value)
            assert {each.name for each in fields(value) if getattr(value, each.name) is None} == unknown

    with_telemetry(scenario)


NOT_SHOWN = {"energy_consumed", "var_horiz", "var_vert", "wind_alt", "horiz_accuracy", "vert_accuracy", "q"}
NOT_SHOWN |= {"pose_covariance", "velocity_covariance", "repr_offset_q", "voltages_ext"}
MEANING = {"UINT8_MAX": U8, "INT16_MAX": I16, "UINT16_MAX": U16, "INT32_MAX": I32, "-1": -1, "0": 0}


def test_every_invalid_value_of_the_definitions_is_covered():
    tried = {}
    for message, _, _ in UNKNOWN:
        for name in message.__match_args__:
            tried.setdefault((type(message), name), []).append(getattr(message, name))
    for kind in {type(message) for message, _, _ in KNOWN}:
        for field in kind.definition.fields:
            if not field.invalid or field.name in NOT_SHOWN or field.name.startswith("chan"):
                continue
            values = tried[kind, field.name]
            if field.invalid.startswith("["):
                values = [value[0] for value in values]
            wanted = field.invalid.strip("[:]")
            if wanted == "NaN":
                assert any(value != value for value in values), field.name
            else:
                assert MEANING[wanted] in values, f"{kind.__name__}.{field.name}"


VALUES = [
    *(
        "position",
        "local_position",
        "velocity",
        "attitude",
        "vfr_hud",
        "home",
        "wind",
        "odometry",
        "gps",
        "imu",
    ),
    *("rc", "battery", "armed", "mode", "in_air", "landed_state", "vtol_state", "system_status", "mav_type"),
]


@pytest.mark.parametrize("name", VALUES)
def test_every_value_is_none_before_the_first_message(name):
    async def scenario(harness):
        assert getattr(harness.vehicle, name) is None
        assert harness.vehicle.batteries == {}
        assert harness.vehicle.status_texts == []

    with_telemetry(scenario)


def test_raw_units_are_not_guessed():
    async def scenario(harness):
        harness.heartbeat(PX4)
        harness.receive(common.RawImu(zacc=-1000))
        assert harness.vehicle.imu is None

    with_telemetry(scenario)


def test_the_newer_attitude_counts():
    async def scenario(harness):
        harness.receive(common.Attitude(yaw=pi / 2))
        await asyncio.sleep(0.1)
        harness.receive(common.AttitudeQuaternion(0, 1, 0, 0, 0))
        assert harness.vehicle.attitude.yaw == pytest.approx(0)
        await asyncio.sleep(0.1)
        harness.receive(common.Attitude(yaw=pi / 2))
        assert harness.vehicle.attitude.yaw == pytest.approx(90)

    with_telemetry(scenario)


# The heartbeat


# A vehicle that sends HIGH_LATENCY2 and nothing else


def summary(autopilot=PX4, **fields_of_it):
    fields_of_it = {
        "latitude": HERE["lat"], "longitude": HERE["lon"], "altitude": 488, "heading": 45, "airspeed": 60,
        "groundspeed": 50, "climb_rate": -12, "throttle": 40, "windspeed": 25, "wind_heading": 45,
        "battery": 64, **fields_of_it,
    }  # fmt: skip
    return common.HighLatency2(type=common.MavType.QUADROTOR, autopilot=autopilot, **fields_of_it)


def test_values_of_high_latency():
    async def scenario(harness):
        harness.receive(summary(custom_mode=0x0304))
        vehicle = harness.vehicle
        assert (vehicle.position.latitude, vehicle.position.heading) == (47.3977418, 90)
        assert (vehicle.position.altitude, vehicle.position.relative_altitude) == (488, None)
        assert vehicle.vfr_hud.airspeed == 12
        assert vehicle.vfr_hud.climb == -1.2
        assert vehicle.battery.remaining == 64
        assert vehicle.battery.voltage is None
        assert vehicle.mode == "LOITER"
        assert (vehicle.armed, vehicle.system_status, vehicle.in_air, vehicle.velocity) == (None,) * 4

    with_telemetry(scenario)


@pytest.mark.parametrize(("autopilot", "direction"), [(PX4, 270), (ARDUPILOT, 90)])
def test_high_latency_wind_depends_on_the_firmware(autopilot, direction):
    async def scenario(harness):
        harness.receive(summary(autopilot))
        assert harness.vehicle.wind.speed == pytest.approx(5)
        assert harness.vehicle.wind.direction == pytest.approx(direction)

    with_telemetry(scenario)


@pytest.mark.parametrize(("base_mode", "armed"), [(-128 + 1, True), (81, False)])
def test_ardupilots_base_mode_in_high_latency(base_mode, armed):
    async def scenario(harness):
        harness.receive(summary(ARDUPILOT, custom0=base_mode, custom_mode=5))
        assert harness.vehicle.armed is armed
        assert harness.vehicle.mode == "LOITER"

    with_telemetry(scenario)


def test_the_coarse_message_counts_only_when_the_fine_one_is_old():
    async def scenario(harness):
        harness.heartbeat()
        harness.receive(common.GlobalPositionInt(**HERE, relative_alt=10_000))
        await asyncio.sleep(5)
        harness.receive(summary(ARDUPILOT))
        assert harness.vehicle.position.relative_altitude == 10
        await asyncio.sleep(30)
        harness.receive(summary(ARDUPILOT))
        assert harness.vehicle.position.relative_altitude is None

    with_telemetry(scenario)


@pytest.mark.parametrize("unknown", [summary(latitude=0, longitude=0)])
def test_high_latency_without_a_position(unknown):
    async def scenario(harness):
        harness.receive(unknown.replace(battery=-1))
        assert harness.vehicle.position is None
        assert harness.vehicle.battery is None

    with_telemetry(scenario)
