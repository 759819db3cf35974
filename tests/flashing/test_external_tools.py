"""dfu-util and esptool, by stand-ins that print what the programs print."""

from __future__ import annotations

import asyncio
import sys

import pytest

from mavstack.flashing import (
    FirmwareKind,
    FlashingError,
    FlashingRefused,
    FlashOptions,
    Phase,
    external_tools,
    flash_firmware,
    parse_firmware,
)
from mavstack.flashing.external_tools import RomFlash, parse_dfu_list
from tests.flashing.test_intel_hex import line

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="the stand-ins are shell scripts")

#: The output of dfu-util 0.11 for an STM32F405.
LIST = """\
dfu-util 0.11

Found DFU: [0483:df11] ver=2200, devnum=12, cfg=1, intf=0, path="1-2", alt=3, name="@Device Feature/0xFFFF0000/01*004 e", serial="3276365D3336"
Found DFU: [0483:df11] ver=2200, devnum=12, cfg=1, intf=0, path="1-2", alt=2, name="@OTP Memory /0x1FFF7800/01*512 e,01*016 e", serial="3276365D3336"
Found DFU: [0483:df11] ver=2200, devnum=12, cfg=1, intf=0, path="1-2", alt=0, name="@Internal Flash  /0x08000000/04*016Kg,01*064Kg,07*128Kg", serial="3276365D3336"
"""  # noqa: E501 (as the program prints it)


def stm32(size: int = 64, start: int = 0x0800):
    lines = [line(4, 0, start.to_bytes(2, "big")), line(0, 0, b"\x01" * 16)]
    lines += [line(0, at, b"\x02" * 16) for at in range(16, size, 16)]
    return parse_firmware("\n".join([*lines, line(1, 0)]).encode(), "betaflight.hex")


@pytest.fixture
def tools(monkeypatch, tmp_path):
    """Put stand-ins of programs into the path; they write what they are given to files."""

    def make(name: str, script: str) -> None:
        path = tmp_path / name
        path.write_text(f'#!/bin/sh\necho "$*" >> {tmp_path}/calls\n{script}\n')
        path.chmod(0o755)

    monkeypatch.setattr(external_tools, "which", lambda name: next(map(str, tmp_path.glob(name)), None))
    make.calls = lambda: (tmp_path / "calls").read_text().splitlines()
    make.folder = tmp_path
    return make


def dfu(
    tools, end: str = 'echo "Download [=====] 50% 1 bytes"; echo "Download done."', listed: str = LIST
) -> None:
    (tools.folder / "list.txt").write_text(listed)
    tools("dfu-util", f'if [ "$1" = --list ]; then cat {tools.folder}/list.txt; else {end}; fi')


def test_the_list_of_dfu_util() -> None:
    assert parse_dfu_list(LIST) == [RomFlash(0x0800_0000, 1024 * 1024)]
    assert parse_dfu_list("dfu-util 0.11\n") == []


def test_a_chip_in_its_rom(tools) -> None:
    dfu(tools)
    phases = []
    options = FlashOptions(report=lambda *progress: phases.append(progress))
    result = asyncio.run(flash_firmware(stm32(), "dfu", options))
    assert result.written == 64
    assert tools.calls()[0] == "--list"
    assert tools.calls()[1].startswith("-d 0483:df11 -a 0 -s 0x8000000:leave -D /")
    assert (Phase.PROGRAM, 50, 100) in phases


def test_a_dry_run(tools) -> None:
    dfu(tools)
    result = asyncio.run(flash_firmware(stm32(), "dfu", FlashOptions(dry_run=True)))
    assert result.board == "STM32 with 1048576 bytes of flash"
    assert tools.calls() == ["--list"]


@pytest.mark.parametrize(
    ("firmware", "listed", "reason"),
    [
        (stm32(start=0x0801), LIST, "the file begins at 0x8010000"),
        (
            stm32(2048),
            LIST.replace("04*016Kg,01*064Kg,07*128Kg", "01*001Kg"),
            "has 2048 bytes, the chip 1024",
        ),
        (stm32(), LIST + LIST.replace("128Kg", "256Kg"), "several chips are in their ROM"),
    ],
)
def test_refusals(tools, firmware, listed, reason) -> None:
    dfu(tools, listed=listed)
    with pytest.raises(FlashingRefused, match=reason):
        asyncio.run(flash_firmware(firmware, "dfu"))
    assert not (tools.folder / "calls").exists() or tools.calls() == ["--list"]


def test_the_program_fails(tools) -> None:
    dfu(tools, end='echo "Cannot open DFU device 0483:df11"; exit 74')
    with pytest.raises(FlashingError, match="flashing failed: dfu-util: Cannot open DFU device 0483:df11"):
        asyncio.run(flash_firmware(stm32(), "dfu"))


def test_the_program_is_not_installed(tools) -> None:
    with pytest.raises(FlashingRefused, match="dfu-util is not installed"):
        asyncio.run(flash_firmware(stm32(), "dfu"))
    with pytest.raises(FlashingRefused, match="esptool is not installed"):
        asyncio.run(flash_firmware(parse_firmware(b"\xe9\x03"), "/dev/ttyUSB0"))


def test_esp32(tools) -> None:
    tools("esptool", 'echo "Writing at 0x00010000... (37 %)"')
    firmware = parse_firmware(b"\xe9\x03\x02\x20")
    assert firmware.kind is FirmwareKind.ESP32
    assert asyncio.run(flash_firmware(firmware, "/dev/ttyUSB0")).written == 4
    assert asyncio.run(flash_firmware(firmware, "/dev/ttyUSB0", FlashOptions(dry_run=True))).written == 0
    flashed, checked = tools.calls()
    assert flashed.startswith("--port /dev/ttyUSB0 write-flash 0x0 /")
    assert checked.startswith("image-info /")
