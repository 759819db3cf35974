"""LED strip: functions of the LEDs, the colors, and the colors of the modes."""

from __future__ import annotations

from mavstack.msp.commands import MspCommand
from mavstack.msp.messages.codecs import Number
from mavstack.msp.messages.fields import Record, items_of, record, u8, u16, u32
from mavstack.msp.messages.layout import BETAFLIGHT_ONLY, TableMessage, reply, request


@record
class HsvColor(Record):
    """A color by hue, saturation (255 is white) and value."""

    hue: int = u16(unit="deg")
    saturation: int = u8()
    value: int = u8()


@reply(MspCommand.MSP_LED_COLORS)
class LedColors(TableMessage):
    """The sixteen colors."""

    colors: tuple[HsvColor, ...] = items_of(HsvColor)


@request(MspCommand.MSP_SET_LED_COLORS)
class SetLedColors(LedColors):
    """Set the sixteen colors."""


@reply(MspCommand.MSP_LED_STRIP_CONFIG)
class LedStripConfig(TableMessage):
    """Functions of the LEDs, as bits: position, function, overlays, color, direction and parameters."""

    leds: tuple[int, ...] = items_of(Number("u32"), leave=3)
    has_status_mode: bool | None = u8(kind=bool, since="1.41", variant="BTFL", default=None)
    profile: int | None = u8(since="1.41", variant="BTFL", default=None)


@request(MspCommand.MSP_SET_LED_STRIP_CONFIG)
class SetLedStripConfig(TableMessage):
    """Set the function of one LED."""

    index: int = u8()
    led: int = u32()


@record
class ModeColor(Record):
    """Color of a mode in a direction, or of a special occasion."""

    mode: int = u8()
    direction: int = u8()
    color: int = u8()


@reply(MspCommand.MSP_LED_STRIP_MODECOLOR)
class LedStripModeColors(TableMessage):
    """Colors of the modes."""

    colors: tuple[ModeColor, ...] = items_of(ModeColor)


@request(MspCommand.MSP_SET_LED_STRIP_MODECOLOR)
class SetLedStripModeColor(TableMessage):
    """Set one of the colors of the modes."""

    mode: int = u8()
    direction: int = u8()
    color: int = u8()


@reply(MspCommand.MSP2_GET_LED_STRIP_CONFIG_VALUES, BETAFLIGHT_ONLY, since="1.46")
class LedStripValues(TableMessage):
    """Brightness of the strip, and the steps and speed of its rainbow."""

    brightness: int = u8(unit="%")
    rainbow_delta: int = u16()
    rainbow_frequency: int = u16(unit="Hz")


@request(MspCommand.MSP2_SET_LED_STRIP_CONFIG_VALUES, BETAFLIGHT_ONLY, since="1.46")
class SetLedStripValues(LedStripValues):
    """Set the brightness of the strip, and the steps and speed of its rainbow."""
