"""Flashing by the protocol, without input and output: our bootloader, and a second, independent one."""

from __future__ import annotations

from dataclasses import replace
from random import Random

import pytest

from mavstack.flashing.bootloader_client import (
    BLOCK_SIZE,
    bootloader_version,
    flash,
    flash_crc,
    identify,
    reboot,
)
from mavstack.flashing.failures import BootloaderError, FlashingRefused
from mavstack.flashing.firmware_file import FirmwareFile, FirmwareKind
from mavstack.flashing.firmware_reader import parse_firmware
from mavstack.flashing.json_container import make_container
from mavstack.flashing.progress import Phase
from mavstack.flashing.simulated_bootloader import ARDUPILOT_BOARD, PX4_BOARD, SimulatedBootloader
from tests.flashing.lines import Line, Ours, Second
from tests.flashing.second_bootloader import SecondBootloader, crc_by_bits

#: The flash and the firmware of boards that lose their power.
TINY, PART = 1536, 1200
SMALL = replace(PX4_BOARD, flash_size=8192)
ERASE = bytes((0x23, 0x20))


def image(size: int = 3000, seed: int = 1) -> bytes:
    return b"\x00\x10\x00\x20" + Random(seed).randbytes(size - 4)


def firmware(board_id: int = 50, size: int = 3000, kind: FirmwareKind = FirmwareKind.PX4, **fields):
    external = fields.pop("external", b"")
    return parse_firmware(make_container(image(size), board_id, kind, external=external, **fields))


def test_a_firmware_is_written_verified_and_started() -> None:
    bootloader = SimulatedBootloader()
    phases: list[tuple[Phase, int, int]] = []
    line = Line(Ours(bootloader))
    line.flash(firmware(size=100_000), lambda *progress: phases.append(progress))
    assert bootloader.internal.content[:100_000] == image(100_000)
    assert set(bootloader.internal.content[100_000:]) == {0xFF}
    assert bootloader.started
    assert list(dict.fromkeys(phase for phase, _, _ in phases)) == [Phase.ERASE, Phase.PROGRAM, Phase.VERIFY]
    assert (Phase.PROGRAM, 100_000, 100_000) in phases


def test_the_board_is_identified() -> None:
    board = Line(Ours(SimulatedBootloader(PX4_BOARD))).run(identify())
    assert board == replace(PX4_BOARD, version="")
    assert Line(Ours(SimulatedBootloader(PX4_BOARD))).run(bootloader_version()) == "Mavstack 1"
    board = Line(Ours(SimulatedBootloader(ARDUPILOT_BOARD))).run(identify())
    assert (board.external_size, board.chip_name) == (8_388_608, "STM32H7[4|5]x,V")


@pytest.mark.parametrize("revision", [2, 3, 4, 5, 6])
def test_all_revisions(revision) -> None:
    bootloader = SimulatedBootloader(replace(SMALL, bootloader=revision))
    line = Line(Ours(bootloader))
    line.flash(firmware())
    assert bytes(bootloader.internal.content[:3000]) == image()
    second = SecondBootloader(revision=revision)
    Line(Second(second)).flash(firmware(9))
    assert second.content()[:3000] == image()
    assert second.running_firmware


def test_an_old_bootloader_does_not_know_its_version() -> None:
    assert Line(Second(SecondBootloader())).run(bootloader_version()) == ""


@pytest.mark.parametrize("size", [4, 8, BLOCK_SIZE - 4, BLOCK_SIZE, BLOCK_SIZE + 4, 2 * BLOCK_SIZE, 8192])
def test_sizes(size) -> None:
    second = SecondBootloader()
    Line(Second(second)).flash(firmware(9, size))
    assert second.content() == image(size) + b"\xff" * (8192 - size)


def test_an_image_that_ends_within_a_word_is_padded() -> None:
    second = SecondBootloader()
    Line(Second(second)).flash(firmware(9, 1001))
    assert second.content()[:1004] == image(1001) + b"\xff" * 3


def test_crc_of_a_flash() -> None:
    data = image(777)
    assert flash_crc(data, 8192) == crc_by_bits(data + b"\xff" * (8192 - 777))
    assert flash_crc(b"", 200_000) == crc_by_bits(b"\xff" * 200_000)


