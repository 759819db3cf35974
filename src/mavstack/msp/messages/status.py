"""Status of the flight controller: load, sensors, active modes, reasons not to arm, state of the sensors."""

from __future__ import annotations

from enum import IntEnum

from mavstack.msp.commands import MspCommand
from mavstack.msp.messages.arming import (
    InavArmingFlag,
    SensorFlag,
    betaflight_arming_reasons,
    inav_arming_reasons,
)
from mavstack.msp.messages.codecs import Number
from mavstack.msp.messages.fields import counted_raw, i16, items_of, raw, u8, u16, u32
from mavstack.msp.messages.layout import INAV_ONLY, TableMessage, reply


@reply(MspCommand.MSP_STATUS)
class Status(TableMessage):
    """Load, sensors, active modes and, from Betaflight, the reasons not to arm."""

    cycle_time: float = u16(1e6, "s")
    i2c_errors: int = u16()
    sensors: SensorFlag = u16(kind=SensorFlag)
    mode_flags: int = u32()
    pid_profile: int = u8()
    load: int | None = u16(unit="%", variant="BTFL", default=None)
    gyro_cycle_time: int | None = u16(variant="BTFL", default=None)
    extra_mode_flags: bytes | None = counted_raw(variant="BTFL", default=None)
    arming_disable_flag_count: int | None = u8(variant="BTFL", default=None)
    arming_disable_flags: int | None = u32(variant="BTFL", default=None)
    config_state_flags: int | None = u8(variant="BTFL", default=None)
    core_temperature: int | None = i16(unit="degC", since="1.46", variant="BTFL", default=None)
    rate_profile_count: int | None = u8(since="1.46", variant="BTFL", default=None)
    battery_profile_count: int | None = u8(since="1.48", variant="BTFL", default=None)
    battery_profile: int | None = u8(since="1.48", variant="BTFL", default=None)

    @property
    def active_modes(self) -> tuple[int, ...]:
        """Positions in the lists of MSP_BOXIDS and MSP_BOXNAMES of the modes that are active."""
        return active_positions(self.mode_flags, self.extra_mode_flags)

    @property
    def arming_disable_reasons(self) -> tuple[str, ...] | None:
        """Names of the reasons not to arm; None where the firmware does not send them here."""
        if self.arming_disable_flags is None:
            return None
        return betaflight_arming_reasons(self.arming_disable_flags, self.arming_disable_flag_count)


@reply(MspCommand.MSP_STATUS_EX)
class StatusEx(TableMessage):
    """Load, sensors, active modes and profiles, and the reasons not to arm."""

    cycle_time: float = u16(1e6, "s")
    i2c_errors: int = u16()
    sensors: SensorFlag = u16(kind=SensorFlag)
    mode_flags: int = u32()
    pid_profile: int = u8()
    load: int = u16(unit="%")
    arming_flags: InavArmingFlag | None = u16(kind=InavArmingFlag, variant="INAV", default=None)
    accelerometer_calibrated_axes: int | None = u8(variant="INAV", default=None)
    pid_profile_count: int | None = u8(variant="BTFL", default=None)
    rate_profile: int | None = u8(variant="BTFL", default=None)
    extra_mode_flags: bytes | None = counted_raw(variant="BTFL", default=None)
    arming_disable_flag_count: int | None = u8(variant="BTFL", default=None)
    arming_disable_flags: int | None = u32(variant="BTFL", default=None)
    config_state_flags: int | None = u8(variant="BTFL", default=None)
    core_temperature: int | None = i16(unit="degC", since="1.46", variant="BTFL", default=None)
    rate_profile_count: int | None = u8(since="1.46", variant="BTFL", default=None)
    battery_profile_count: int | None = u8(since="1.48", variant="BTFL", default=None)
    battery_profile: int | None = u8(since="1.48", variant="BTFL", default=None)

    @property
    def active_modes(self) -> tuple[int, ...]:
        """Positions in the lists of MSP_BOXIDS and MSP_BOXNAMES of the modes that are active."""
        return active_positions(self.mode_flags, self.extra_mode_flags)

    @property
    def arming_disable_reasons(self) -> tuple[str, ...] | None:
        """Names of the reasons not to arm; None if the firmware does not send them here.

        iNav sends only its first sixteen flags here; MSP2_INAV_STATUS has all of them.
        """
        if self.arming_flags is not None:
            return inav_arming_reasons(self.arming_flags)
        if self.arming_disable_flags is None:
            return None
        return betaflight_arming_reasons(self.arming_disable_flags, self.arming_disable_flag_count)


