"""Video transmitter: band, channel, power, and the table of its channels and powers."""

from __future__ import annotations

from enum import IntEnum

from mavstack.msp.commands import MspCommand
from mavstack.msp.messages.codecs import Number
from mavstack.msp.messages.fields import items_of, prefixed_text, text, u8, u16
from mavstack.msp.messages.layout import BETAFLIGHT_ONLY, TableMessage, reply, request

BAND_NAME_LENGTH, POWER_LABEL_LENGTH = 8, 3


class VtxType(IntEnum):
    """Kind of the video transmitter."""

    UNSUPPORTED = 0
    RTC6705 = 1
    SMARTAUDIO = 3
    TRAMP = 4
    MSP = 5
    UNKNOWN = 255


@reply(MspCommand.MSP_VTX_CONFIG)
class VtxConfig(TableMessage):
    """Settings of the video transmitter; band, channel and power count from 1, band 0 means `frequency`."""

    vtx_type: VtxType = u8(kind=VtxType)
    band: int | None = u8(default=None)
    channel: int | None = u8(default=None)
    power: int | None = u8(default=None)
    pit_mode: bool | None = u8(kind=bool, default=None)
    frequency: int | None = u16(unit="MHz", variant="BTFL", default=None)
    is_ready: bool | None = u8(kind=bool, default=None)
    low_power_disarm: int | None = u8(default=None)
    pit_mode_frequency: int | None = u16(unit="MHz", since="1.42", variant="BTFL", default=None)
    has_table: bool | None = u8(kind=bool, since="1.42", variant="BTFL", default=None)
    table_bands: int | None = u8(since="1.42", variant="BTFL", default=None)
    table_channels: int | None = u8(since="1.42", variant="BTFL", default=None)
    table_powers: int | None = u8(since="1.42", variant="BTFL", default=None)


@request(MspCommand.MSP_SET_VTX_CONFIG)
class SetVtxConfig(TableMessage):
    """Set the video transmitter.

    `combined` is a frequency in MHz, or below 64 a band and channel, 8 * (band - 1) + channel - 1. Since API
    1.42 the fields `band`, `channel` and `frequency` take precedence.
    """

    combined: int = u16(default=0)
    power: int | None = u8(default=None)
    pit_mode: bool | None = u8(kind=bool, default=None)
    low_power_disarm: int | None = u8(default=None)
    pit_mode_frequency: int | None = u16(unit="MHz", since="1.42", variant="BTFL", default=None)
    band: int | None = u8(since="1.42", variant="BTFL", default=None)
    channel: int | None = u8(since="1.42", variant="BTFL", default=None)
    frequency: int | None = u16(unit="MHz", since="1.42", variant="BTFL", default=None)
    table_bands: int | None = u8(since="1.42", variant="BTFL", default=None)
    table_channels: int | None = u8(since="1.42", variant="BTFL", default=None)
    table_powers: int | None = u8(since="1.42", variant="BTFL", default=None)
    clear_table: bool | None = u8(kind=bool, since="1.42", variant="BTFL", default=None)


@request(MspCommand.MSP_VTXTABLE_BAND, BETAFLIGHT_ONLY, since="1.42")
class GetVtxTableBand(TableMessage):
    """Ask for a band of the table, from 1."""

    band: int = u8()


@reply(MspCommand.MSP_VTXTABLE_BAND, BETAFLIGHT_ONLY, since="1.42")
class VtxTableBand(TableMessage):
    """A band of the table; a frequency of 0 means that the channel is not used."""

    band: int = u8()
    name: str = prefixed_text(BAND_NAME_LENGTH)
    letter: str = text(1)
    is_factory: bool = u8(kind=bool)
    frequencies: tuple[int, ...] = items_of(Number("u16"), "MHz", counted=True)


@request(MspCommand.MSP_SET_VTXTABLE_BAND, BETAFLIGHT_ONLY, since="1.42")
class SetVtxTableBand(VtxTableBand):
    """Set a band of the table."""


@request(MspCommand.MSP_VTXTABLE_POWERLEVEL, BETAFLIGHT_ONLY, since="1.42")
class GetVtxTablePowerLevel(TableMessage):
    """Ask for a power level of the table, from 1."""

    level: int = u8()


@reply(MspCommand.MSP_VTXTABLE_POWERLEVEL, BETAFLIGHT_ONLY, since="1.42")
class VtxTablePowerLevel(TableMessage):
    """A power level of the table: the number for the transmitter, and the label for the pilot."""

    level: int = u8()
    value: int = u16()
    label: str = prefixed_text(POWER_LABEL_LENGTH)


@request(MspCommand.MSP_SET_VTXTABLE_POWERLEVEL, BETAFLIGHT_ONLY, since="1.42")
class SetVtxTablePowerLevel(VtxTablePowerLevel):
    """Set a power level of the table."""
