"""Firmware files, boards and results as JSON, for scripts and for the station."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mavstack.flashing.board import Board
    from mavstack.flashing.firmware_file import FirmwareFile
    from mavstack.flashing.result import FlashResult


def file_json(firmware: FirmwareFile) -> dict[str, Any]:
    """Return the facts of a file for JSON."""
    return {
        "kind": str(firmware.kind),
        "name": firmware.name,
        "version": firmware.version,
        "board": firmware.board_id,
        "size": firmware.size,
        "external_size": len(firmware.external),
        "max_size": firmware.max_size,
        "signed": firmware.signed,
        "usb": list(firmware.usb_ids),
    }


def board_json(board: Board) -> dict[str, Any]:
    """Return the facts of a board for JSON."""
    return {
        "board": board.board_id,
        "name": board.name,
        "revision": board.board_revision,
        "bootloader": board.bootloader,
        "flash_size": board.flash_size,
        "usable_size": board.usable_size,
        "external_size": board.external_size,
        "chip": board.chip_name,
        "serial": board.serial,
    }


def result_json(result: FlashResult, *, dry_run: bool) -> dict[str, Any]:
    """Return the result of flashing for JSON."""
    restored = result.restored
    return {
        "board": result.board,
        "dry_run": dry_run,
        "written": result.written,
        "attempts": result.attempts,
        "parameters": None
        if restored is None
        else {
            "file": str(restored.path),
            "set": restored.set,
            "unchanged": restored.unchanged,
            "failed": list(restored.failed),
        },
        "notes": list(result.notes),
    }