def test_external_flash() -> None:
    bootloader = SimulatedBootloader(replace(ARDUPILOT_BOARD, flash_size=8192, external_size=300_000))
    outside = Random(2).randbytes(150_001)
    phases: list[Phase] = []
    file = firmware(140, kind=FirmwareKind.APJ, external=outside)
    Line(Ours(bootloader)).flash(file, lambda phase, *_: phases.append(phase))
    assert bytes(bootloader.external.content[:150_001]) == outside
    assert bytes(bootloader.internal.content[:3000]) == image()
    assert phases[0] is Phase.ERASE_EXTERNAL
    assert Phase.PROGRAM_EXTERNAL in phases


# Refusals


def refused(board, file, match: str) -> None:
    line = Line(Ours(SimulatedBootloader(board)))
    found = line.run(identify())
    with pytest.raises(FlashingRefused, match=match):
        line.run(flash(file, found))
    assert ERASE not in line.to_board


@pytest.mark.parametrize("board_id", [1, 9, 11, 33, 49, 51, 140, 1063, 65535])
def test_the_firmware_of_another_board_is_refused(board_id) -> None:
    refused(SMALL, firmware(board_id), f"the firmware is for board {board_id}.*get the file for board 50")


def test_wrong_boards_are_refused_in_all_cases() -> None:
    random = Random(3)
    boards = [random.randrange(1, 3000) for _ in range(60)]
    for board_id in boards:
        board = replace(SMALL, board_id=board_id)
        for other in random.sample(boards, 20):
            if other != board_id and (board_id, other) != (33, 9):
                refused(board, firmware(other), "is for board")


def test_a_compatible_board() -> None:
    bootloader = SimulatedBootloader(replace(SMALL, board_id=33))
    Line(Ours(bootloader)).flash(firmware(9))
    assert bootloader.started


@pytest.mark.parametrize(
    ("board", "file", "match"),
    [
        (SMALL, {"size": 8196}, "has 8196 bytes, the board 8192"),
        (SMALL, {"image_maxsize": 2000}, "its file allows 2000"),
        (SMALL, {"external": b"data"}, "4 bytes of external flash, the board 0"),
        (replace(SMALL, bootloader=7), {}, "speaks revision 7 of the protocol, known are 2 to 6"),
        (replace(SMALL, bootloader=1), {}, "speaks revision 1"),
    ],
)
def test_a_firmware_that_does_not_fit_is_refused(board, file, match) -> None:
    refused(board, firmware(**file), match)


@pytest.mark.parametrize("revision", [0x1000, 0x1001, 0x1003, 0x1007])
def test_a_flawed_chip_has_one_megabyte(revision) -> None:
    flawed = replace(PX4_BOARD, board_id=9, chip=revision << 16 | 0x419)
    file = firmware(9, 1_032_196)
    refused(flawed, file, "the board 1032192; its chip cannot use the rest")
    sound = SimulatedBootloader(replace(flawed, chip=0x2001 << 16 | 0x419))
    Line(Ours(sound)).flash(file)
    assert sound.started


def test_an_old_bootloader_of_a_pixhawk_may_have_a_flawed_chip() -> None:
    refused(replace(PX4_BOARD, board_id=9, bootloader=4), firmware(9, 1_032_196), "the board 1032192")


# Faults


def test_flash_that_cannot_be_written() -> None:
    bootloader = SimulatedBootloader(SMALL)
    bootloader.internal.broken = True
    with pytest.raises(BootloaderError, match="the CRC of the flash is 0x"):
        Line(Ours(bootloader)).flash(firmware())


def test_flash_of_revision_2_that_cannot_be_written() -> None:
    bootloader = SimulatedBootloader(replace(SMALL, bootloader=2))
    bootloader.internal.broken = True
    with pytest.raises(BootloaderError, match="the flash differs at byte 0"):
        Line(Ours(bootloader)).flash(firmware())


