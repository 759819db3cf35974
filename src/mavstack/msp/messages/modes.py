"""Modes ("boxes") of the flight controller: their names and numbers, and the switches that activate them."""

from __future__ import annotations

from mavstack.msp.commands import MspCommand
from mavstack.msp.messages.codecs import Number
from mavstack.msp.messages.fields import Record, i16, items_of, name_list, record, u8
from mavstack.msp.messages.layout import BETAFLIGHT_ONLY, TableMessage, reply, request

FIRST_PULSE, PULSE_STEP = 900, 25

BETAFLIGHT_MODES = {
    0: "ARM",
    1: "ANGLE",
    2: "HORIZON",
    3: "ALTHOLD",
    4: "ANTI GRAVITY",
    5: "MAG",
    6: "HEADFREE",
    7: "HEADADJ",
    8: "CAMSTAB",
    11: "POS HOLD",
    12: "PASSTHRU",
    13: "BEEPER",
    15: "LEDLOW",
    17: "CALIB",
    19: "OSD DISABLE",
    20: "TELEMETRY",
    23: "SERVO1",
    24: "SERVO2",
    25: "SERVO3",
    26: "BLACKBOX",
    27: "FAILSAFE",
    28: "AIR MODE",
    29: "3D DISABLE",
    30: "FPV ANGLE MIX",
    31: "BLACKBOX ERASE",
    32: "CAMERA CONTROL 1",
    33: "CAMERA CONTROL 2",
    34: "CAMERA CONTROL 3",
    35: "FLIP OVER AFTER CRASH",
    36: "PREARM",
    37: "GPS BEEP SATELLITE COUNT",
    39: "VTX PIT MODE",
    40: "USER1",
    41: "USER2",
    42: "USER3",
    43: "USER4",
    44: "PID AUDIO",
    45: "PARALYZE",
    46: "GPS RESCUE",
    47: "ACRO TRAINER",
    48: "VTX CONTROL DISABLE",
    49: "LAUNCH CONTROL",
    50: "MSP OVERRIDE",
    51: "STICK COMMANDS DISABLE",
    52: "BEEPER MUTE",
    53: "READY",
    54: "LAP TIMER RESET",
    55: "CHIRP",
    56: "AUTOPILOT",
    57: "WP CAPTURE",
}
"""Names of Betaflight's modes by their permanent numbers."""

INAV_MODES = {
    0: "ARM",
    1: "ANGLE",
    2: "HORIZON",
    3: "NAV ALTHOLD",
    5: "HEADING HOLD",
    6: "HEADFREE",
    7: "HEADADJ",
    8: "CAMSTAB",
    10: "NAV RTH",
    11: "NAV POSHOLD",
    12: "MANUAL",
    13: "BEEPER",
    15: "LEDS OFF",
    16: "LIGHTS",
    19: "OSD OFF",
    20: "TELEMETRY",
    21: "AUTO TUNE",
    26: "BLACKBOX",
    27: "FAILSAFE",
    28: "NAV WP",
    29: "AIR MODE",
    30: "HOME RESET",
    31: "GCS NAV",
    32: "FPV ANGLE MIX",
    33: "SURFACE",
    34: "FLAPERON",
    35: "TURN ASSIST",
    36: "NAV LAUNCH",
    37: "SERVO AUTOTRIM",
    39: "CAMERA CONTROL 1",
    40: "CAMERA CONTROL 2",
    41: "CAMERA CONTROL 3",
    42: "OSD ALT 1",
    43: "OSD ALT 2",
    44: "OSD ALT 3",
    45: "NAV COURSE HOLD",
    46: "MC BRAKING",
    47: "USER1",
    48: "USER2",
    49: "LOITER CHANGE",
    50: "MSP RC OVERRIDE",
    51: "PREARM",
    52: "TURTLE",
    53: "NAV CRUISE",
    54: "AUTO LEVEL TRIM",
    55: "WP PLANNER",
    56: "SOARING",
    57: "USER3",
    58: "USER4",
    59: "MISSION CHANGE",
    60: "BEEPER MUTE",
    61: "MULTI FUNCTION",
    62: "MIXER PROFILE 2",
    63: "MIXER TRANSITION",
    64: "ANGLE HOLD",
    65: "GIMBAL LEVEL TILT",
    66: "GIMBAL LEVEL ROLL",
    67: "GIMBAL CENTER",
    68: "GIMBAL HEADTRACKER",
    69: "INVERTED",
    70: "KNIFE EDGE LEFT",
    71: "KNIFE EDGE RIGHT",
    72: "PROP HANG",
}
"""Names of iNav's modes by their permanent numbers."""


