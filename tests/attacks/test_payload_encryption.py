"""Attacks on encrypted payloads without authentication, the structure of MAVShield, and on a sealed link."""

from __future__ import annotations

import pytest

pytest.importorskip("cryptography")

from cryptography.hazmat.primitives.ciphers import Cipher
from cryptography.hazmat.primitives.ciphers.algorithms import AES
from cryptography.hazmat.primitives.ciphers.modes import CTR

from mavstack.dialects import common
from mavstack.wire import Parser, crc16, encode
from tests.security.sealed.network import Network

KEY, NONCE = bytes(16), bytes(16)
EXTRA = bytes((common.CommandLong.definition.crc_extra,))


def encrypted(packet: bytes) -> bytes:
    """Return a packet with its payload encrypted or decrypted, and a new CRC."""
    return with_crc(packet[:10] + Cipher(AES(KEY), CTR(NONCE)).encryptor().update(packet[10:-2]))


def with_crc(packet: bytes) -> bytes:
    return packet + crc16(EXTRA, crc16(packet[1:])).to_bytes(2, "little")


def flipped(packet: bytes, position: int, bits: int) -> bytes:
    return packet[:position] + bytes((packet[position] ^ bits,)) + packet[position + 1 :]


def test_a_bit_of_an_encrypted_payload_is_flipped_without_the_key():
    disarm = encode(common.CommandLong(command=400, confirmation=1), system=255, component=190)
    on_the_way = encrypted(disarm)
    command = 10 + 28  # the seven parameters come first
    altered = with_crc(flipped(on_the_way, command, 400 & 0xFF ^ 246)[:-2])
    altered = with_crc(flipped(altered, command + 1, 400 >> 8)[:-2])
    (packet,) = Parser(common).feed(encrypted(altered))
    assert packet.message.command == 246  # a reboot
    (again,) = Parser(common).feed(encrypted(on_the_way))
    assert again.message.command == 400  # and the recorded packet is valid each time


def test_a_sealed_link_refuses_both():
    network = Network()
    network.ends = [network.client(), network.server()]
    network.run(1.0)
    disarm = encode(common.CommandLong(command=400), system=255, component=190)
    frame = network.ends[0].seal(disarm, network.now)
    for position in range(len(frame)):
        network.inject(1, flipped(frame, position, 1))
    for _ in range(2):
        network.inject(1, frame)
    network.run(0.1)
    assert network.received[1] == [disarm]
    refusals = network.ends[1].refusals
    assert refusals["replayed"] >= 1
    assert refusals["forged"] >= len(frame) - 5  # other bytes of the header name other sessions
    assert sum(refusals.values()) == len(frame) + 1
