"""Firmware files, boards and results as text."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.cli.common.output import align_columns
from mavstack.cli.common.text import size_text

if TYPE_CHECKING:
    from mavstack.flashing import Board, FirmwareFile, FlashResult


def file_lines(firmware: FirmwareFile) -> list[str]:
    """Return the facts of a file as lines."""
    rows = [("kind", str(firmware.kind)), ("name", firmware.name), ("version", firmware.version)]
    rows.append(("board", "" if firmware.board_id is None else str(firmware.board_id)))
    room = "" if firmware.max_size is None else f" of {size_text(firmware.max_size)}"
    rows.append(("size", size_text(firmware.size) + room))
    rows.append(("external flash", size_text(len(firmware.external)) if firmware.external else ""))
    rows.append(("signed", "yes" if firmware.signed else ""))
    rows.append(("USB", ", ".join(firmware.usb_ids)))
    return align_columns([row for row in rows if row[1]])


def board_lines(board: Board) -> list[str]:
    """Return the facts of a board as lines."""
    rows = [("board", board.name), ("revision", str(board.board_revision))]
    rows.append(("bootloader", f"revision {board.bootloader} of the protocol"))
    unused = board.flash_size - board.usable_size
    flaw = f", of which the chip cannot use {size_text(unused)}" if unused else ""
    rows.append(("flash", size_text(board.flash_size) + flaw))
    rows.append(("external flash", size_text(board.external_size) if board.external_size else ""))
    rows += [("chip", board.chip_name), ("serial number", board.serial)]
    return align_columns([row for row in rows if row[1]])


def result_lines(result: FlashResult, *, dry_run: bool) -> list[str]:
    """Return the result of flashing as lines."""
    if dry_run:
        return [f"{result.board}: the firmware fits; nothing was written", *result.notes]
    repeated = f" at attempt {result.attempts}" if result.attempts > 1 else ""
    lines = [f"{result.board}: {size_text(result.written)} written and verified{repeated}"]
    restored = result.restored
    if restored is not None:
        lines.append(
            f"parameters: {restored.set} restored, {restored.unchanged} unchanged; saved in {restored.path}"
        )
        if restored.failed:
            shown = ", ".join(restored.failed[:8]) + (" …" if len(restored.failed) > 8 else "")
            lines.append(f"{len(restored.failed)} parameters could not be restored: {shown}")
    return [*lines, *result.notes]
