"""Settings of the video transmitter and of Betaflight's on-screen display."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, cast

from mavstack.msp.messages.osd import FLIGHT_SCREEN, OsdConfig, SetOsdConfig, SetOsdItem, SetOsdTimer
from mavstack.msp.messages.osd_items import OSD_ITEMS
from mavstack.msp.messages.vtx import SetVtxConfig, VtxConfig
from mavstack.msp.settings.definition import SettingDefinition, define

if TYPE_CHECKING:
    from mavstack.msp.messages.layout import TableMessage

CHANNELS_OF_A_BAND = 8


def _vtx_message(current: TableMessage, name: str, value: int) -> TableMessage:
    """Return the video transmitter's settings with another one.

    A frequency takes effect only without a band. Old firmwares and iNav know band and channel, or the
    frequency, as one number.
    """
    old = cast("VtxConfig", current)
    changes: dict[str, object] = {VTX_FIELDS[name]: value, "table_bands": None, "table_channels": None}
    changes |= {"table_powers": None}
    if name == "BF_VTX_FREQ" and value:
        changes["band"] = 0
    band = int(str(changes.get("band", old.band) or 0))
    channel = int(str(changes.get("channel", old.channel) or 0))
    frequency = int(str(changes.get("frequency", old.frequency) or 0))
    by_band = CHANNELS_OF_A_BAND * (band - 1) + max(channel, 1) - 1
    return SetVtxConfig.from_message(current, combined=by_band if band else frequency, **changes)


_vtx = partial(define, messages=(VtxConfig, SetVtxConfig), build=_vtx_message)
_BOTH, _ONLY = ("BTFL", "INAV"), ("BTFL",)

VTX = (
    _vtx("BF_VTX_BAND", "band", "Band, from 1; 0 for a frequency", 0, 8),
    _vtx("BF_VTX_CHANNEL", "channel", "Channel of the band, from 1", 0, 8),
    _vtx("BF_VTX_POWER", "power", "Level of the power, from 1", 0, 8),
    _vtx("BF_VTX_PIT", "pit_mode", "Pit mode, in which the power is tiny"),
    _vtx(
        "BF_VTX_LOW_POWER",
        "low_power_disarm",
        "Low power",
        values=("never", "while disarmed", "until armed first"),
    ),
    _vtx("BF_VTX_FREQ", "frequency", "Frequency without a band", 0, 5999, variants=_ONLY),
    _vtx(
        "BF_VTX_PIT_FREQ",
        "pit_mode_frequency",
        "Frequency of the pit mode; 0 for none",
        0,
        5999,
        variants=_ONLY,
    ),
)
VTX_FIELDS = {item.name: item.path.field for item in VTX}

_osd = partial(define, messages=(OsdConfig, SetOsdConfig), variants=_ONLY)
_VIDEO = ("automatic", "PAL", "NTSC", "HD")
_UNITS = ("imperial", "metric", "British")


def _warnings_message(current: TableMessage, name: str, value: int) -> TableMessage:
    """Return the display's settings with other warnings, which also stand in a field of sixteen bits."""
    return SetOsdConfig.from_message(current, warnings=value, warnings_low=value & 0xFFFF)


OSD = (
    _osd("BF_OSD_VIDEO", "video_system", "Video system", values=_VIDEO),
    _osd("BF_OSD_UNITS", "units", "Units", values=_UNITS),
    _osd("BF_OSD_RSSI_ALRM", "rssi_alarm", "Strength of the signal that gives an alarm", 0, 100),
    _osd("BF_OSD_CAP_ALRM", "capacity_alarm", "Charge that gives an alarm", 0, 20000),
    _osd("BF_OSD_ALT_ALRM", "altitude_alarm", "Altitude that gives an alarm", 0, 10000),
    _osd("BF_OSD_WARNINGS", "warnings", "Warnings that are shown, as bits", build=_warnings_message),
    _osd("BF_OSD_PROFILE", "profile", "Profile that is shown, from 1", 1, 3),
    _osd(
        "BF_OSD_OVERLAY", "stick_overlay_mode", "Mode of the transmitter, for the overlay of the sticks", 0, 4
    ),
    _osd("BF_OSD_CAM_WIDTH", "camera_frame_width", "Width of the camera frame in columns", 2, 30),
    _osd("BF_OSD_CAM_HIGHT", "camera_frame_height", "Height of the camera frame in rows", 2, 16),
    _osd("BF_OSD_LQ_ALRM", "link_quality_alarm", "Quality of the radio link that gives an alarm", 0, 100),
    _osd("BF_OSD_DBM_ALRM", "rssi_dbm_alarm", "Strength of the signal that gives an alarm", -130, 0),
)


def _item(index: int, name: str) -> SettingDefinition:
    def build(current: TableMessage, setting: str, value: int) -> TableMessage:
        return SetOsdItem(index, value, FLIGHT_SCREEN)

    title = name.replace("_", " ").lower()
    return define(
        f"BF_OSD_{index}_POS",
        f"items[{index}]",
        f"Position of the item {title}: column, row and profiles as bits",
        messages=(OsdConfig, SetOsdItem),
        variants=_ONLY,
        alias=f"BF_OSD_ITEM_{index}_POS",
        build=build,
    )


def _timer(index: int) -> SettingDefinition:
    def build(current: TableMessage, setting: str, value: int) -> TableMessage:
        return SetOsdTimer(index=index, timer=value)

    description = f"Timer {index + 1}: source, precision and alarm as bits"
    messages = (OsdConfig, SetOsdTimer)
    return define(
        f"BF_OSD_TIMER_{index + 1}",
        f"timers[{index}]",
        description,
        messages=messages,
        variants=_ONLY,
        build=build,
    )


OSD_TIMERS = tuple(_timer(index) for index in range(2))
OSD_POSITIONS = tuple(_item(index, name) for index, name in enumerate(OSD_ITEMS))

VIDEO = VTX + OSD + OSD_TIMERS + OSD_POSITIONS