@reply(MspCommand.MSP2_INAV_STATUS, INAV_ONLY)
class InavStatus(TableMessage):
    """Status of iNav with all its arming flags and modes.

    The number of bytes for the modes depends on the version; since version 7 the mixer profile follows them.
    """

    cycle_time: float = u16(1e6, "s")
    i2c_errors: int = u16()
    sensors: SensorFlag = u16(kind=SensorFlag)
    load: int = u16(unit="%")
    profiles: int = u8()
    arming_flags: InavArmingFlag = u32(kind=InavArmingFlag)
    mode_words: tuple[int, ...] = items_of(Number("u32"), leave=3)
    mixer_profile: int | None = u8(default=None)

    @property
    def pid_profile(self) -> int:
        """Index of the active profile."""
        return self.profiles & 0x0F

    @property
    def battery_profile(self) -> int:
        """Index of the active battery profile."""
        return self.profiles >> 4

    @property
    def active_modes(self) -> tuple[int, ...]:
        """Positions in the lists of MSP_BOXIDS and MSP_BOXNAMES of the modes that are active."""
        return _positions(sum(word << 32 * index for index, word in enumerate(self.mode_words)))

    @property
    def is_armed(self) -> bool:
        """True if the vehicle is armed."""
        return bool(self.arming_flags & InavArmingFlag.ARMED)

    @property
    def arming_disable_reasons(self) -> tuple[str, ...]:
        """Names of the reasons not to arm."""
        return inav_arming_reasons(self.arming_flags)


class HardwareStatus(IntEnum):
    """State of a sensor."""

    NONE = 0
    OK = 1
    UNAVAILABLE = 2
    UNHEALTHY = 3


@reply(MspCommand.MSP_SENSOR_STATUS, INAV_ONLY)
class SensorStatus(TableMessage):
    """Health of each sensor of iNav."""

    is_healthy: bool = u8(kind=bool)
    gyro: HardwareStatus = u8(kind=HardwareStatus)
    accelerometer: HardwareStatus = u8(kind=HardwareStatus)
    magnetometer: HardwareStatus = u8(kind=HardwareStatus)
    barometer: HardwareStatus = u8(kind=HardwareStatus)
    gps: HardwareStatus = u8(kind=HardwareStatus)
    rangefinder: HardwareStatus = u8(kind=HardwareStatus)
    pitot: HardwareStatus = u8(kind=HardwareStatus)
    optical_flow: HardwareStatus = u8(kind=HardwareStatus)


@reply(MspCommand.MSP_ACTIVEBOXES, INAV_ONLY)
class ActiveBoxes(TableMessage):
    """All active modes of iNav, as bits."""

    mode_flags: bytes = raw()

    @property
    def active_modes(self) -> tuple[int, ...]:
        """Positions in the lists of MSP_BOXIDS and MSP_BOXNAMES of the modes that are active."""
        return _positions(int.from_bytes(self.mode_flags, "little"))


@reply(MspCommand.MSP_DEBUG)
class Debug(TableMessage):
    """Values that a developer of the firmware watches: eight of Betaflight, four of iNav."""

    values: tuple[int, ...] = items_of(Number("i16"))


def active_positions(mode_flags: int, extra_mode_flags: bytes | None = None) -> tuple[int, ...]:
    """Return the positions of the bits that are set.

    Args:
        mode_flags: The first 32 bits.
        extra_mode_flags: The bits from 32 on; None if there are none.
    """
    return _positions(mode_flags | int.from_bytes(extra_mode_flags or b"", "little") << 32)


def _positions(bits: int) -> tuple[int, ...]:
    return tuple(position for position in range(bits.bit_length()) if bits >> position & 1)
