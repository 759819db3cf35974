"""Flashing and programs that are not ours: the classic uploader of PX4 flashes the simulated bootloader."""

from __future__ import annotations

import subprocess
import sys
from contextlib import contextmanager
from random import Random
from shutil import which
from typing import TYPE_CHECKING

import pytest

from mavstack.flashing.json_container import make_container

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

pytestmark = [
    pytest.mark.interop,
    pytest.mark.skipif(sys.platform == "win32", reason="needs pseudo terminals"),
]

UPLOAD = """
import sys
from autopilot_tools.px4._px_uploader import px_uploader

px_uploader([sys.argv[1]], sys.argv[2])
"""


@contextmanager
def simulated_board(terminal: Path, name: str = "px4") -> Iterator[subprocess.Popen[str]]:
    words = ["sim", "--bootloader", name, "--out", f"pty://{terminal}", "--for", "100", "--json"]
    with subprocess.Popen(
        [sys.executable, "-m", "mavstack", *words], stdout=subprocess.PIPE, text=True
    ) as program:
        try:
            assert program.stdout is not None
            assert "ready" in program.stdout.readline()
            yield program
        finally:
            program.terminate()


def flash_with_autopilot_tools(tmp_path: Path, size: int, board_id: int) -> tuple[str, str]:
    """Flash by the uploader; return what it printed, and the events of the board."""
    pytest.importorskip("autopilot_tools", reason="autopilot-tools is not installed")
    firmware, terminal = tmp_path / "firmware.px4", tmp_path / "ttyBL"
    content = make_container(
        b"\x00\x10\x00\x20" + Random(1).randbytes(size), board_id, image_maxsize=2_064_384
    )
    firmware.write_bytes(content)
    with simulated_board(terminal) as board:
        words = [sys.executable, "-c", UPLOAD, str(firmware), str(terminal)]
        uploaded = subprocess.run(words, capture_output=True, text=True, timeout=90, check=False)
        board.terminate()
        assert board.stdout is not None
        return uploaded.stdout, board.stdout.read()


@pytest.mark.smoke
def test_the_classic_uploader_flashes_the_simulated_bootloader(tmp_path: Path) -> None:
    printed, events = flash_with_autopilot_tools(tmp_path, 300_000, 50)
    assert "Found board id: 50,0 bootloader version: 5" in printed
    assert "Rebooting." in printed
    assert "Elapsed Time" in printed
    assert events.index("flash erased") < events.index("firmware started")


@pytest.mark.parametrize("board_id", [9, 140])
def test_the_classic_uploader_refuses_another_board(tmp_path: Path, board_id: int) -> None:
    printed, events = flash_with_autopilot_tools(tmp_path, 1000, board_id)
    assert f"Firmware not suitable for this board (Firmware board_type=50 board_id={board_id})" in printed
    assert "erased" not in events


@pytest.mark.skipif(which("stm32flash") is None, reason="stm32flash is not installed")
def test_stm32flash_writes_and_verifies_the_simulated_rom(tmp_path: Path) -> None:
    firmware, terminal, read = tmp_path / "firmware.bin", tmp_path / "ttyROM", tmp_path / "read.bin"
    firmware.write_bytes(Random(1).randbytes(100_000))
    with simulated_board(terminal, "stm32") as board:
        for words in (["-v", "-w", str(firmware)], ["-r", str(read), "-S", "0x08000000:100000"]):
            # A pseudo terminal has no parity.
            command = ["stm32flash", *words, "-b", "115200", "-m", "8n1", str(terminal)]
            result = subprocess.run(command, capture_output=True, text=True, timeout=90, check=False)
            assert result.returncode == 0, result.stderr
        board.terminate()
        assert board.stdout is not None
        assert "erased" in board.stdout.read()
    assert read.read_bytes() == firmware.read_bytes()
