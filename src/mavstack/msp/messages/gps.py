"""Position by the GPS receiver, its settings, and GPS Rescue."""

from __future__ import annotations

from mavstack.msp.commands import MspCommand
from mavstack.msp.messages.fields import Record, i32, items_of, record, u8, u16, u32
from mavstack.msp.messages.layout import BETAFLIGHT_ONLY, TableMessage, reply, request


@reply(MspCommand.MSP_RAW_GPS)
class RawGps(TableMessage):
    """Position and speed by the GPS receiver.

    `fix_type` is 0 without and 1 with a fix in Betaflight; in iNav 1 is a fix in two and 2 one in three
    dimensions.
    `dilution` is that of the position in Betaflight and the horizontal one in iNav.
    """

    fix_type: int = u8()
    satellites: int = u8()
    latitude: float = i32(1e7, "deg")
    longitude: float = i32(1e7, "deg")
    altitude: int = u16(unit="m")
    ground_speed: float = u16(100, "m/s")
    ground_course: float = u16(10, "deg")
    dilution: float | None = u16(100, since="1.44", default=None)


@reply(MspCommand.MSP_COMP_GPS)
class CompGps(TableMessage):
    """Distance and direction to home."""

    distance_to_home: int = u16(unit="m")
    direction_to_home: int = u16(unit="deg")
    heartbeat: int = u8()


@record
class Satellite(Record):
    """A satellite that the receiver tracks; `signal` is the ratio of carrier to noise."""

    channel: int = u8()
    satellite_id: int = u8()
    quality: int = u8()
    signal: int = u8(unit="dBHz")


@reply(MspCommand.MSP_GPSSVINFO)
class GpsSvInfo(TableMessage):
    """Satellites that the receiver tracks; iNav sends one entry without a meaning."""

    satellites: tuple[Satellite, ...] = items_of(Satellite, counted=True)


@reply(MspCommand.MSP_GPSSTATISTICS)
class GpsStatistics(TableMessage):
    """Counts of the connection to the receiver."""

    last_message_interval: float = u16(1000, "s")
    errors: int = u32()
    timeouts: int = u32()
    packets: int = u32()
    horizontal_dilution: float = u16(100)
    horizontal_accuracy: float = u16(100, "m")
    vertical_accuracy: float = u16(100, "m")
    hardware: int | None = u8(default=None)


@request(MspCommand.MSP_SET_RAW_GPS)
class SetRawGps(TableMessage):
    """Give the flight controller a position, for a receiver that is connected by MSP."""

    fix_type: int = u8()
    satellites: int = u8()
    latitude: float = i32(1e7, "deg")
    longitude: float = i32(1e7, "deg")
    altitude: int = u16(unit="m")
    ground_speed: float = u16(100, "m/s")


@reply(MspCommand.MSP_GPS_CONFIG, BETAFLIGHT_ONLY)
class GpsConfig(TableMessage):
    """Settings of the GPS receiver."""

    provider: int = u8()
    sbas_mode: int = u8()
    auto_config: bool = u8(kind=bool)
    auto_baud: bool = u8(kind=bool)
    set_home_point_once: bool | None = u8(kind=bool, since="1.43", default=None)
    ublox_use_galileo: bool | None = u8(kind=bool, since="1.43", default=None)


@request(MspCommand.MSP_SET_GPS_CONFIG, BETAFLIGHT_ONLY)
class SetGpsConfig(GpsConfig):
    """Set the settings of the GPS receiver."""


@reply(MspCommand.MSP_GPS_RESCUE, BETAFLIGHT_ONLY)
class GpsRescue(TableMessage):
    """Settings of GPS Rescue, the return to home of Betaflight."""

    max_angle: int = u16(unit="deg")
    return_altitude: int = u16(unit="m")
    descent_distance: int = u16(unit="m")
    ground_speed: float = u16(100, "m/s")
    throttle_min: int = u16(unit="us")
    throttle_max: int = u16(unit="us")
    throttle_hover: int = u16(unit="us")
    sanity_checks: int = u8()
    min_satellites: int = u8()
    ascend_rate: float | None = u16(100, "m/s", since="1.43", default=None)
    descend_rate: float | None = u16(100, "m/s", since="1.43", default=None)
    allow_arming_without_fix: bool | None = u8(kind=bool, since="1.43", default=None)
    altitude_mode: int | None = u8(since="1.43", default=None)
    min_start_distance: int | None = u16(unit="m", since="1.44", default=None)
    initial_climb: int | None = u16(unit="m", since="1.46", default=None)


@request(MspCommand.MSP_SET_GPS_RESCUE, BETAFLIGHT_ONLY)
class SetGpsRescue(GpsRescue):
    """Set the settings of GPS Rescue."""


@reply(MspCommand.MSP_GPS_RESCUE_PIDS, BETAFLIGHT_ONLY)
class GpsRescuePids(TableMessage):
    """Controllers of GPS Rescue for altitude, velocity over ground and yaw."""

    altitude_p: int = u16()
    altitude_i: int = u16()
    altitude_d: int = u16()
    velocity_p: int = u16()
    velocity_i: int = u16()
    velocity_d: int = u16()
    yaw_p: int = u16()


@request(MspCommand.MSP_SET_GPS_RESCUE_PIDS, BETAFLIGHT_ONLY)
class SetGpsRescuePids(GpsRescuePids):
    """Set the controllers of GPS Rescue."""
