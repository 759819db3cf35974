from __future__ import annotations

from functools import reduce
from operator import xor

import pytest

from mavstack.flashing.simulated_rom import (
    ACK,
    CHIP_ID,
    ERASE,
    FLASH_SIZE,
    FLASH_START,
    GET_ID,
    GO,
    NACK,
    RAM_START,
    READ,
    SYNC,
    WRITE,
    SimulatedRom,
)


@pytest.fixture
def rom():
    chip = SimulatedRom()
    assert send(chip, b"noise\x00") == b""
    assert send(chip, bytes([SYNC])) == bytes([ACK])
    return chip


def send(rom, data):
    rom.receive(data, 0.0)
    return rom.output()


def command(rom, number):
    return send(rom, bytes((number, number ^ 0xFF)))


def checked(data):
    return data + bytes([reduce(xor, data)])


def write(rom, address, data):
    assert command(rom, WRITE) == bytes([ACK])
    found = send(rom, checked(address.to_bytes(4, "big")))
    return send(rom, checked(bytes([len(data) - 1]) + data)) if found == bytes([ACK]) else found


def read(rom, address, count):
    assert command(rom, READ) == bytes([ACK])
    assert send(rom, checked(address.to_bytes(4, "big"))) == bytes([ACK])
    return send(rom, bytes((count - 1, (count - 1) ^ 0xFF)))[1:]


def test_the_chip_names_itself(rom):
    assert command(rom, GET_ID) == bytes((ACK, 1, CHIP_ID >> 8, CHIP_ID & 0xFF, ACK))
    assert command(rom, 0x55) == bytes([NACK])
    assert send(rom, bytes([SYNC])) == bytes([NACK]), "it is in step already"


def test_flash_is_written_after_it_was_erased(rom):
    events = []
    rom.on_event = events.append
    assert write(rom, FLASH_START, b"\x12\x34\x56\x78") == bytes([ACK])
    assert read(rom, FLASH_START, 4) == b"\x12\x34\x56\x78"
    assert write(rom, FLASH_START, b"\xf0\xf0\xf0\xf0") == bytes([ACK])
    assert read(rom, FLASH_START, 4) == b"\x10\x30\x50\x70", "bits go to zero only"
    assert command(rom, ERASE) == bytes([ACK])
    assert send(rom, b"\xff\xff\x00") == bytes([ACK])
    assert read(rom, FLASH_START, 4) == b"\xff" * 4
    assert command(rom, ERASE) == bytes([ACK])
    assert send(rom, checked(b"\x00\x01\x00\x00\x00\x01")) == bytes([ACK])
    assert events == ["flash erased", "2 sectors erased"]


def test_ram_is_lost_with_the_power_and_flash_is_not(rom):
    write(rom, RAM_START, b"\x01\x02\x03\x04")
    write(rom, FLASH_START + FLASH_SIZE - 4, b"\x01\x02\x03\x04")
    rom.power_cycle()
    send(rom, bytes([SYNC]))
    assert read(rom, RAM_START, 4) == bytes(4)
    assert read(rom, FLASH_START + FLASH_SIZE - 4, 4) == b"\x01\x02\x03\x04"


def test_wrong_requests_are_refused(rom):
    assert write(rom, 0x4000_0000, b"\x00\x00\x00\x00") == bytes([NACK])
    assert write(rom, FLASH_START + FLASH_SIZE - 4, bytes(8)) == bytes([NACK])
    assert write(rom, FLASH_START + 1, bytes(4)) == bytes([NACK])
    command(rom, GO)
    assert send(rom, bytes((1, 2, 3, 4, 5))) == bytes([NACK])
    command(rom, ERASE)
    assert send(rom, checked(b"\x00\x00\x00\x0c")) == bytes([NACK]), "there are twelve sectors"


def test_a_program_is_started(rom):
    command(rom, GO)
    assert send(rom, checked(FLASH_START.to_bytes(4, "big"))) == bytes([ACK])
    assert rom.started == FLASH_START
    assert send(rom, bytes([SYNC])) == b"", "the ROM runs no more"
