"""Actions: save, restart, factory settings, arming lock, pass-through."""

from __future__ import annotations

from enum import IntEnum

from mavstack.msp.commands import MspCommand
from mavstack.msp.messages.fields import u8
from mavstack.msp.messages.layout import BETAFLIGHT_ONLY, TableMessage, reply, request


@request(MspCommand.MSP_EEPROM_WRITE)
class EepromWrite(TableMessage):
    """Save all settings, so that they are there after a restart; a vehicle that is armed refuses."""


class RebootMode(IntEnum):
    """The program that starts."""

    FIRMWARE = 0
    BOOTLOADER_ROM = 1
    MASS_STORAGE = 2
    MASS_STORAGE_UTC = 3
    BOOTLOADER_FLASH = 4


@request(MspCommand.MSP_REBOOT)
class Reboot(TableMessage):
    """Restart the flight controller."""

    mode: RebootMode | None = u8(kind=RebootMode, variant="BTFL", default=None)


@reply(MspCommand.MSP_REBOOT, BETAFLIGHT_ONLY, since="1.41")
class RebootReply(TableMessage):
    """The program that starts; `is_ready` tells for mass storage whether there is one."""

    mode: RebootMode = u8(kind=RebootMode)
    is_ready: bool | None = u8(kind=bool, default=None)


@request(MspCommand.MSP_RESET_CONF)
class ResetConf(TableMessage):
    """Set everything to the values of the factory, save and restart."""


@reply(MspCommand.MSP_RESET_CONF, BETAFLIGHT_ONLY, since="1.42")
class ResetConfReply(TableMessage):
    """True if everything was set to the values of the factory."""

    is_done: bool = u8(kind=bool)


@request(MspCommand.MSP_SET_ARMING_DISABLED, BETAFLIGHT_ONLY)
class SetArmingDisabled(TableMessage):
    """Forbid or permit arming; an armed vehicle disarms."""

    is_disabled: bool = u8(kind=bool)
    disable_runaway_takeoff: bool | None = u8(kind=bool, default=None)


class PassthroughMode(IntEnum):
    """The device to which the connection is passed through."""

    ESC_SIMONK = 0
    ESC_BLHELI = 1
    ESC_KISS = 2
    ESC_KISSALL = 3
    ESC_CASTLE = 4
    SERIAL_ID = 0xFD
    ESC_4WAY = 0xFF


@request(MspCommand.MSP_SET_PASSTHROUGH)
class SetPassthrough(TableMessage):
    """Connect the port to an ESC or to another serial port, until the flight controller restarts."""

    mode: PassthroughMode | None = u8(kind=PassthroughMode, default=None)
    argument: int | None = u8(default=None)


@reply(MspCommand.MSP_SET_PASSTHROUGH)
class PassthroughReply(TableMessage):
    """How many devices were found; 0 means that nothing is passed through."""

    count: int = u8()
