"""A running autopilot before and after it is flashed: its parameters, its bootloader, its return."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import LinkError, MavstackError, RemoteError, RemoteTimeout
from mavstack.flashing.board import check_board_id
from mavstack.flashing.bootloader_port import port_url
from mavstack.flashing.failures import FlashingError, FlashingRefused
from mavstack.vehicle import connect

if TYPE_CHECKING:
    from mavstack.flashing.backup import ParameterBackup, Restored
    from mavstack.flashing.firmware_file import FirmwareFile
    from mavstack.vehicle import Vehicle

#: Seconds to wait for the first heartbeat of a running autopilot, and of an autopilot that starts.
HEARTBEAT_TIMEOUT, START_TIMEOUT = 6.0, 45.0
#: Seconds to wait for the acknowledgement of the reboot command, which is lost if the port disappears first.
_COMMAND_TIMEOUT: Final = 3.0
#: Value of param 1 of MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN.
_STAY_IN_BOOTLOADER: Final = 3


async def leave_for_bootloader(
    port: str, firmware: FirmwareFile, backup: ParameterBackup | None, *, dry_run: bool
) -> str | None:
    """Check and save a running autopilot, and let it start its bootloader.

    Args:
        port: The port.
        firmware: The firmware, whose board is compared with that of ArduPilot.
        backup: Where its parameters are saved; None: nowhere.
        dry_run: Only check.

    Returns:
        The vehicle in words; None if no autopilot speaks at the port.

    Raises:
        FlashingRefused: It is armed, runs on another board, or refuses to restart; nothing was changed.
        FlashingError: Its parameters cannot be saved.
        LinkError: The port cannot be opened.
    """
    async with connect(port_url(port)) as connection:
        try:
            vehicle = await connection.wait_for_vehicle(timeout=HEARTBEAT_TIMEOUT)
        except RemoteTimeout:
            return None
        name = f"{vehicle.firmware.NAME} vehicle {vehicle.system}"
        if vehicle.armed:
            raise FlashingRefused(f"flashing {name} failed: it is armed; disarm it first")
        await _check_board(vehicle, firmware, name)
        if dry_run:
            return name
        if backup is not None:
            await _save(vehicle, backup, name)
        await _start_bootloader(vehicle, name)
        return name


async def restore_parameters(port: str, backup: ParameterBackup) -> Restored:
    """Wait for the autopilot with its new firmware, and restore its parameters.

    Raises:
        FlashingError: It does not start, or its parameters cannot be restored; the text names the file.
    """
    try:
        async with connect(f"{port_url(port)}") as connection:
            vehicle = await connection.wait_for_vehicle(timeout=START_TIMEOUT)
            return await backup.restore(vehicle)
    except (MavstackError, OSError) as error:
        raise FlashingError(
            f"restoring the parameters failed, the firmware was written: {error}; "
            f"later: mav param load {backup.path} --everything --save"
        ) from error


async def _check_board(vehicle: Vehicle, firmware: FirmwareFile, name: str) -> None:
    """Compare the board early; ArduPilot sends its number, PX4 does not."""
    if vehicle.autopilot != common.MavAutopilot.ARDUPILOTMEGA:
        return
    try:
        version = await vehicle.get_version()
    except RemoteError:
        return
    board_id = version.board_version >> 16
    if board_id:
        check_board_id(firmware, board_id, name)


async def _save(vehicle: Vehicle, backup: ParameterBackup, name: str) -> None:
    try:
        await backup.save(vehicle)
    except (RemoteError, OSError) as error:
        raise FlashingError(
            f"flashing {name} failed: its parameters cannot be saved: {error}; --no-backup flashes it without"
        ) from error


async def _start_bootloader(vehicle: Vehicle, name: str) -> None:
    try:
        await vehicle.command(
            common.MavCmd.PREFLIGHT_REBOOT_SHUTDOWN, _STAY_IN_BOOTLOADER, timeout=_COMMAND_TIMEOUT
        )
    except RemoteTimeout:
        pass  # the autopilot rebooted before it sent the acknowledgement
    except RemoteError as error:
        raise FlashingRefused(f"flashing {name} failed: it does not start its bootloader: {error}") from error
    except LinkError:
        pass  # the port disappeared already, because the board reboots
