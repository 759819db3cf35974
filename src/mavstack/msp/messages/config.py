"""Settings of the vehicle as a whole: features, arming, beeper, name, clock, texts and serial ports."""

from __future__ import annotations

from enum import IntFlag

from mavstack.msp.commands import InavCommand, MspCommand
from mavstack.msp.messages.codecs import ByVariant, Items, Number
from mavstack.msp.messages.fields import (
    Record,
    RecordCodec,
    i32,
    of,
    prefixed_text,
    record,
    rest_text,
    u8,
    u16,
    u32,
)
from mavstack.msp.messages.layout import BETAFLIGHT_ONLY, INAV_ONLY, TableMessage, reply, request


class Feature(IntFlag):
    """Features of Betaflight."""

    RX_PPM = 1 << 0
    RX_UDP = 1 << 1
    INFLIGHT_ACC_CAL = 1 << 2
    RX_SERIAL = 1 << 3
    MOTOR_STOP = 1 << 4
    SERVO_TILT = 1 << 5
    SOFTSERIAL = 1 << 6
    GPS = 1 << 7
    OPTICALFLOW = 1 << 8
    RANGEFINDER = 1 << 9
    TELEMETRY = 1 << 10
    MOTOR_3D = 1 << 12
    RX_PARALLEL_PWM = 1 << 13
    RX_MSP = 1 << 14
    RSSI_ADC = 1 << 15
    LED_STRIP = 1 << 16
    DASHBOARD = 1 << 17
    OSD = 1 << 18
    CHANNEL_FORWARDING = 1 << 20
    TRANSPONDER = 1 << 21
    AIRMODE = 1 << 22
    RX_SPI = 1 << 25
    ESC_SENSOR = 1 << 27
    ANTI_GRAVITY = 1 << 28
    DYNAMIC_FILTER = 1 << 29


class InavFeature(IntFlag):
    """Features of iNav."""

    THR_VBAT_COMP = 1 << 0
    VBAT = 1 << 1
    TX_PROF_SEL = 1 << 2
    BAT_PROFILE_AUTOSWITCH = 1 << 3
    MOTOR_STOP = 1 << 4
    SOFTSERIAL = 1 << 6
    GPS = 1 << 7
    TELEMETRY = 1 << 10
    CURRENT_METER = 1 << 11
    REVERSIBLE_MOTORS = 1 << 12
    RSSI_ADC = 1 << 15
    LED_STRIP = 1 << 16
    DASHBOARD = 1 << 17
    BLACKBOX = 1 << 19
    TRANSPONDER = 1 << 21
    AIRMODE = 1 << 22
    SUPEREXPO_RATES = 1 << 23
    VTX = 1 << 24
    PWM_OUTPUT_ENABLE = 1 << 28
    OSD = 1 << 29
    FW_LAUNCH = 1 << 30
    FW_AUTOTRIM = 1 << 31


_FEATURES = ByVariant(Number("u32", kind=Feature), Number("u32", kind=InavFeature))


@reply(MspCommand.MSP_FEATURE_CONFIG)
class FeatureConfig(TableMessage):
    """Features that are switched on."""

    features: Feature | InavFeature = of(_FEATURES)


@request(MspCommand.MSP_SET_FEATURE_CONFIG)
class SetFeatureConfig(FeatureConfig):
    """Switch features on and off; they change with the next start."""


@reply(MspCommand.MSP_ARMING_CONFIG)
class ArmingConfig(TableMessage):
    """When the vehicle arms and disarms."""

    auto_disarm_delay: int = u8(unit="s")
    disarm_kill_switch: int = u8()
    small_angle: int | None = u8(unit="deg", variant="BTFL", default=None)
    gyro_cal_on_first_arm: bool | None = u8(kind=bool, since="1.44", variant="BTFL", default=None)


@request(MspCommand.MSP_SET_ARMING_CONFIG)
class SetArmingConfig(ArmingConfig):
    """Set when the vehicle arms and disarms."""


