"""The telemetry of an ArduCopter: the rate of each message and the values of its fields.

A message is a `MessageProfile`: its name, its rate, three fields that a reader accesses, and the values of
its fields. A value is one of

- a number: equal in every packet (0 for fields not listed, so that trailing zeros are trimmed on the wire as
  in reality: servos 9 to 16, unused battery cells, absent extensions);
- a pair: uniformly distributed between the two, drawn for each packet;
- a list of strings: one of them, drawn for each packet;
- `"ms"` or `"us"`: the time since boot, `"unix"`: microseconds since 1970.

The rates are those of a ground station that requested the usual streams, tuned for a mean packet length of 36
bytes, including header and checksum.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Mapping

Value: TypeAlias = float | tuple[float, float] | list[str] | str

ANGLE = (-3.1415, 3.1415)
LATITUDE = (-353_700_000, -353_600_000)
LONGITUDE = (1_491_600_000, 1_491_700_000)
HEIGHT = (580.0, 700.0)
SIGNED = (-2000, 2000)
PULSE = (1000, 2000)
PARAMETERS = ["ATC_RAT_RLL_P", "INS_GYRO_FILTER", "WPNAV_SPEED", "BATT_LOW_VOLT", "LOIT_SPEED"]
TEXTS = ["EKF3 IMU0 is using GPS", "Mission: 7 WP", "PreArm: Compass not calibrated", "Arming motors"]


@dataclass(frozen=True, slots=True)
class MessageProfile:
    """One message of one source: its rate, the three fields that are read, and the values of its fields."""

    name: str
    hertz: float
    read: str
    values: Mapping[str, Value]
    system: int = 1
    component: int = 1

    @property
    def read_fields(self) -> tuple[str, str, str]:
        """Names of the three fields that are read."""
        first, second, third = self.read.split()
        return first, second, third


def _same(names: str, value: Value) -> dict[str, Value]:
    return dict.fromkeys(names.split(), value)


def _channels(pattern: str, count: int) -> dict[str, Value]:
    return {pattern.format(number): PULSE for number in range(1, count + 1)}


_BOOT: dict[str, Value] = {"time_boot_ms": "ms"}
_PLACE: dict[str, Value] = {"lat": LATITUDE, "lon": LONGITUDE, "alt": (580_000, 700_000)}
_IMU: dict[str, Value] = {
    **_same("xacc yacc zacc xgyro ygyro zgyro xmag ymag zmag", SIGNED),
    "temperature": (2000, 4500),
}
_PRESSURE: dict[str, Value] = {**_BOOT, "press_abs": (940.0, 950.0), "temperature": (2000, 4500)}
_ALIVE: dict[str, Value] = {"autopilot": 8, "system_status": 4, "mavlink_version": 3}

POSITION: tuple[MessageProfile, ...] = (
    MessageProfile(
        "ATTITUDE",
        10,
        "roll pitch yaw",
        {**_BOOT, **_same("roll pitch yaw rollspeed pitchspeed yawspeed", ANGLE)},
    ),
    MessageProfile(
        "GLOBAL_POSITION_INT",
        5,
        "lat lon relative_alt",
        {**_BOOT, **_PLACE, **_same("vx vy vz", SIGNED), "relative_alt": (0, 120_000), "hdg": (1, 35_999)},
    ),
    MessageProfile(
        "LOCAL_POSITION_NED",
        4,
        "x y z",
        {**_BOOT, **_same("x y z", (-500.0, 500.0)), **_same("vx vy vz", (-15.0, 15.0))},
    ),
    MessageProfile(
        "GPS_RAW_INT",
        5,
        "lat fix_type satellites_visible",
        {
            **_PLACE,
            **_same("eph epv vel cog", (60, 300)),
            "time_usec": "us",
            "fix_type": 6,
            "satellites_visible": (8, 20),
        },
    ),
    MessageProfile(
        "VFR_HUD",
        5,
        "airspeed alt throttle",
        {
            **_same("airspeed groundspeed", (0.0, 20.0)),
            "alt": HEIGHT,
            "climb": (-5.0, 5.0),
            "heading": (0, 359),
            "throttle": (1, 100),
        },
    ),
    MessageProfile(
        "AHRS2",
        4,
        "roll altitude lat",
        {**_same("roll pitch yaw", ANGLE), "altitude": HEIGHT, "lat": LATITUDE, "lng": LONGITUDE},
    ),
    MessageProfile(
        "POSITION_TARGET_GLOBAL_INT",
        2,
        "lat_int lon_int alt",
        {
            **_BOOT,
            "lat_int": LATITUDE,
            "lon_int": LONGITUDE,
            "alt": HEIGHT,
            "type_mask": 3064,
            "coordinate_frame": 5,
        },
    ),
    MessageProfile(
        "NAV_CONTROLLER_OUTPUT",
        4,
        "nav_roll alt_error wp_dist",
        {
            **_same("nav_roll nav_pitch alt_error", (-30.0, 30.0)),
            "wp_dist": (1, 2000),
            **_same("nav_bearing target_bearing", (-180, 180)),
        },
    ),
    MessageProfile(
        "HOME_POSITION",
        0.2,
        "latitude longitude altitude",
        {
            "latitude": LATITUDE,
            "longitude": LONGITUDE,
            "altitude": 584_000,
            "q": (0.1, 1.0),
            "time_usec": "us",
        },
    ),
    MessageProfile(
        "TERRAIN_REPORT",
        3,
        "terrain_height current_height pending",
        {
            **_same("terrain_height current_height", (0.0, 600.0)),
            "lat": LATITUDE,
            "lon": LONGITUDE,
            "spacing": 100,
            "loaded": (200, 504),
        },
    ),
)

SENSORS: tuple[MessageProfile, ...] = (
    MessageProfile("RAW_IMU", 5, "xacc ygyro zmag", {**_IMU, "time_usec": "us"}),
    MessageProfile("SCALED_IMU2", 5, "xacc ygyro zmag", {**_IMU, **_BOOT}),
    MessageProfile("SCALED_IMU3", 3, "xacc ygyro zmag", {**_IMU, **_BOOT}),
    MessageProfile("SCALED_PRESSURE", 4, "press_abs press_diff temperature", _PRESSURE),
    MessageProfile("SCALED_PRESSURE2", 2, "press_abs press_diff temperature", _PRESSURE),
    MessageProfile(
        "VIBRATION",
        4,
        "vibration_x vibration_z clipping_0",
        {"time_usec": "us", **_same("vibration_x vibration_y vibration_z", (0.0, 30.0))},
    ),
    MessageProfile(
        "AHRS",
        4,
        "omegaIx error_rp error_yaw",
        {**_same("omegaIx omegaIy omegaIz", (-0.01, 0.01)), **_same("error_rp error_yaw", (0.001, 0.1))},
    ),
    MessageProfile(
        "EKF_STATUS_REPORT",
        4,
        "velocity_variance compass_variance flags",
        {
            **_same("velocity_variance pos_horiz_variance pos_vert_variance compass_variance", (0.0, 1.0)),
            "flags": 831,
        },
    ),
    MessageProfile(
        "WIND",
        3,
        "direction speed speed_z",
        {"direction": (-180.0, 180.0), "speed": (0.0, 10.0), "speed_z": (-1.0, 1.0)},
    ),
    MessageProfile(
        "SERVO_OUTPUT_RAW",
        4,
        "servo1_raw servo2_raw port",
        {"time_usec": (1, 4e9), **_channels("servo{}_raw", 8)},
    ),
    MessageProfile(
        "RC_CHANNELS",
        5,
        "chan1_raw chan3_raw rssi",
        {**_BOOT, **_channels("chan{}_raw", 16), "chancount": 16, "rssi": (1, 254)},
    ),
    MessageProfile(
        "ESC_TELEMETRY_1_TO_4",
        2,
        "voltage rpm temperature",
        {
            "temperature": (20, 90),
            "voltage": (1050, 1260),
            "current": (0, 2000),
            "rpm": (0, 9000),
            "totalcurrent": (0, 5000),
            "count": (0, 65_535),
        },
    ),
)

STATE: tuple[MessageProfile, ...] = (
    MessageProfile(
        "SYS_STATUS",
        4,
        "voltage_battery battery_remaining load",
        {
            **_same("onboard_control_sensors_present onboard_control_sensors_enabled", 0x5361FC2F),
            "onboard_control_sensors_health": 0x5771FC2F,
            "load": (100, 700),
            "battery_remaining": (1, 100),
            "voltage_battery": (10_500, 12_600),
            "current_battery": (0, 4000),
        },
    ),
    MessageProfile(
        "BATTERY_STATUS",
        2.2,
        "current_battery battery_remaining temperature",
        {
            "current_consumed": (0, 5000),
            "energy_consumed": (0, 900),
            "temperature": 32_767,
            "voltages": (3500, 4200),
            "current_battery": (0, 4000),
            "battery_remaining": (1, 100),
            "time_remaining": (1, 1800),
            "charge_state": 1,
        },
    ),
    MessageProfile("POWER_STATUS", 2, "Vcc Vservo flags", {"Vcc": (4900, 5200), "flags": 3}),
    MessageProfile(
        "MEMINFO", 2, "brkval freemem freemem32", {"freemem": 65_535, "freemem32": (100_000, 131_072)}
    ),
    MessageProfile(
        "MCU_STATUS",
        2,
        "MCU_temperature MCU_voltage id",
        {
            **_same("MCU_voltage MCU_voltage_min MCU_voltage_max", (3200, 3400)),
            "MCU_temperature": (3000, 5000),
        },
    ),
    MessageProfile(
        "SYSTEM_TIME", 3, "time_unix_usec time_boot_ms time_boot_ms", {**_BOOT, "time_unix_usec": "unix"}
    ),
    MessageProfile("TIMESYNC", 0.2, "tc1 ts1 ts1", {"tc1": "unix", "ts1": "unix"}),
    MessageProfile(
        "MISSION_CURRENT",
        3,
        "seq total mission_state",
        {"seq": (0, 60), "total": 60, "mission_state": 3, "mission_mode": 1},
    ),
    MessageProfile("COMMAND_ACK", 0.1, "command result result", {"command": (400, 600), "result": (0, 4)}),
    MessageProfile(
        "PARAM_VALUE",
        2,
        "param_value param_index param_id",
        {
            "param_value": (0.0, 100.0),
            "param_count": 1372,
            "param_index": (0, 1371),
            "param_type": 9,
            "param_id": PARAMETERS,
        },
    ),
    MessageProfile("STATUSTEXT", 0.3, "severity text id", {"severity": (2, 6), "text": TEXTS}),
    MessageProfile(
        "HEARTBEAT",
        1,
        "type base_mode custom_mode",
        {
            "custom_mode": (0, 7),
            "type": 2,
            "autopilot": 3,
            "base_mode": 217,
            "system_status": 4,
            "mavlink_version": 3,
        },
    ),
    MessageProfile("HEARTBEAT", 1, "type base_mode custom_mode", {**_ALIVE, "type": 26}, component=154),
    MessageProfile(
        "HEARTBEAT", 1, "type base_mode custom_mode", {**_ALIVE, "type": 6}, system=255, component=190
    ),
)

PROFILES = POSITION + SENSORS + STATE
