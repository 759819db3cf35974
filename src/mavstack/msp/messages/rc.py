"""Radio control: channels, rates, dead bands, receiver, signal strength and failsafe."""

from __future__ import annotations

from enum import IntEnum

from mavstack.msp.commands import MspCommand
from mavstack.msp.messages.codecs import Number
from mavstack.msp.messages.fields import Record, i16, items_of, raw, record, u8, u16, u32
from mavstack.msp.messages.layout import BETAFLIGHT_ONLY, INAV_ONLY, TableMessage, reply, request


@reply(MspCommand.MSP_RC)
class Rc(TableMessage):
    """Pulse widths of the channels in microseconds: roll, pitch, yaw, throttle, then AUX 1, AUX 2 …."""

    channels: tuple[int, ...] = items_of(Number("u16"), unit="us")


@request(MspCommand.MSP_SET_RAW_RC)
class SetRawRc(TableMessage):
    """Give the channels as a receiver does, in microseconds and in the order of MSP_RX_MAP.

    The flight controller takes them if its receiver is MSP (`FEATURE_RX_MSP`), or for the channels of
    `msp_override_channels_mask` while the mode MSP OVERRIDE is active. It wants them at least every 0.2 s.
    """

    channels: tuple[int, ...] = items_of(Number("u16"), unit="us")


@reply(MspCommand.MSP_RC_TUNING)
class RcTuning(TableMessage):
    """Rates and expo of the sticks, by the numbers of the firmware: hundredths, and rates by `rates_type`.

    Since API 1.47 Betaflight has the attenuation by throttle in MSP_PID_ADVANCED and sends 0 here.
    """

    rc_rate: int = u8()
    rc_expo: int = u8()
    roll_rate: int = u8()
    pitch_rate: int = u8()
    yaw_rate: int = u8()
    tpa_rate: int = u8()
    throttle_mid: int = u8()
    throttle_expo: int = u8()
    tpa_breakpoint: int = u16(unit="us")
    yaw_expo: int | None = u8(default=None)
    yaw_rc_rate: int | None = u8(variant="BTFL", default=None)
    pitch_rc_rate: int | None = u8(variant="BTFL", default=None)
    pitch_expo: int | None = u8(variant="BTFL", default=None)
    throttle_limit_type: int | None = u8(since="1.41", variant="BTFL", default=None)
    throttle_limit_percent: int | None = u8(unit="%", since="1.41", variant="BTFL", default=None)
    roll_rate_limit: int | None = u16(unit="deg/s", since="1.42", variant="BTFL", default=None)
    pitch_rate_limit: int | None = u16(unit="deg/s", since="1.42", variant="BTFL", default=None)
    yaw_rate_limit: int | None = u16(unit="deg/s", since="1.42", variant="BTFL", default=None)
    rates_type: int | None = u8(since="1.43", variant="BTFL", default=None)
    throttle_hover: int | None = u8(since="1.47", variant="BTFL", default=None)


@request(MspCommand.MSP_SET_RC_TUNING)
class SetRcTuning(RcTuning):
    """Set the rates and expo of the sticks."""


@reply(MspCommand.MSP2_INAV_RATE_PROFILE, INAV_ONLY)
class InavRateProfile(TableMessage):
    """Rates and expo of iNav; rates in tens of degrees per second, those of the mode MANUAL in percent."""

    throttle_mid: int = u8()
    throttle_expo: int = u8()
    tpa_rate: int = u8()
    tpa_breakpoint: int = u16(unit="us")
    rc_expo: int = u8()
    yaw_expo: int = u8()
    roll_rate: int = u8()
    pitch_rate: int = u8()
    yaw_rate: int = u8()
    manual_rc_expo: int = u8()
    manual_yaw_expo: int = u8()
    manual_roll_rate: int = u8(unit="%")
    manual_pitch_rate: int = u8(unit="%")
    manual_yaw_rate: int = u8(unit="%")


@request(MspCommand.MSP2_INAV_SET_RATE_PROFILE, INAV_ONLY)
class SetInavRateProfile(InavRateProfile):
    """Set the rates and expo of iNav."""


@reply(MspCommand.MSP_RC_DEADBAND)
class RcDeadband(TableMessage):
    """Movements of the sticks around the middle that do nothing."""

    deadband: int = u8(unit="us")
    yaw_deadband: int = u8(unit="us")
    hold_deadband: int = u8()
    throttle_deadband_3d: int = u16(unit="us")


@request(MspCommand.MSP_SET_RC_DEADBAND)
class SetRcDeadband(RcDeadband):
    """Set the movements of the sticks around the middle that do nothing."""


