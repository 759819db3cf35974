"""Messages of MSP beside YAMSPy, a library for Betaflight and iNav: the same bytes mean the same values."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mavstack.msp import FirmwareInfo
from mavstack.msp.commands import MspCommand
from mavstack.msp.messages import (
    battery,
    blackbox,
    config,
    filters,
    gps,
    modes,
    motors,
    pid,
    rc,
    sensors,
    status,
)
from tests.msp.messages.strategies import records

if TYPE_CHECKING:
    from mavstack.msp.messages.layout import TableMessage

yamspy = pytest.importorskip("yamspy", reason="YAMSPy is not installed")
pytestmark = pytest.mark.interop

BETAFLIGHT = FirmwareInfo("BTFL", (4, 2, 0), (1, 43))
#: Names that YAMSPy gives to other numbers, or that mean another command in iNav.
OTHER_NAMES = {"MSP_RTC", "MSP_SET_RTC"}

#: For each message the group of values of YAMSPy; for each key our field, and the factor of our unit to its.
Pairs = dict[str, tuple[str, float]]
VALUES: dict[type[TableMessage], tuple[str, Pairs]] = {
    status.StatusEx: (
        "CONFIG",
        {
            "cycleTime": ("cycle_time", 1e6),
            "i2cError": ("i2c_errors", 1),
            "activeSensors": ("sensors", 1),
            "mode": ("mode_flags", 1),
            "profile": ("pid_profile", 1),
            "cpuload": ("load", 1),
            "numProfiles": ("pid_profile_count", 1),
            "rateProfile": ("rate_profile", 1),
            "armingDisableCount": ("arming_disable_flag_count", 1),
            "armingDisableFlags": ("arming_disable_flags", 1),
        },
    ),
    gps.RawGps: (
        "GPS_DATA",
        {
            "fix": ("fix_type", 1),
            "numSat": ("satellites", 1),
            "lat": ("latitude", 1e7),
            "lon": ("longitude", 1e7),
            "alt": ("altitude", 1),
            "speed": ("ground_speed", 100),
            "ground_course": ("ground_course", 10),
        },
    ),
    gps.CompGps: (
        "GPS_DATA",
        {
            "distanceToHome": ("distance_to_home", 1),
            "directionToHome": ("direction_to_home", 1),
            "update": ("heartbeat", 1),
        },
    ),
    battery.Analog: (
        "ANALOG",
        {
            "mAhdrawn": ("consumed_charge", 1),
            "rssi": ("rssi", 1),
            "amperage": ("current", 1),
            "voltage": ("voltage", 1),
        },
    ),
    battery.BatteryConfig: (
        "BATTERY_CONFIG",
        {
            "capacity": ("capacity", 1),
            "voltageMeterSource": ("voltage_source", 1),
            "currentMeterSource": ("current_source", 1),
            "vbatmincellvoltage": ("cell_min", 1),
            "vbatmaxcellvoltage": ("cell_max", 1),
            "vbatwarningcellvoltage": ("cell_warning", 1),
        },
    ),
    rc.RcTuning: (
        "RC_TUNING",
        {
            "RC_RATE": ("rc_rate", 0.01),
            "RC_EXPO": ("rc_expo", 0.01),
            "roll_rate": ("roll_rate", 0.01),
            "pitch_rate": ("pitch_rate", 0.01),
            "yaw_rate": ("yaw_rate", 0.01),
            "dynamic_THR_PID": ("tpa_rate", 0.01),
            "throttle_MID": ("throttle_mid", 0.01),
            "throttle_EXPO": ("throttle_expo", 0.01),
            "dynamic_THR_breakpoint": ("tpa_breakpoint", 1),
            "RC_YAW_EXPO": ("yaw_expo", 0.01),
            "rcYawRate": ("yaw_rc_rate", 0.01),
            "rcPitchRate": ("pitch_rc_rate", 0.01),
            "RC_PITCH_EXPO": ("pitch_expo", 0.01),
            "throttleLimitType": ("throttle_limit_type", 1),
            "throttleLimitPercent": ("throttle_limit_percent", 1),
        },
    ),
    rc.RcDeadband: (
        "RC_DEADBAND_CONFIG",
        {
            "deadband": ("deadband", 1),
            "yaw_deadband": ("yaw_deadband", 1),
            "alt_hold_deadband": ("hold_deadband", 1),
            "deadband3d_throttle": ("throttle_deadband_3d", 1),
        },
    ),
    rc.FailsafeConfig: (
        "FAILSAFE_CONFIG",
        {
            "failsafe_delay": ("delay", 10),
            "failsafe_off_delay": ("landing_time", 1),
            "failsafe_throttle": ("throttle", 1),
            "failsafe_switch_mode": ("switch_mode", 1),
            "failsafe_throttle_low_delay": ("throttle_low_delay", 10),
            "failsafe_procedure": ("procedure", 1),
        },
    ),
    rc.RssiConfig: ("RSSI_CONFIG", {"channel": ("channel", 1)}),
    motors.MotorConfig: (
        "MOTOR_CONFIG",
        {
            "minthrottle": ("min_throttle", 1),
            "maxthrottle": ("max_throttle", 1),
            "mincommand": ("min_command", 1),
            "motor_count": ("motor_count", 1),
            "motor_poles": ("pole_count", 1),
            "use_dshot_telemetry": ("use_dshot_telemetry", 1),
            "use_esc_sensor": ("use_esc_sensor", 1),
        },
    ),
    motors.Motor3dConfig: (
        "MOTOR_3D_CONFIG",
        {
            "deadband3d_low": ("deadband_low", 1),
            "deadband3d_high": ("deadband_high", 1),
            "neutral": ("neutral", 1),
        },
    ),
    gps.GpsConfig: ("GPS_CONFIG", {"provider": ("provider", 1), "ublox_sbas": ("sbas_mode", 1)}),
    gps.GpsRescue: (
        "GPS_RESCUE",
        {
            "angle": ("max_angle", 1),
            "initialAltitudeM": ("return_altitude", 1),
            "descentDistanceM": ("descent_distance", 1),
            "rescueGroundspeed": ("ground_speed", 100),
            "throttleHover": ("throttle_hover", 1),
            "minSats": ("min_satellites", 1),
        },
    ),
    config.BeeperConfig: (
        "BEEPER_CONFIG",
        {
            "beepers": ("off_flags", 1),
            "dshotBeaconTone": ("dshot_beacon_tone", 1),
            "dshotBeaconConditions": ("dshot_beacon_off_flags", 1),
        },
    ),
    config.FeatureConfig: ("FEATURE_CONFIG", {"featuremask": ("features", 1)}),
    config.ArmingConfig: (
        "ARMING_CONFIG",
        {"auto_disarm_delay": ("auto_disarm_delay", 1), "small_angle": ("small_angle", 1)},
    ),
    blackbox.DataflashSummary: (
        "DATAFLASH",
        {
            "ready": ("is_ready", 1),
            "supported": ("is_supported", 1),
            "sectors": ("sectors", 1),
            "totalSize": ("total_size", 1),
            "usedSize": ("used_size", 1),
        },
    ),
    blackbox.SdCardSummary: (
        "SDCARD",
        {"state": ("state", 1), "freeSizeKB": ("free_size", 1), "totalSizeKB": ("total_size", 1)},
    ),
    pid.PidAdvanced: (
        "ADVANCED_TUNING",
        {
            "feedforwardTransition": ("feedforward_transition", 1),
            "levelAngleLimit": ("angle_limit", 1),
            "itermAcceleratorGain": ("anti_gravity_gain", 1),
            "itermRelax": ("iterm_relax", 1),
            "throttleBoost": ("throttle_boost", 1),
            "feedforwardRoll": ("roll_f", 1),
            "feedforwardYaw": ("yaw_f", 1),
            "dMinRoll": ("d_max_roll", 1),
            "dMinAdvance": ("d_max_advance", 1),
        },
    ),
    filters.FilterConfig: (
        "FILTER_CONFIG",
        {
            "gyro_lowpass_hz": ("gyro_lpf1_static_hz", 1),
            "gyro_lowpass2_hz": ("gyro_lpf2_static_hz", 1),
            "dterm_lowpass_hz": ("dterm_lpf1_static_hz", 1),
            "dterm_lowpass2_type": ("dterm_lpf2_type", 1),
            "yaw_lowpass_hz": ("yaw_lowpass_hz", 1),
            "gyro_notch2_cutoff": ("gyro_notch2_cutoff", 1),
            "dterm_lowpass_dyn_max_hz": ("dterm_lpf1_dyn_max_hz", 1),
        },
    ),
    sensors.SensorConfig: (
        "SENSOR_CONFIG",
        {"acc_hardware": ("accelerometer", 1), "mag_hardware": ("magnetometer", 1)},
    ),
}


def peer_after(message: TableMessage) -> Any:
    """YAMSPy after it has read the message."""
    peer = yamspy.MSPy.__new__(yamspy.MSPy)
    peer.__dict__.update(vars(PROTOTYPE))
    processor = getattr(yamspy.MSPy, f"process_{message.NAME}")
    processor(peer, bytearray(message.encode()))
    return peer


PROTOTYPE = yamspy.MSPy("/dev/null", logfilename=None, loglevel="CRITICAL")
PROTOTYPE.CONFIG["apiVersion"], PROTOTYPE.INAV = "1.43.0", False


@pytest.mark.parametrize("message_type", VALUES, ids=lambda message_type: message_type.__name__)
@settings(max_examples=20)
@given(data=st.data())
def test_values_of_a_group(message_type: type[TableMessage], data: st.DataObject) -> None:
    message = data.draw(records(message_type, None, complete=True))
    group, pairs = VALUES[message_type]
    peer = getattr(peer_after(message), group)
    for key, (field, scale) in pairs.items():
        assert peer[key] == pytest.approx(
            getattr(message, field) * scale, abs=0.006 if scale == 0.01 else 1e-6
        ), key


@settings(max_examples=20)
@given(data=st.data())
def test_values_of_lists(data: st.DataObject) -> None:
    attitude = data.draw(records(sensors.Attitude, None))
    assert peer_after(attitude).SENSOR_DATA["kinematics"] == [attitude.roll, attitude.pitch, attitude.heading]
    channels = data.draw(records(rc.Rc, None))
    assert peer_after(channels).RC["channels"] == list(channels.channels)
    outputs = data.draw(records(motors.Motor, None))
    assert list(outputs.motors) == peer_after(outputs).MOTOR_DATA
    gains = data.draw(records(pid.Pid, None))
    assert peer_after(gains).PIDs == [[gain.p, gain.i, gain.d] for gain in gains.controllers]
    ids = data.draw(records(modes.BoxIds, None))
    assert list(ids.ids) == peer_after(ids).AUX_CONFIG_IDS
    ranges = data.draw(records(modes.ModeRanges, None))
    assert [item["range"] for item in peer_after(ranges).MODE_RANGES] == [
        {"start": item.start, "end": item.end} for item in ranges.ranges
    ]
    ports = peer_after(
        config.CfSerialConfig((config.LegacySerialPort(51, config.SerialFunction.MSP, 5, 4, 0, 5),))
    )
    assert ports.SERIAL_CONFIG["ports"][0]["identifier"] == 51


def test_numbers_of_commands() -> None:
    known = yamspy.MSPy.MSPCodes
    common = {name: int(MspCommand[name]) for name in MspCommand.__members__ if name in known}
    assert len(common) > 100
    assert {name: number for name, number in common.items() if known[name] != number}.keys() <= OTHER_NAMES
