"""A simulated board on a pseudo terminal, flashed by a program of its machine."""

from __future__ import annotations

import asyncio
import sys

import pytest

from mavstack.flashing import FlashOptions, flash_firmware, parse_firmware
from mavstack.flashing.background_board import BackgroundBoard
from mavstack.flashing.json_container import make_container

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="needs pseudo terminals")


def test_a_board_is_flashed_over_a_terminal(tmp_path) -> None:
    firmware = parse_firmware(make_container(b"\x00\x10\x00\x20" + bytes(20_000), 9, image_maxsize=2_064_384))
    with BackgroundBoard("px4", board_id=9) as board:
        assert not board.has_firmware
        result = asyncio.run(flash_firmware(firmware, board.port, FlashOptions(backup_folder=tmp_path)))
        assert result.board == "board 9, Pixhawk 1 (FMUv2, FMUv3)"
        assert board.has_firmware