def test_signed_images() -> None:
    good = SimulatedBootloader(SMALL, verify=lambda content: content[:3000] == image())
    Line(Ours(good)).flash(firmware(image_signed=True))
    assert good.started
    bad = SimulatedBootloader(SMALL, verify=lambda content: False)
    with pytest.raises(BootloaderError, match="verifying the signature failed: FAILED"):
        Line(Ours(bad)).flash(firmware(image_signed=True))
    assert not bad.has_firmware
    with pytest.raises(BootloaderError, match="the bootloader has no secure boot"):
        Line(Ours(SimulatedBootloader(SMALL))).flash(firmware(image_signed=True))


def test_signed_images_of_ardupilot_are_verified_at_their_start() -> None:
    bootloader = SimulatedBootloader(SMALL)
    Line(Ours(bootloader)).flash(firmware(kind=FirmwareKind.APJ, signed_firmware=True))
    assert bootloader.started


def test_a_board_that_does_not_answer() -> None:
    class Silent(Ours):
        def take(self, data: bytes, now: float) -> bytes:
            return b""

    line = Line(Silent(SimulatedBootloader()))
    with pytest.raises(BootloaderError, match="finding the bootloader failed: the bootloader does not"):
        line.run(identify())
    assert line.now < 5


def test_stale_bytes_before_the_first_reply() -> None:
    class Stale(Ours):
        first = True

        def take(self, data: bytes, now: float) -> bytes:
            answer = super().take(data, now)
            stale, self.first = (b"\xfe\x09\x00", False) if self.first else (b"", False)
            return stale + answer

    assert Line(Stale(SimulatedBootloader())).run(identify()).board_id == 50


def test_a_request_that_was_broken_off_is_given_up() -> None:
    bootloader = SimulatedBootloader(SMALL)
    device = Ours(bootloader)
    device.take(b"\x21\x20\x27\xfc" + bytes(100), 0.0)
    assert Line(device).run(identify()).board_id == 50


# Power


def outcome(line: Line, file: FirmwareFile) -> BootloaderError | None:
    try:
        line.flash(file)
    except BootloaderError as error:
        return error
    return None


def lose_power(position: int, second: bool) -> None:
    """Lose the power after some bytes, and flash again; the board never starts half a firmware."""
    tiny = replace(SMALL, flash_size=TINY)
    device = Second(SecondBootloader(size=TINY)) if second else Ours(SimulatedBootloader(tiny))
    file = firmware(9 if second else 50, PART)
    line = Line(device, cut_after=position)
    failure = outcome(line, file)
    if failure is not None:
        assert failure.status is None, position
        assert_not_half(device)
        line.flash(file)
    bootloader = device.bootloader
    content = bootloader.content() if second else bytes(bootloader.internal.content)
    assert content == image(PART) + b"\xff" * (TINY - PART), position
    assert bootloader.running_firmware if second else bootloader.started


def assert_not_half(device) -> None:
    second = isinstance(device, Second)
    content = device.bootloader.content() if second else bytes(device.bootloader.internal.content)
    if content[:4] != b"\xff" * 4:
        assert content[:PART] == image(PART)


def bytes_of_a_flash() -> int:
    line = Line(Ours(SimulatedBootloader(replace(SMALL, flash_size=TINY))))
    line.flash(firmware(50, PART))
    return line.carried


@pytest.mark.parametrize("second", [False, True])
def test_power_loss(second) -> None:
    random = Random(4)
    total = bytes_of_a_flash()
    for _ in range(100):
        lose_power(random.randrange(total), second)


@pytest.mark.nightly
@pytest.mark.timeout(600)
def test_power_loss_at_10000_positions() -> None:
    random = Random(5)
    total = bytes_of_a_flash()
    for count in range(10_000):
        lose_power(random.randrange(total), count % 2 == 0)


def test_a_board_that_was_started_needs_no_answer() -> None:
    class Gone(Ours):
        def take(self, data: bytes, now: float) -> bytes:
            return b""

    Line(Gone(SimulatedBootloader(SMALL))).run(reboot())


def test_a_board_that_lost_its_power_before_it_kept_the_firmware() -> None:
    line = Line(Ours(SimulatedBootloader(SMALL)), cut_after=1)
    with pytest.raises(BootloaderError, match="in its bootloader again"):
        line.run(reboot())
