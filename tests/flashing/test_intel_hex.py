"""Intel HEX: addresses, neighbours, gaps."""

from __future__ import annotations

from mavstack.flashing.intel_hex import flat_image, parse_intel_hex


def line(kind: int, address: int, data: bytes = b"") -> str:
    record = bytes([len(data)]) + address.to_bytes(2, "big") + bytes([kind]) + data
    return f":{record.hex().upper()}{-sum(record) & 0xFF:02X}"


def parse(*lines: str):
    return parse_intel_hex("\r\n".join([*lines, line(1, 0)]).encode(), "file")


def test_neighbours_are_joined_in_any_order() -> None:
    assert parse(line(0, 4, b"efgh"), line(0, 0, b"abcd"), "", line(0, 16, b"z")) == (
        (0, b"abcdefgh"),
        (16, b"z"),
    )


def test_upper_halves_of_addresses() -> None:
    assert parse(line(4, 0, b"\x08\x01"), line(0, 0x10, b"a")) == ((0x08010010, b"a"),)
    assert parse(line(2, 0, b"\x10\x00"), line(0, 1, b"a"), line(3, 0, bytes(4))) == ((0x10001, b"a"),)


def test_gaps_of_a_flat_image_are_empty_flash() -> None:
    assert flat_image(parse(line(0, 8, b"ab"), line(0, 12, b"c"))) == (8, b"ab\xff\xffc")