class BeeperFlag(IntFlag):
    """Occasions on which the beeper sounds."""

    GYRO_CALIBRATED = 1 << 0
    RX_LOST = 1 << 1
    RX_LOST_LANDING = 1 << 2
    DISARMING = 1 << 3
    ARMING = 1 << 4
    ARMING_GPS_FIX = 1 << 5
    BAT_CRIT_LOW = 1 << 6
    BAT_LOW = 1 << 7
    GPS_STATUS = 1 << 8
    RX_SET = 1 << 9
    ACC_CALIBRATION = 1 << 10
    ACC_CALIBRATION_FAIL = 1 << 11
    READY_BEEP = 1 << 12
    MULTI_BEEPS = 1 << 13
    DISARM_REPEAT = 1 << 14
    ARMED = 1 << 15
    SYSTEM_INIT = 1 << 16
    USB = 1 << 17
    BLACKBOX_ERASE = 1 << 18
    CRASHFLIP_MODE = 1 << 19
    CAM_CONNECTION_OPEN = 1 << 20
    CAM_CONNECTION_CLOSE = 1 << 21
    ARMING_GPS_NO_FIX = 1 << 22


@reply(MspCommand.MSP_BEEPER_CONFIG, BETAFLIGHT_ONLY)
class BeeperConfig(TableMessage):
    """Occasions on which the beeper, and the beacon of the motors, are silent."""

    off_flags: BeeperFlag = u32(kind=BeeperFlag)
    dshot_beacon_tone: int | None = u8(default=None)
    dshot_beacon_off_flags: BeeperFlag | None = u32(kind=BeeperFlag, default=None)


@request(MspCommand.MSP_SET_BEEPER_CONFIG, BETAFLIGHT_ONLY)
class SetBeeperConfig(BeeperConfig):
    """Set the occasions on which the beeper, and the beacon of the motors, are silent."""


@request(MspCommand.MSP_SET_NAME)
class SetName(TableMessage):
    """Set the name of the craft."""

    name: str = rest_text()


@reply(MspCommand.MSP_RTC, BETAFLIGHT_ONLY)
class Rtc(TableMessage):
    """Clock of Betaflight in UTC; an empty payload, and so None in all fields, means that it is not set."""

    year: int | None = u16(default=None)
    month: int | None = u8(default=None)
    day: int | None = u8(default=None)
    hour: int | None = u8(default=None)
    minute: int | None = u8(default=None)
    second: int | None = u8(default=None)
    millisecond: int | None = u16(default=None)


@request(MspCommand.MSP_SET_RTC, BETAFLIGHT_ONLY)
class SetRtc(TableMessage):
    """Set the clock of Betaflight, by the time since 1970 in UTC."""

    seconds: int = i32(unit="s")
    milliseconds: int = u16(unit="ms")


@reply(InavCommand.MSP_RTC, INAV_ONLY)
class InavRtc(TableMessage):
    """Clock of iNav, the time since 1970 in UTC; 0 means that it is not set."""

    seconds: int = i32(unit="s")
    milliseconds: int = u16(unit="ms")


@request(InavCommand.MSP_SET_RTC, INAV_ONLY)
class SetInavRtc(InavRtc):
    """Set the clock of iNav, by the time since 1970 in UTC."""


@request(MspCommand.MSP2_GET_TEXT, BETAFLIGHT_ONLY, since="1.45")
class GetText(TableMessage):
    """Ask for a text: 1 pilot, 2 craft, 3 PID profile, 4 rate profile, 5 build key, 6 release name."""

    kind: int = u8()


@reply(MspCommand.MSP2_GET_TEXT, BETAFLIGHT_ONLY, since="1.45")
class NamedText(TableMessage):
    """A text, by the kinds of `GetText`."""

    kind: int = u8()
    text: str = prefixed_text()


@request(MspCommand.MSP2_SET_TEXT, BETAFLIGHT_ONLY, since="1.45")
class SetText(NamedText):
    """Set a text, by the kinds of `GetText`; 7 to 10 are messages for the OSD."""


class SerialFunction(IntFlag):
    """Functions of a serial port of Betaflight."""

    MSP = 1 << 0
    GPS = 1 << 1
    TELEMETRY_FRSKY_HUB = 1 << 2
    TELEMETRY_HOTT = 1 << 3
    TELEMETRY_LTM = 1 << 4
    TELEMETRY_SMARTPORT = 1 << 5
    RX_SERIAL = 1 << 6
    BLACKBOX = 1 << 7
    TELEMETRY_MAVLINK = 1 << 9
    ESC_SENSOR = 1 << 10
    VTX_SMARTAUDIO = 1 << 11
    TELEMETRY_IBUS = 1 << 12
    VTX_TRAMP = 1 << 13
    RCDEVICE = 1 << 14
    LIDAR = 1 << 15
    FRSKY_OSD = 1 << 16
    VTX_MSP = 1 << 17
    GIMBAL = 1 << 18
    OSD_CUSTOM_TEXT = 1 << 19


