"""Flashing a SiK radio over its serial port: its parameters are saved before and restored after."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING, Final

from mavstack.errors import MavstackError, RadioError
from mavstack.flashing import sik_client
from mavstack.flashing.bootloader_port import BOOTLOADER_BAUD, BootloaderPort, port_url
from mavstack.flashing.failures import BootloaderError, FlashingError
from mavstack.flashing.progress import Phase
from mavstack.flashing.result import FlashResult
from mavstack.radio.modem import SikModem
from mavstack.radio.session import AtCommand, Reply
from mavstack.radio.sik_radio import SikRadio

if TYPE_CHECKING:
    from mavstack.flashing.firmware_file import FirmwareFile
    from mavstack.flashing.options import FlashOptions
    from mavstack.flashing.sik_client import RadioBoard

#: The default baud rate of a radio's serial port.
RADIO_BAUD: Final = 57_600
#: Seconds in which a radio starts its bootloader, and in which it starts its firmware.
_BOOTLOADER_TIME, _FIRMWARE_TIME = 0.7, 2.0
_FORMAT: Final = "FORMAT"


class RadioFlasher:
    """Flashes one radio.

    Args:
        port: A serial device, or a URL.
        options: The options.
    """

    def __init__(self, port: str, options: FlashOptions) -> None:
        self._port, self._options, self._report = port, options, options.report
        self._values: dict[int, int] = {}

    async def flash(self, firmware: FirmwareFile) -> FlashResult:
        """Check everything, then write the firmware.

        Raises:
            FlashingRefused: The firmware is for another radio; nothing was erased.
            FlashingError: Flashing failed.
            LinkError: The port cannot be opened.
        """
        sik_client.board_of_file(firmware, self._options.radio_board)
        self._report(Phase.CONNECT, 0, 0)
        was_running = not await self._is_in_bootloader()
        if was_running:
            await self._start_bootloader()
        try:
            return await self._write(firmware, was_running=was_running)
        except BootloaderError as error:
            raise FlashingError(f"flashing the radio at {self._port} failed: {error}") from error

    async def _is_in_bootloader(self) -> bool:
        async with BootloaderPort(port_url(self._port, BOOTLOADER_BAUD)) as opened:
            with suppress(BootloaderError):
                await opened.run(sik_client.identify(1))
                return True
        return False

    async def _start_bootloader(self) -> None:
        """Save the parameters, and restart into the bootloader, which a dry run leaves again."""
        self._report(Phase.BACKUP, 0, 0)
        try:
            async with SikModem(port_url(self._port, RADIO_BAUD)) as modem:
                await modem.enter()
                known = await SikRadio(modem).get_parameters()
                self._values = {each.number: each.value for name, each in known.items() if name != _FORMAT}
                self._report(Phase.BOOTLOADER, 0, 0)
                await modem.run(AtCommand("AT&UPDATE", Reply.NONE, attempts=1))
                modem.assume_restarted()
        except RadioError as error:
            raise FlashingError(f"flashing the radio at {self._port} failed: {error}") from error
        await asyncio.sleep(_BOOTLOADER_TIME)

    async def _write(self, firmware: FirmwareFile, *, was_running: bool) -> FlashResult:
        dry_run = self._options.dry_run
        async with BootloaderPort(port_url(self._port, BOOTLOADER_BAUD)) as opened:
            board: RadioBoard = await opened.run(sik_client.identify())
            self._report(Phase.CHECK, 0, 0)
            try:
                sik_client.check_radio(firmware, board, self._options.radio_board)
                if not dry_run:
                    await opened.run(sik_client.flash(firmware, self._report))
                    was_running = True
            finally:
                if was_running:  # restart the firmware, which is intact after a refusal
                    self._report(Phase.REBOOT, 0, 0)
                    opened.write(sik_client.reboot())
                    await asyncio.sleep(_FIRMWARE_TIME)
        if dry_run:
            return FlashResult(board.name)
        notes = await self._restore()
        self._report(Phase.DONE, 1, 1)
        return FlashResult(board.name, firmware.size, notes=notes)

    async def _restore(self) -> tuple[str, ...]:
        if not (self._options.keep_parameters and self._values):
            return ()
        self._report(Phase.RESTORE, 0, 0)
        try:
            async with SikModem(port_url(self._port, RADIO_BAUD)) as modem:
                await modem.enter()
                count = await self._set_all(SikRadio(modem))
        except MavstackError as error:
            values = ", ".join(f"S{number}={value}" for number, value in self._values.items())
            return (f"The parameters could not be restored: {error}; they were {values}.",)
        return (f"{count} parameters of the radio restored.",)

    async def _set_all(self, radio: SikRadio) -> int:
        """Set the parameters that differ, store them and restart; return their number."""
        held = {each.number: each.value for each in (await radio.get_parameters()).values()}
        changed = {n: value for n, value in self._values.items() if n in held and held[n] != value}
        for number, value in changed.items():
            await radio.set_value(number, value)
        if changed:
            await radio.store()
            await radio.restart()
        return len(changed)
