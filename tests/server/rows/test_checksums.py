from __future__ import annotations

import zlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.server.rows.checksums import CHECKSUMS

#: The checks of the text 123456789 in the catalogues of these checksums.
CHECKS = {
    "sum8": 0xDD,
    "sum16": 0x1DD,
    "xor8": 0x31,
    "fletcher8": 0x15DD,
    "crc8": 0xF4,
    "crc8-dvb-s2": 0xBC,
    "crc8-maxim": 0xA1,
    "crc16-ccitt": 0x29B1,
    "crc16-xmodem": 0x31C3,
    "crc16-x25": 0x906E,
    "crc16-mcrf4xx": 0x6F91,
    "crc16-modbus": 0x4B37,
    "crc16-arc": 0xBB3D,
    "crc32": 0xCBF43926,
}


@pytest.mark.parametrize("kind", CHECKSUMS)
def test_each_kind_has_the_check_of_its_catalogue(kind: str) -> None:
    size, function = CHECKSUMS[kind]
    assert function(b"123456789") == CHECKS[kind]
    assert size == (1 if "8" in kind and kind != "fletcher8" else 4 if kind == "crc32" else 2)


@given(st.binary(max_size=300))
def test_crc32_is_the_one_of_the_library(data: bytes) -> None:
    assert CHECKSUMS["crc32"][1](data) == zlib.crc32(data)