class InavSerialFunction(IntFlag):
    """Functions of a serial port of iNav; the first eight are those of Betaflight."""

    MSP = 1 << 0
    GPS = 1 << 1
    TELEMETRY_FRSKY_HUB = 1 << 2
    TELEMETRY_HOTT = 1 << 3
    TELEMETRY_LTM = 1 << 4
    TELEMETRY_SMARTPORT = 1 << 5
    RX_SERIAL = 1 << 6
    BLACKBOX = 1 << 7
    TELEMETRY_MAVLINK = 1 << 8
    TELEMETRY_IBUS = 1 << 9
    RCDEVICE = 1 << 10
    VTX_SMARTAUDIO = 1 << 11
    VTX_TRAMP = 1 << 12
    OPTICAL_FLOW = 1 << 14
    LOG = 1 << 15
    RANGEFINDER = 1 << 16
    VTX_FFPV = 1 << 17
    ESC_SENSOR = 1 << 18
    TELEMETRY_SIM = 1 << 19
    FRSKY_OSD = 1 << 20
    DJI_HD_OSD = 1 << 21
    SERVO_SERIAL = 1 << 22
    SMARTPORT_MASTER = 1 << 23
    IMU2 = 1 << 24
    MSP_OSD = 1 << 25
    GIMBAL = 1 << 26
    GIMBAL_HEADTRACKER = 1 << 27


# fmt: off
BAUD_RATES = (
    0, 9600, 19200, 38400, 57600, 115200, 230400, 250000, 400000, 460800, 500000, 921600, 1000000, 1500000,
    2000000, 2470000,
)
"""Baud rates by their numbers in the settings of a serial port of Betaflight; 0 is automatic."""

INAV_BAUD_RATES = (
    0, 1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200, 230400, 250000, 460800, 921600, 1000000, 1500000,
    2000000, 2470000,
)
"""Baud rates by their numbers in the settings of a serial port of iNav; 0 is automatic."""
# fmt: on

_FUNCTIONS_16, _FUNCTIONS_32 = (
    ByVariant(Number(kind, kind=SerialFunction), Number(kind, kind=InavSerialFunction))
    for kind in ("u16", "u32")
)


@record
class LegacySerialPort(Record):
    """Functions and baud rates of a serial port; rates are positions in `BAUD_RATES` or `INAV_BAUD_RATES`."""

    port: int = u8()
    functions: SerialFunction | InavSerialFunction = of(_FUNCTIONS_16)
    msp_baud: int = u8()
    gps_baud: int = u8()
    telemetry_baud: int = u8()
    blackbox_baud: int = u8()


@record
class SerialPort(Record):
    """Functions and baud rates of a serial port; rates are positions in `BAUD_RATES` or `INAV_BAUD_RATES`."""

    port: int = u8()
    functions: SerialFunction | InavSerialFunction = of(_FUNCTIONS_32)
    msp_baud: int = u8()
    gps_baud: int = u8()
    telemetry_baud: int = u8()
    blackbox_baud: int = u8()


_PORTS = ByVariant(Items(RecordCodec(SerialPort), counted=True), Items(RecordCodec(SerialPort)))


@reply(MspCommand.MSP_CF_SERIAL_CONFIG)
class CfSerialConfig(TableMessage):
    """Functions and baud rates of the serial ports, with the first sixteen functions."""

    ports: tuple[LegacySerialPort, ...] = of(Items(RecordCodec(LegacySerialPort)))


@request(MspCommand.MSP_SET_CF_SERIAL_CONFIG)
class SetCfSerialConfig(CfSerialConfig):
    """Set the functions and baud rates of serial ports; Betaflight takes it up to API 1.48."""


@reply(MspCommand.MSP2_COMMON_SERIAL_CONFIG, since="1.43")
class SerialConfig(TableMessage):
    """Functions and baud rates of the serial ports."""

    ports: tuple[SerialPort, ...] = of(_PORTS)


@request(MspCommand.MSP2_COMMON_SET_SERIAL_CONFIG, since="1.43")
class SetSerialConfig(SerialConfig):
    """Set the functions and baud rates of serial ports; Betaflight takes it up to API 1.48."""