@reply(MspCommand.MSP_RX_CONFIG)
class RxConfig(TableMessage):
    """Settings of the receiver; fields that newer versions do not use are 0."""

    serial_provider: int = u8()
    max_check: int = u16(unit="us")
    mid_rc: int = u16(unit="us")
    min_check: int = u16(unit="us")
    spektrum_bind: int = u8()
    rx_min: int | None = u16(unit="us", default=None)
    rx_max: int | None = u16(unit="us", default=None)
    rc_interpolation: int | None = u8(default=None)
    rc_interpolation_interval: int | None = u8(default=None)
    airmode_threshold: int | None = u16(unit="us", default=None)
    spi_protocol: int | None = u8(default=None)
    spi_id: int | None = u32(default=None)
    spi_channel_count: int | None = u8(default=None)
    fpv_mix: int | None = u8(unit="deg", default=None)
    receiver_type: int | None = u8(variant="INAV", default=None)
    rc_smoothing_channels: int | None = u8(variant="BTFL", default=None)
    rc_smoothing_type: int | None = u8(variant="BTFL", default=None)
    rc_smoothing_setpoint_cutoff: int | None = u8(unit="Hz", variant="BTFL", default=None)
    rc_smoothing_throttle_cutoff: int | None = u8(unit="Hz", variant="BTFL", default=None)
    rc_smoothing_throttle_factor: int | None = u8(variant="BTFL", default=None)
    rc_smoothing_derivative_type: int | None = u8(variant="BTFL", default=None)
    usb_type: int | None = u8(variant="BTFL", default=None)
    rc_smoothing_factor: int | None = u8(since="1.42", variant="BTFL", default=None)
    rc_smoothing: int | None = u8(since="1.44", variant="BTFL", default=None)
    elrs_uid: bytes | None = raw(6, since="1.45", variant="BTFL", default=None)
    elrs_model: int | None = u8(since="1.47", variant="BTFL", default=None)


@request(MspCommand.MSP_SET_RX_CONFIG)
class SetRxConfig(RxConfig):
    """Set the settings of the receiver."""


@reply(MspCommand.MSP_RX_MAP)
class RxMap(TableMessage):
    """Order of the receiver's channels: at which position roll, pitch, yaw, throttle and AUX 1 … arrive."""

    positions: tuple[int, ...] = items_of(Number("u8"))


@request(MspCommand.MSP_SET_RX_MAP)
class SetRxMap(RxMap):
    """Set the order of the receiver's channels."""


@reply(MspCommand.MSP_RSSI_CONFIG)
class RssiConfig(TableMessage):
    """Channel that carries the strength of the signal; 0 for none."""

    channel: int = u8()


@request(MspCommand.MSP_SET_RSSI_CONFIG)
class SetRssiConfig(RssiConfig):
    """Set the channel that carries the strength of the signal; 0 for none."""


@request(MspCommand.MSP_SET_TX_INFO)
class SetTxInfo(TableMessage):
    """Tell the strength of the signal, 0 to 255, for the source MSP."""

    rssi: int = u8()


@reply(MspCommand.MSP_TX_INFO)
class TxInfo(TableMessage):
    """Source of the signal strength, and whether the clock is set; 255 means that there is no clock."""

    rssi_source: int = u8()
    clock_state: int = u8()


class FailsafeProcedure(IntEnum):
    """Reaction of the vehicle to a lost radio signal."""

    AUTO_LANDING = 0
    DROP_IT = 1
    GPS_RESCUE = 2


@reply(MspCommand.MSP_FAILSAFE_CONFIG)
class FailsafeConfig(TableMessage):
    """Reaction to a lost radio signal.

    `procedure` is a `FailsafeProcedure` in Betaflight; in iNav 2 is the return to home and 3 nothing.
    """

    delay: float = u8(10, "s")
    landing_time: int = u8()
    throttle: int = u16(unit="us")
    switch_mode: int = u8()
    throttle_low_delay: float = u16(10, "s")
    procedure: FailsafeProcedure = u8(kind=FailsafeProcedure)
    recovery_delay: float | None = u8(10, "s", variant="INAV", default=None)
    fixed_wing_roll: float | None = i16(10, "deg", variant="INAV", default=None)
    fixed_wing_pitch: float | None = i16(10, "deg", variant="INAV", default=None)
    fixed_wing_yaw_rate: int | None = i16(unit="deg/s", variant="INAV", default=None)
    stick_threshold: int | None = u16(unit="us", variant="INAV", default=None)
    min_distance: float | None = u16(100, "m", variant="INAV", default=None)
    min_distance_procedure: int | None = u8(variant="INAV", default=None)


@request(MspCommand.MSP_SET_FAILSAFE_CONFIG)
class SetFailsafeConfig(FailsafeConfig):
    """Set the reaction to a lost radio signal."""


@record
class ChannelFailsafe(Record):
    """Value of a channel without a signal: mode 0 automatic, 1 hold, 2 the value."""

    mode: int = u8()
    value: int = u16(unit="us")


@reply(MspCommand.MSP_RXFAIL_CONFIG, BETAFLIGHT_ONLY)
class RxFailConfig(TableMessage):
    """Values of the channels without a signal."""

    channels: tuple[ChannelFailsafe, ...] = items_of(ChannelFailsafe)


@request(MspCommand.MSP_SET_RXFAIL_CONFIG, BETAFLIGHT_ONLY)
class SetRxFailConfig(TableMessage):
    """Set the value of one channel without a signal: mode 0 automatic, 1 hold, 2 the value."""

    channel: int = u8()
    mode: int = u8()
    value: int = u16(unit="us")
