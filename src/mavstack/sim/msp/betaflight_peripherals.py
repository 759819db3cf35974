"""The defaults of Betaflight's settings around the flight: beeper, video, display, logs, servos, LEDs."""

from __future__ import annotations

from typing import Final

from mavstack.msp.messages.blackbox import DataflashSummary, SdCardState, SdCardSummary
from mavstack.msp.messages.config import BeeperConfig, BeeperFlag
from mavstack.msp.messages.gps import GpsSvInfo
from mavstack.msp.messages.led_strip import HsvColor, LedColors, LedStripConfig, LedStripValues
from mavstack.msp.messages.modes import AdjustmentRange, AdjustmentRanges
from mavstack.msp.messages.motors import Servo, ServoConfigurations, ServoMixRules, ServoSettings
from mavstack.msp.messages.osd import OsdCanvas, OsdConfig, OsdUnits, VideoSystem
from mavstack.msp.messages.pid import PidController, PidNames
from mavstack.msp.messages.rc import ChannelFailsafe, RxFailConfig, TxInfo
from mavstack.msp.messages.sensors import SonarAltitude
from mavstack.msp.messages.status import Debug
from mavstack.msp.messages.vtx import VtxConfig, VtxType

#: On-screen display: number of items, the position value of a hidden item, and the positions of the visible
#: items.
OSD_ITEM_COUNT: Final = 69
_HIDDEN: Final = 341
_OSD_POSITIONS: Final = (2433, 2401, 2369, 2337)

PERIPHERALS: Final = (
    BeeperConfig(BeeperFlag(0), 1, BeeperFlag(0)),
    VtxConfig(
        VtxType.SMARTAUDIO,
        5,
        1,
        1,
        False,
        5658,
        True,
        0,
        0,
        True,
        table_bands=5,
        table_channels=8,
        table_powers=4,
    ),
    OsdConfig(
        flags=1 | 1 << 4 | 1 << 5,
        video_system=VideoSystem.AUTO,
        units=OsdUnits.METRIC,
        rssi_alarm=20,
        capacity_alarm=2200,
        reserved=0,
        item_count=OSD_ITEM_COUNT,
        altitude_alarm=100,
        items=(*_OSD_POSITIONS, *[_HIDDEN] * (OSD_ITEM_COUNT - len(_OSD_POSITIONS))),
        statistics=(0,) * 29,
        timers=(2560, 2561, 0, 0),
        warnings_low=0xFFFF,
        warning_count=24,
        warnings=0xFFFFFF,
        profile_count=3,
        profile=1,
        stick_overlay_mode=2,
        camera_frame_width=24,
        camera_frame_height=11,
        link_quality_alarm=80,
        rssi_dbm_alarm=-60,
    ),
    OsdCanvas(30, 16),
    DataflashSummary(3, 256, 16 << 20, 0),
    SdCardSummary(0, SdCardState.NOT_PRESENT, 0, 0, 0),
    PidNames(("ROLL", "PITCH", "YAW", "LEVEL", "MAG")),
    PidController(1),
    Servo((1500,) * 8),
    ServoConfigurations((ServoSettings(1000, 2000, 1500, 100),) * 8),
    ServoMixRules(()),
    RxFailConfig((ChannelFailsafe(0, 1500),) * 18),
    AdjustmentRanges((AdjustmentRange(0, 0, 900, 900, 0, 0, 0, 0),) * 30),
    LedColors((HsvColor(0, 0, 0),) * 16),
    LedStripConfig((0,) * 32, True, 0),
    LedStripValues(100, 0, 120),
    SonarAltitude(-0.01),
    TxInfo(0, 255),
    Debug((0,) * 8),
    GpsSvInfo(()),
)