@reply(MspCommand.MSP_BOXNAMES)
class BoxNames(TableMessage):
    """Names of the modes that the flight controller has at present, 32 for each page."""

    names: tuple[str, ...] = name_list()


@reply(MspCommand.MSP_BOXIDS)
class BoxIds(TableMessage):
    """Permanent numbers of the modes that the flight controller has at present, 32 for each page.

    A mode's position in this list is its bit in `Status.active_modes`.
    """

    ids: tuple[int, ...] = items_of(Number("u8"))


@request(MspCommand.MSP_BOXNAMES, BETAFLIGHT_ONLY)
class GetBoxNames(TableMessage):
    """Ask for a page of MSP_BOXNAMES."""

    page: int | None = u8(default=None)


@request(MspCommand.MSP_BOXIDS, BETAFLIGHT_ONLY)
class GetBoxIds(TableMessage):
    """Ask for a page of MSP_BOXIDS."""

    page: int | None = u8(default=None)


@record
class ModeRange(Record):
    """Pulse widths of an AUX channel that activate a mode; with `start` equal to `end` none does."""

    mode: int = u8()
    aux_channel: int = u8()
    start: int = u8(unit="us", step=PULSE_STEP, offset=FIRST_PULSE)
    end: int = u8(unit="us", step=PULSE_STEP, offset=FIRST_PULSE)

    @property
    def is_used(self) -> bool:
        """True if the range can activate a mode."""
        return self.start < self.end


@reply(MspCommand.MSP_MODE_RANGES)
class ModeRanges(TableMessage):
    """Switches that activate modes; an unused place has a range without width."""

    ranges: tuple[ModeRange, ...] = items_of(ModeRange)


@record
class ModeRangeExtra(Record):
    """How a range is combined with others of its mode: logic 0 or, 1 and; a mode that it is linked to."""

    mode: int = u8()
    logic: int = u8()
    linked_to: int = u8()


@reply(MspCommand.MSP_MODE_RANGES_EXTRA, BETAFLIGHT_ONLY, since="1.41")
class ModeRangesExtra(TableMessage):
    """How the ranges of MSP_MODE_RANGES are combined, in their order."""

    ranges: tuple[ModeRangeExtra, ...] = items_of(ModeRangeExtra, counted=True)


@request(MspCommand.MSP_SET_MODE_RANGE)
class SetModeRange(TableMessage):
    """Set one of the switches that activate modes."""

    index: int = u8()
    mode: int = u8()
    aux_channel: int = u8()
    start: int = u8(unit="us", step=PULSE_STEP, offset=FIRST_PULSE)
    end: int = u8(unit="us", step=PULSE_STEP, offset=FIRST_PULSE)
    logic: int | None = u8(since="1.41", variant="BTFL", default=None)
    linked_to: int | None = u8(since="1.41", variant="BTFL", default=None)


@record
class AdjustmentRange(Record):
    """Pulse widths of an AUX channel within which another channel adjusts a setting."""

    slot: int = u8()
    aux_channel: int = u8()
    start: int = u8(unit="us", step=PULSE_STEP, offset=FIRST_PULSE)
    end: int = u8(unit="us", step=PULSE_STEP, offset=FIRST_PULSE)
    function: int = u8()
    aux_switch_channel: int = u8()
    center: int | None = i16(since="1.45", variant="BTFL", default=None)
    scale: int | None = i16(since="1.45", variant="BTFL", default=None)


@reply(MspCommand.MSP_ADJUSTMENT_RANGES)
class AdjustmentRanges(TableMessage):
    """Channels that adjust settings in flight."""

    ranges: tuple[AdjustmentRange, ...] = items_of(AdjustmentRange)


@request(MspCommand.MSP_SET_ADJUSTMENT_RANGE)
class SetAdjustmentRange(TableMessage):
    """Set one of the channels that adjust settings in flight."""

    index: int = u8()
    slot: int = u8()
    aux_channel: int = u8()
    start: int = u8(unit="us", step=PULSE_STEP, offset=FIRST_PULSE)
    end: int = u8(unit="us", step=PULSE_STEP, offset=FIRST_PULSE)
    function: int = u8()
    aux_switch_channel: int = u8()
    center: int | None = i16(since="1.45", variant="BTFL", default=None)
    scale: int | None = i16(since="1.45", variant="BTFL", default=None)
