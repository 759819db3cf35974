"""Flashing a board with the bootloader of PX4 or ArduPilot, over a serial port."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from mavstack.errors import LinkError, MavstackError, MissingExtraError
from mavstack.flashing.autopilot_board import leave_for_bootloader, restore_parameters
from mavstack.flashing.backup import ParameterBackup
from mavstack.flashing.board import Board, check_firmware
from mavstack.flashing.bootloader_client import flash, identify, reboot
from mavstack.flashing.bootloader_port import BOOTLOADER_BAUD, BootloaderPort, port_url
from mavstack.flashing.failures import BootloaderError, FlashingError
from mavstack.flashing.ports import list_ports
from mavstack.flashing.progress import Phase
from mavstack.flashing.result import FlashResult

if TYPE_CHECKING:
    from mavstack.flashing.firmware_file import FirmwareFile
    from mavstack.flashing.options import FlashOptions

#: Number of attempts to find a bootloader if it may not be running.
QUICK_ATTEMPTS: Final = 2
#: Seconds in which a bootloader appears after the command that starts it, and seconds between two checks.
BOOTLOADER_TIMEOUT, LOOK_INTERVAL = 20.0, 0.3
#: Maximum number of attempts to write a firmware, if the port is lost during the write.
WRITE_ATTEMPTS: Final = 3
#: Seconds that a board needs to leave its bootloader.
BOOT_TIME: Final = 1.0
#: The line that starts the bootloader from PX4's console.
_CONSOLE_LINE: Final = b"\r\r\rreboot -b\n"


class BoardFlasher:
    """Flashes one board.

    Args:
        port: A serial device, or a URL.
        options: The options.
    """

    def __init__(self, port: str, options: FlashOptions) -> None:
        self._port, self._options, self._report = port, options, options.report
        self._backup = ParameterBackup(port, options.backup_folder) if options.keep_parameters else None
        self._known_devices: frozenset[str] = frozenset()

    async def identify(self) -> Board | None:
        """Return the board if its bootloader is running, else None.

        Raises:
            LinkError: The port cannot be opened.
        """
        return await self._identify(self._port, QUICK_ATTEMPTS)

    async def flash(self, firmware: FirmwareFile) -> FlashResult:
        """Check everything, then write the firmware.

        Raises:
            FlashingRefused: The firmware does not fit; nothing was erased.
            FlashingError: Flashing failed.
            LinkError: The port cannot be opened.
        """
        self._report(Phase.CONNECT, 0, 0)
        board = await self.identify()
        if board is not None:
            check_firmware(firmware, board)
            if self._options.dry_run:
                return FlashResult(board.name)
        else:
            vehicle = await self._leave_firmware(firmware)
            if self._options.dry_run:
                note = "The bootloader checks the size of the flash, which a running autopilot does not tell."
                return FlashResult(vehicle or "the board", notes=(note,))
        return await self._write_until_done(firmware)

    async def _leave_firmware(self, firmware: FirmwareFile) -> str | None:
        """Save the running autopilot, and let it start its bootloader."""
        self._report(Phase.BACKUP, 0, 0)
        self._known_devices = _devices()
        dry_run = self._options.dry_run
        vehicle = await leave_for_bootloader(self._port, firmware, self._backup, dry_run=dry_run)
        if vehicle is None and dry_run:
            raise FlashingError(f"{self._port}: neither a bootloader nor an autopilot answers")
        if vehicle is None:
            await self._write_console_line()
        self._report(Phase.BOOTLOADER, 0, 0)
        return vehicle

    async def _write_console_line(self) -> None:
        async with BootloaderPort(port_url(self._port)) as port:
            port.write(_CONSOLE_LINE)
            await asyncio.sleep(LOOK_INTERVAL)

    async def _write_until_done(self, firmware: FirmwareFile) -> FlashResult:
        attempt = 0
        while True:
            attempt += 1
            port = await self._wait_for_bootloader()
            try:
                board = await self._write(port, firmware)
            except (BootloaderError, LinkError) as error:
                if attempt >= WRITE_ATTEMPTS or not _is_lost(error):
                    raise FlashingError(f"flashing {self._port} failed: {error}") from error
            else:
                break
        result = FlashResult(board.name, firmware.size, attempt)
        return await self._finish(result)

    async def _write(self, port: str, firmware: FirmwareFile) -> Board:
        async with BootloaderPort(port_url(port, BOOTLOADER_BAUD)) as opened:
            board = await opened.run(identify())
            self._report(Phase.CHECK, 0, 0)
            check_firmware(firmware, board)
            await opened.run(flash(firmware, board, self._report))
            self._report(Phase.REBOOT, 0, 0)
            with suppress(LinkError):  # the port disappears when the bootloader ends
                await opened.run(reboot())
        return board

    async def _finish(self, result: FlashResult) -> FlashResult:
        backup = self._backup
        if backup is not None and backup.is_pending:
            self._report(Phase.RESTORE, 0, 0)
            await asyncio.sleep(BOOT_TIME)
            result = replace(result, restored=await restore_parameters(self._port, backup))
        self._report(Phase.DONE, 1, 1)
        return result

    async def _wait_for_bootloader(self) -> str:
        """Return the port of the bootloader, which may have another name than that of the firmware."""
        loop = asyncio.get_running_loop()
        deadline = loop.time() + BOOTLOADER_TIMEOUT
        while True:
            for port in (self._port, *sorted(_devices() - self._known_devices)):
                if await self._is_bootloader(port):
                    return port
            if loop.time() >= deadline:
                raise FlashingError(
                    f"flashing {self._port} failed: no bootloader answers; unplug the board, plug it in "
                    "again, and repeat the command within five seconds"
                )
            await asyncio.sleep(LOOK_INTERVAL)

    async def _is_bootloader(self, port: str) -> bool:
        try:
            return await self._identify(port, QUICK_ATTEMPTS) is not None
        except MissingExtraError:
            raise
        except MavstackError:  # the port has not appeared yet
            return False

    async def _identify(self, port: str, attempts: int) -> Board | None:
        async with BootloaderPort(port_url(port, BOOTLOADER_BAUD)) as opened:
            try:
                return await opened.run(identify(attempts))
            except BootloaderError:
                return None


def _is_lost(error: MavstackError) -> bool:
    """Return whether a board fell silent, as one without power does; a refusal is final."""
    return isinstance(error, LinkError) or (isinstance(error, BootloaderError) and error.status is None)


def _devices() -> frozenset[str]:
    try:
        return frozenset(port.device for port in list_ports() if port.usb)
    except MissingExtraError:
        return frozenset()
