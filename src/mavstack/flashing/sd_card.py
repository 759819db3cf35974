"""Flashing an ArduPilot board by its SD card: the file is sent by MAVLink FTP, and the bootloader finds it.

It works over any link. The bootloader renames the file by its outcome.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import FileDenied, RemoteError
from mavstack.flashing.bootloader_port import port_url
from mavstack.flashing.failures import FlashingError, FlashingRefused
from mavstack.flashing.progress import Phase
from mavstack.flashing.result import FlashResult
from mavstack.vehicle import connect

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.flashing.firmware_file import FirmwareFile
    from mavstack.flashing.options import FlashOptions
    from mavstack.vehicle import Vehicle

FILE: Final = "/ardupilot.abin"
FLASHED: Final = "/ardupilot-flashed.abin"
#: The names that files get when they could not be flashed, with the reasons.
FAILED: Final[Mapping[str, str]] = MappingProxyType(
    {
        "/ardupilot-failed.abin": "the bootloader could not write it",
        "/ardupilot-verify.abin": "the bootloader found no valid image in it",
        "/ardupilot-verify-failed.abin": "the bootloader found a wrong MD5 sum",
    }
)
#: Seconds in which a board flashes its firmware from the SD card and starts it.
FLASH_TIMEOUT: Final = 120.0
_HEARTBEAT_TIMEOUT: Final = 10.0


async def flash_by_sd_card(firmware: FirmwareFile, port: str, options: FlashOptions) -> FlashResult:
    """Send an .abin file to an ArduPilot vehicle, restart it, and look at the outcome.

    Raises:
        FlashingRefused: It is not ArduPilot, is armed, or has no file transfer; nothing was sent.
        FlashingError: The bootloader did not flash it.
        RemoteError: The vehicle does not answer.
        LinkError: The link cannot be opened.
    """
    options.report(Phase.CONNECT, 0, 0)
    async with connect(port_url(port)) as connection:
        vehicle = await connection.wait_for_vehicle(timeout=_HEARTBEAT_TIMEOUT)
        name = f"vehicle {vehicle.system}"
        await _check(vehicle, name)
        if options.dry_run:
            note = "The bootloader checks the sum; boards without SD card or H7 chip do not look."
            return FlashResult(name, notes=(note,))
        await _remove_old(vehicle)
        await vehicle.ftp.upload(
            FILE, firmware.image, progress=lambda done, total: options.report(Phase.PROGRAM, done, total)
        )
        options.report(Phase.REBOOT, 0, 0)
        await vehicle.reboot(timeout=FLASH_TIMEOUT)
        options.report(Phase.VERIFY, 0, 0)
        await _check_outcome(vehicle, name)
    options.report(Phase.DONE, 1, 1)
    return FlashResult(name, firmware.size, notes=("The parameters stay on the board.",))


async def _check(vehicle: Vehicle, name: str) -> None:
    if vehicle.autopilot != common.MavAutopilot.ARDUPILOTMEGA:
        raise FlashingRefused(
            f"flashing {name} failed: only ArduPilot takes .abin files, it is {vehicle.firmware.NAME}"
        )
    if vehicle.armed:
        raise FlashingRefused(f"flashing {name} failed: it is armed; disarm it first")
    version = await vehicle.get_version()
    if not version.can(common.MavProtocolCapability.FTP):
        raise FlashingRefused(f"flashing {name} failed: it has no file transfer (MAVLink FTP)")


async def _remove_old(vehicle: Vehicle) -> None:
    """Remove the files of an earlier flashing, whose names would be taken for the new outcome."""
    for path in (FILE, FLASHED, *FAILED):
        try:
            await vehicle.ftp.remove(path)
        except FileDenied:
            continue


async def _check_outcome(vehicle: Vehicle, name: str) -> None:
    try:
        names = {f"/{each.name}" for each in await vehicle.ftp.list("/")}
    except RemoteError as error:
        raise FlashingError(
            f"flashing {name} failed: its files cannot be listed after the restart: {error}"
        ) from error
    reasons = [reason for path, reason in FAILED.items() if path in names]
    if reasons:
        raise FlashingError(f"flashing {name} failed: {reasons[0]}")
    if FLASHED not in names:
        raise FlashingError(
            f"flashing {name} failed: its bootloader did not look at the SD card; flash the .apj file by USB"
        )
