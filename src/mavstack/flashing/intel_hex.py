"""Intel HEX files: lines of bytes with their addresses and checksums."""

from __future__ import annotations

from binascii import Error, unhexlify
from typing import Final, TypeAlias

from mavstack.flashing.failures import FirmwareFileError

#: Pairs of address and bytes, sorted by address; adjacent segments are joined.
Segments: TypeAlias = tuple[tuple[int, bytes], ...]

_DATA, _END, _SEGMENT, _START_SEGMENT, _LINEAR, _START_LINEAR = range(6)
#: Size of a record without its data in bytes: count, address, kind, checksum.
_OVERHEAD: Final = 5


def parse_intel_hex(data: bytes, name: str) -> Segments:
    """Parse an Intel HEX file.

    Args:
        data: The content.
        name: The name of the file, for errors.

    Returns:
        The bytes by address.

    Raises:
        FirmwareFileError: A line is damaged, the end is missing, or an address is written twice.
    """
    parts: list[tuple[int, bytes]] = []
    base, ended = 0, False
    for number, line in enumerate(data.splitlines(), 1):
        if not (text := line.strip()):
            continue
        kind, address, content = _record(text, name, number)
        if kind == _DATA:
            parts.append((base + address, content))
        elif kind == _SEGMENT:
            base = int.from_bytes(content, "big") << 4
        elif kind == _LINEAR:
            base = int.from_bytes(content, "big") << 16
        elif kind == _END:
            ended = True
            break
        elif kind not in (_START_SEGMENT, _START_LINEAR):
            raise FirmwareFileError(f"unknown record of type {kind}", name, number)
    if not ended or not parts:
        raise FirmwareFileError("the end of the file is missing" if parts else "the file has no data", name)
    return _joined(parts, name)


def flat_image(segments: Segments) -> tuple[int, bytes]:
    """Return the first address, and the bytes from there on with 0xFF in the gaps."""
    start = segments[0][0]
    end = max(address + len(part) for address, part in segments)
    image = bytearray(b"\xff" * (end - start))
    for address, part in segments:
        image[address - start : address - start + len(part)] = part
    return start, bytes(image)


def _record(text: bytes, name: str, number: int) -> tuple[int, int, bytes]:
    """Return type, address and data of a line."""
    try:
        record = unhexlify(text[1:]) if text.startswith(b":") else b""
    except (Error, ValueError):
        record = b""
    if len(record) < _OVERHEAD or len(record) != record[0] + _OVERHEAD:
        raise FirmwareFileError("not a line of an Intel HEX file", name, number)
    if sum(record) & 0xFF:
        raise FirmwareFileError("the checksum of the line is wrong", name, number)
    return record[3], int.from_bytes(record[1:3], "big"), record[4:-1]


def _joined(parts: list[tuple[int, bytes]], name: str) -> Segments:
    joined: list[tuple[int, bytearray]] = []
    for address, content in sorted(parts):
        end = joined[-1][0] + len(joined[-1][1]) if joined else -1
        if address < end:
            raise FirmwareFileError(f"address {address:#x} is written twice", name)
        if address == end:
            joined[-1][1].extend(content)
        else:
            joined.append((address, bytearray(content)))
    return tuple((address, bytes(content)) for address, content in joined)
