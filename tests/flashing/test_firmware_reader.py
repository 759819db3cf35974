"""Firmware files: recognised by their content, damaged ones refused."""

from __future__ import annotations

import json
from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.flashing import FirmwareFileError, FirmwareKind, parse_firmware, read_firmware
from mavstack.flashing.abin import make_abin
from mavstack.flashing.json_container import make_container

HEX = b":0400000001020304F2\n:00000001FF\n"
STM32_HEX = b":020000040800F2\n:0400000001020304F2\n:040000050800000DE2\n:00000001FF\n"


def fields(**changes):
    return json.dumps(json.loads(make_container(b"12345678", 9)) | changes).encode()


@pytest.mark.parametrize(
    ("data", "kind"),
    [
        (make_container(b"1234", 9), FirmwareKind.PX4),
        (make_container(b"1234", 9, FirmwareKind.APJ), FirmwareKind.APJ),
        (make_abin(b"1234"), FirmwareKind.ABIN),
        (HEX, FirmwareKind.SIK),
        (STM32_HEX, FirmwareKind.STM32),
        (b"\xe9\x01\x02", FirmwareKind.ESP32),
    ],
)
def test_files_are_recognised_by_their_content(data, kind, tmp_path) -> None:
    path = tmp_path / "firmware"
    path.write_bytes(data)
    assert read_firmware(path).kind is kind


def test_the_facts_of_a_container() -> None:
    found = parse_firmware(
        fields(signed_firmware=True, USBID="0x1209/0x5740", git_identity="abc", version="")
    )
    assert (found.board_id, found.image, found.size) == (9, b"12345678", 8)
    assert (found.signed, found.usb_ids, found.version) == (True, ("0x1209/0x5740",), "abc")
    assert found.properties is not None
    assert "image" not in found.properties


def test_images_are_padded_to_whole_words() -> None:
    assert parse_firmware(make_container(b"12345", 9)).image == b"12345\xff\xff\xff"


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (b"", "the file is empty"),
        (b"MZ\x90", "not a firmware file"),
        (b"{", "not JSON, the file may be cut off"),
        (b"{}", "the magic is None"),
        (fields(magic="APJFWv9"), "the magic is 'APJFWv9'"),
        (fields(board_id=0), "does not name its board"),
        (fields(board_id="9"), "does not name its board"),
        (fields(image=None), "the file has no image"),
        (fields(image=7), "image is damaged"),
        (fields(image="%%%"), "image is damaged"),
        (fields(image="AAAA"), "image is damaged"),
        (fields(image=json.loads(fields())["image"][:8]), "image is damaged"),
        (fields(image_size=9), "image has 8 bytes, and image_size says 9"),
        (make_abin(b"1234")[:-1], "the MD5 sum is"),
        (b"git version: 1\nMD5: 00\n", "has no end"),
        (b":00000001FE\n", "file:1: the checksum"),
        (b":000001FF\n", "not a line of an Intel HEX"),
        (b":0400000001020304F2\n", "the end of the file is missing"),
        (b":00000001FF\n", "the file has no data"),
        (b":00000006FA\n:00000001FF\n", "unknown record of type 6"),
        (b":0400000001020304F2\n" + HEX, "address 0x0 is written twice"),
    ],
)
def test_damaged_files(data, reason) -> None:
    with pytest.raises(FirmwareFileError, match=reason):
        parse_firmware(data, "file")


@given(st.binary(max_size=300), st.integers(0, 400))
def test_any_bytes_are_a_firmware_or_an_error(junk, cut) -> None:
    for data in (junk, b"{" + junk, b":" + junk, make_container(junk + b"x", 9)[:cut]):
        with suppress(FirmwareFileError):
            parse_firmware(data)
