"""Flashing by programs of others: dfu-util for the ROM of STM32 chips, esptool for ESP32."""

from __future__ import annotations

import asyncio
import re
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from shutil import which
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Final

from mavstack.bridges.msp import FlightController
from mavstack.errors import LinkError, MspError, RemoteCancelled
from mavstack.flashing.backup import dump_path
from mavstack.flashing.bootloader_port import port_url
from mavstack.flashing.failures import FlashingError, FlashingRefused
from mavstack.flashing.intel_hex import flat_image
from mavstack.flashing.progress import Phase
from mavstack.flashing.result import FlashResult
from mavstack.msp.messages.actions import Reboot, RebootMode

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.flashing.firmware_file import FirmwareFile
    from mavstack.flashing.options import FlashOptions

#: The value of `--port` for a chip that runs its ROM bootloader already.
IN_ROM: Final = "dfu"
_ROM_ID: Final = "0483:df11"
#: Seconds in which the ROM bootloader appears on USB, and seconds between two checks.
ROM_TIMEOUT, _LOOK_INTERVAL = 15.0, 0.5
_FLASH_START: Final = 0x0800_0000
_SIZES: Final = {"B": 1, "K": 1024, "M": 1024 * 1024, " ": 1}
_SECTORS: Final = re.compile(r"(\d+)\*(\d+)([ BKM])")
_PERCENT: Final = re.compile(rb"(\d+)\s?%")


@dataclass(frozen=True, slots=True)
class RomFlash:
    """The internal flash of a chip in its ROM: its first address and its bytes."""

    start: int
    size: int


def parse_dfu_list(text: str) -> list[RomFlash]:
    """Return the internal flashes that `dfu-util --list` prints."""
    found = []
    for line in text.splitlines():
        place = re.search(r'name="@Internal Flash\s*/0x([0-9A-Fa-f]+)/([^"]+)"', line)
        if place and _ROM_ID in line:
            sectors = _SECTORS.findall(place[2])
            size = sum(int(count) * int(each) * _SIZES[unit] for count, each, unit in sectors)
            found.append(RomFlash(int(place[1], 16), size))
    return list(dict.fromkeys(found))


async def flash_stm32(firmware: FirmwareFile, port: str, options: FlashOptions) -> FlashResult:
    """Start the ROM of a Betaflight or iNav board, and write an Intel HEX file by dfu-util.

    Raises:
        FlashingRefused: The file does not fit, the controller is armed, or dfu-util is not installed.
        FlashingError: Flashing failed.
        LinkError: The port cannot be opened.
    """
    tool = require_tool("dfu-util")
    start, image = flat_image(firmware.segments)
    if start != _FLASH_START:
        raise FlashingRefused(
            f"flashing {port} failed: the file begins at {start:#x}, not at {_FLASH_START:#x}"
        )
    notes: tuple[str, ...] = ()
    if port != IN_ROM:
        notes = await _start_rom(port, options)
        if options.dry_run:
            return FlashResult(port, notes=notes)
    options.report(Phase.BOOTLOADER, 0, 0)
    flash = await _wait_for_rom(tool)
    if len(image) > flash.size:
        raise FlashingRefused(
            f"flashing {port} failed: the firmware has {len(image)} bytes, the chip {flash.size}"
        )
    if options.dry_run:
        return FlashResult(f"STM32 with {flash.size} bytes of flash")
    with TemporaryDirectory() as folder:
        path = Path(folder) / "firmware.bin"
        path.write_bytes(image)
        words = [tool, "-d", _ROM_ID, "-a", "0", "-s", f"{start:#x}:leave", "-D", str(path)]
        await run_tool(words, options)
    options.report(Phase.DONE, 1, 1)
    return FlashResult("STM32", len(image), notes=notes)


