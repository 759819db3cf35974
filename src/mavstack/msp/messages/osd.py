"""On-screen display: units, alarms, items, statistics, timers and warnings."""

from __future__ import annotations

from enum import IntEnum

from mavstack.msp.commands import MspCommand
from mavstack.msp.messages.codecs import ByVariant, Items, Number, PrefixedText
from mavstack.msp.messages.fields import i16, items_of, of, u8, u16, u32
from mavstack.msp.messages.layout import BETAFLIGHT_ONLY, INAV_ONLY, TableMessage, reply, request

GENERAL_SETTINGS, TIMER_SETTINGS = 255, 254
STATISTICS_SCREEN, FLIGHT_SCREEN = 0, 1


class VideoSystem(IntEnum):
    """Video system of the display."""

    AUTO = 0
    PAL = 1
    NTSC = 2
    HD = 3


class OsdUnits(IntEnum):
    """Units of the display."""

    IMPERIAL = 0
    METRIC = 1
    BRITISH = 2


@reply(MspCommand.MSP_OSD_CONFIG)
class OsdConfig(TableMessage):
    """Settings of the on-screen display; without one only `flags` is there, 0.

    `items` are numbers of `OsdPosition.from_bits`, in the order of `OSD_ITEMS` in Betaflight.
    """

    flags: int = u8()
    video_system: VideoSystem | None = u8(kind=VideoSystem, default=None)
    units: OsdUnits | None = u8(kind=OsdUnits, default=None)
    rssi_alarm: int | None = u8(unit="%", default=None)
    capacity_alarm: int | None = u16(unit="mAh", default=None)
    time_alarm: int | None = u16(unit="s", variant="INAV", default=None)
    reserved: int | None = u8(variant="BTFL", default=None)
    item_count: int | None = u8(variant="BTFL", default=None)
    altitude_alarm: int | None = u16(unit="m", default=None)
    distance_alarm: int | None = u16(unit="m", variant="INAV", default=None)
    negative_altitude_alarm: int | None = u16(unit="m", variant="INAV", default=None)
    items: tuple[int, ...] | None = of(
        ByVariant(Items(Number("u16"), count_field="item_count"), Items(Number("u16"))), default=None
    )
    statistics: tuple[int, ...] | None = items_of(Number("u8"), counted=True, variant="BTFL", default=None)
    timers: tuple[int, ...] | None = items_of(Number("u16"), counted=True, variant="BTFL", default=None)
    warnings_low: int | None = u16(variant="BTFL", default=None)
    warning_count: int | None = u8(since="1.41", variant="BTFL", default=None)
    warnings: int | None = u32(since="1.41", variant="BTFL", default=None)
    profile_count: int | None = u8(since="1.41", variant="BTFL", default=None)
    profile: int | None = u8(since="1.41", variant="BTFL", default=None)
    stick_overlay_mode: int | None = u8(since="1.41", variant="BTFL", default=None)
    camera_frame_width: int | None = u8(since="1.43", variant="BTFL", default=None)
    camera_frame_height: int | None = u8(since="1.43", variant="BTFL", default=None)
    link_quality_alarm: int | None = u16(since="1.46", variant="BTFL", default=None)
    rssi_dbm_alarm: int | None = i16(unit="dBm", since="1.47", variant="BTFL", default=None)


@request(MspCommand.MSP_SET_OSD_CONFIG, BETAFLIGHT_ONLY)
class SetOsdConfig(TableMessage):
    """Set units, alarms and warnings of the on-screen display."""

    address: int = u8(default=GENERAL_SETTINGS)
    video_system: VideoSystem = u8(kind=VideoSystem, default=VideoSystem.AUTO)
    units: OsdUnits = u8(kind=OsdUnits, default=OsdUnits.METRIC)
    rssi_alarm: int = u8(unit="%", default=20)
    capacity_alarm: int = u16(unit="mAh", default=2200)
    reserved_timer: int = u16(default=0)
    altitude_alarm: int = u16(unit="m", default=100)
    warnings_low: int | None = u16(default=None)
    warnings: int | None = u32(since="1.41", default=None)
    profile: int | None = u8(since="1.41", default=None)
    stick_overlay_mode: int | None = u8(since="1.41", default=None)
    camera_frame_width: int | None = u8(since="1.43", default=None)
    camera_frame_height: int | None = u8(since="1.43", default=None)
    link_quality_alarm: int | None = u16(since="1.46", default=None)
    rssi_dbm_alarm: int | None = i16(unit="dBm", since="1.47", default=None)


@request(MspCommand.MSP_SET_OSD_CONFIG)
class SetOsdItem(TableMessage):
    """Set the position of an item, by `OsdPosition.to_bits`; on screen 0 show or hide a statistic."""

    item: int = u8()
    position: int = u16()
    screen: int | None = u8(variant="BTFL", default=None)


@request(MspCommand.MSP_SET_OSD_CONFIG, BETAFLIGHT_ONLY)
class SetOsdTimer(TableMessage):
    """Set a timer: source in bits 0 to 3, precision in bits 4 to 7, alarm in minutes from bit 8 on."""

    address: int = u8(default=TIMER_SETTINGS)
    index: int = u8(default=0)
    timer: int = u16(default=0)


@reply(MspCommand.MSP_OSD_CANVAS, BETAFLIGHT_ONLY, since="1.45")
class OsdCanvas(TableMessage):
    """Size of a digital display."""

    columns: int = u8()
    rows: int = u8()


@reply(MspCommand.MSP2_GET_OSD_WARNINGS, BETAFLIGHT_ONLY, since="1.46")
class OsdWarnings(TableMessage):
    """The warning that the display shows at present."""

    severity: int = u8()
    text: str = of(PrefixedText())


@request(MspCommand.MSP2_INAV_OSD_LAYOUTS, INAV_ONLY)
class GetInavOsdLayout(TableMessage):
    """Ask for the items of a layout."""

    layout: int = u8()


@reply(MspCommand.MSP2_INAV_OSD_LAYOUTS, INAV_ONLY)
class InavOsdLayout(TableMessage):
    """Positions of the items of a layout of iNav."""

    items: tuple[int, ...] = items_of(Number("u16"))


@request(MspCommand.MSP2_INAV_OSD_SET_LAYOUT_ITEM, INAV_ONLY)
class SetInavOsdItem(TableMessage):
    """Set the position of an item in a layout of iNav."""

    layout: int = u8()
    item: int = u8()
    position: int = u16()
