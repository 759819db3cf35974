"""Blackbox, and the flash chip and SD card that hold its logs."""

from __future__ import annotations

from enum import IntEnum

from mavstack.msp.commands import MspCommand
from mavstack.msp.messages.fields import raw, u8, u16, u32
from mavstack.msp.messages.layout import BETAFLIGHT_ONLY, INAV_ONLY, TableMessage, reply, request


class BlackboxDevice(IntEnum):
    """Where the logs go."""

    NONE = 0
    FLASH = 1
    SDCARD = 2
    SERIAL = 3
    VIRTUAL = 4


@reply(MspCommand.MSP_BLACKBOX_CONFIG, BETAFLIGHT_ONLY)
class BlackboxConfig(TableMessage):
    """Where and how often the blackbox writes; every 2 to the power of `sample_rate` control loops."""

    is_supported: bool = u8(kind=bool)
    device: BlackboxDevice = u8(kind=BlackboxDevice)
    rate_numerator: int = u8()
    rate_denominator: int = u8()
    p_ratio: int | None = u16(default=None)
    sample_rate: int | None = u8(since="1.44", default=None)
    disabled_fields: int | None = u32(since="1.45", default=None)


@request(MspCommand.MSP_SET_BLACKBOX_CONFIG, BETAFLIGHT_ONLY)
class SetBlackboxConfig(TableMessage):
    """Set where and how often the blackbox writes."""

    device: BlackboxDevice = u8(kind=BlackboxDevice)
    rate_numerator: int = u8()
    rate_denominator: int = u8()
    p_ratio: int | None = u16(default=None)
    sample_rate: int | None = u8(since="1.44", default=None)
    disabled_fields: int | None = u32(since="1.45", default=None)


@reply(MspCommand.MSP2_BLACKBOX_CONFIG, INAV_ONLY)
class InavBlackboxConfig(TableMessage):
    """Where iNav's blackbox writes, and which share of the control loops."""

    is_supported: bool = u8(kind=bool)
    device: BlackboxDevice = u8(kind=BlackboxDevice)
    rate_numerator: int = u16()
    rate_denominator: int = u16()
    included_fields: int | None = u32(default=None)


@request(MspCommand.MSP2_SET_BLACKBOX_CONFIG, INAV_ONLY)
class SetInavBlackboxConfig(TableMessage):
    """Set where iNav's blackbox writes, and which share of the control loops."""

    device: BlackboxDevice = u8(kind=BlackboxDevice)
    rate_numerator: int = u16()
    rate_denominator: int = u16()
    included_fields: int | None = u32(default=None)


@reply(MspCommand.MSP_DATAFLASH_SUMMARY)
class DataflashSummary(TableMessage):
    """Flash chip for logs; bit 0 of `flags` means ready, bit 1 that there is one."""

    flags: int = u8()
    sectors: int = u32()
    total_size: int = u32(unit="B")
    used_size: int = u32(unit="B")

    @property
    def is_ready(self) -> bool:
        """True if the chip can be read."""
        return bool(self.flags & 1)

    @property
    def is_supported(self) -> bool:
        """True if there is a chip."""
        return bool(self.flags & 2)


@request(MspCommand.MSP_DATAFLASH_READ)
class ReadDataflash(TableMessage):
    """Ask for bytes of the flash chip."""

    address: int = u32()
    size: int | None = u16(unit="B", default=None)
    allow_compression: bool | None = u8(kind=bool, variant="BTFL", default=None)


@reply(MspCommand.MSP_DATAFLASH_READ)
class DataflashRead(TableMessage):
    """Bytes of the flash chip, by a request with a size; `compression` is 0 for none and 1 for Huffman."""

    address: int = u32()
    size: int = u16(unit="B", variant="BTFL", default=0)
    compression: int = u8(variant="BTFL", default=0)
    data: bytes = raw(default=b"")


@request(MspCommand.MSP_DATAFLASH_ERASE)
class EraseDataflash(TableMessage):
    """Delete all logs on the flash chip; this takes up to a minute."""


class SdCardState(IntEnum):
    """State of the SD card."""

    NOT_PRESENT = 0
    FATAL = 1
    CARD_INIT = 2
    FS_INIT = 3
    READY = 4


@reply(MspCommand.MSP_SDCARD_SUMMARY)
class SdCardSummary(TableMessage):
    """SD card for logs; bit 0 of `flags` means that there is a slot."""

    flags: int = u8()
    state: SdCardState = u8(kind=SdCardState)
    last_error: int = u8()
    free_size: int = u32(unit="KiB")
    total_size: int = u32(unit="KiB")

    @property
    def is_supported(self) -> bool:
        """True if there is a slot for a card."""
        return bool(self.flags & 1)