async def flash_esp32(firmware: FirmwareFile, port: str, options: FlashOptions) -> FlashResult:
    """Write a merged image of an ESP32 from address 0 by esptool.

    Raises:
        FlashingRefused: esptool is not installed.
        FlashingError: Flashing failed.
    """
    tool = require_tool("esptool", "esptool.py")
    verb = "image-info" if options.dry_run else "write-flash"
    if tool.endswith(".py"):
        verb = verb.replace("-", "_")
    with TemporaryDirectory() as folder:
        path = Path(folder) / "firmware.bin"
        path.write_bytes(firmware.image)
        words = [tool, verb, str(path)] if options.dry_run else [tool, "--port", port, verb, "0x0", str(path)]
        await run_tool(words, options)
    if options.dry_run:
        return FlashResult("ESP32")
    options.report(Phase.DONE, 1, 1)
    return FlashResult("ESP32", len(firmware.image))


def require_tool(*names: str) -> str:
    """Return the path of a program by one of its names.

    Raises:
        FlashingRefused: It is not installed.
    """
    for name in names:
        if path := which(name):
            return path
    raise FlashingRefused(f"flashing failed: {names[0]} is not installed; install it by your package manager")


async def run_tool(words: Sequence[str], options: FlashOptions) -> str:
    """Run a program to its end, with its percentages as progress.

    Returns:
        Its output.

    Raises:
        FlashingError: It fails; the text has the last line of its output.
    """
    program = await asyncio.create_subprocess_exec(
        *words, stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.STDOUT
    )
    output = bytearray()
    try:
        while program.stdout is not None and (data := await program.stdout.read(4096)):
            output += data
            if percentages := _PERCENT.findall(data):
                options.report(Phase.PROGRAM, min(int(percentages[-1]), 100), 100)
        code = await program.wait()
    finally:
        if program.returncode is None:
            with suppress(ProcessLookupError):
                program.kill()
    text = output.decode("utf-8", "replace")
    if code != 0:
        last = next((line for line in reversed(text.splitlines()) if line.strip()), "no output")
        raise FlashingError(f"flashing failed: {Path(words[0]).name}: {last.strip()}")
    return text


async def _start_rom(port: str, options: FlashOptions) -> tuple[str, ...]:
    """Save the settings of a flight controller, and let it start its ROM."""
    options.report(Phase.BACKUP, 0, 0)
    try:
        async with FlightController(port_url(port)) as controller:
            name = f"{controller.info.firmware} {controller.info.version_text}"
            if options.dry_run:
                return (f"{name} answers; its ROM checks the size of the flash.",)
            notes = await _save_settings(controller, port, options) if options.keep_parameters else ()
            with suppress(RemoteCancelled, LinkError):
                await controller.send(Reboot(RebootMode.BOOTLOADER_ROM))
            return notes
    except MspError as error:
        raise FlashingError(
            f"flashing {port} failed: {error}; or hold its boot button, plug it in, and use --port {IN_ROM}"
        ) from error


async def _save_settings(controller: FlightController, port: str, options: FlashOptions) -> tuple[str, ...]:
    path = dump_path(port, options.backup_folder)
    async with controller.cli() as session:
        text = await session.dump("diff all")
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, "ascii", "replace")
    note = f"The settings are in {path}; firmware of this version takes them: mav msp restore {port} {path}."
    return (note,)


async def _wait_for_rom(tool: str) -> RomFlash:
    deadline = asyncio.get_running_loop().time() + ROM_TIMEOUT
    while True:
        program = await asyncio.create_subprocess_exec(
            tool, "--list", stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.DEVNULL
        )
        text = (await program.communicate())[0].decode("utf-8", "replace")
        found = parse_dfu_list(text)
        if len(found) > 1:
            raise FlashingRefused("flashing failed: several chips are in their ROM; unplug all but one")
        if found:
            return found[0]
        if asyncio.get_running_loop().time() >= deadline:
            raise FlashingError("flashing failed: no chip is in its ROM (DFU); the driver may be missing")
        await asyncio.sleep(_LOOK_INTERVAL)
