"""The content of metadata files: decompression within bounds, and the CRC.

The format follows from the first bytes, not from the name: xz (components, PX4's and ArduPilot's servers),
gzip (ArduPilot's server) or neither.
"""

from __future__ import annotations

import zlib
from typing import TYPE_CHECKING, Final, Protocol

from mavstack.errors import MetadataError
from mavstack.services.ftp import file_crc32

if TYPE_CHECKING:
    from collections.abc import Callable

#: The largest file as it is served, in bytes; the largest published file has 300 kB.
MAX_FILE: Final = 8 << 20
#: The largest content after decompression, in bytes; the largest published content has 2.5 MB.
MAX_CONTENT: Final = 32 << 20
#: Bytes that the decompressor of xz may use for its dictionary; the largest preset needs 65 MB.
_MAX_XZ_MEMORY: Final = 80 << 20
_XZ_MAGIC: Final = b"\xfd7zXZ\0"
_GZIP_MAGIC: Final = b"\x1f\x8b"
_GZIP_WINDOW: Final = 31


class _Decompressor(Protocol):
    """A decompressor of one stream."""

    @property
    def eof(self) -> bool:
        """True after the end of the stream."""

    def decompress(self, data: bytes, max_length: int, /) -> bytes:
        """Return up to `max_length` bytes."""


def unpack_content(data: bytes, *, max_size: int = MAX_CONTENT) -> bytes:
    """Return the content of a file, decompressed if it is compressed.

    Args:
        data: The file.
        max_size: The largest accepted content in bytes.

    Returns:
        The content.

    Raises:
        MetadataError: The file or its content is too large, or the compressed data is damaged.
    """
    if len(data) > MAX_FILE and (data.startswith((_XZ_MAGIC, _GZIP_MAGIC)) or len(data) > max_size):
        raise MetadataError(f"the file has {len(data)} bytes, more than any metadata")
    if data.startswith(_XZ_MAGIC):
        return _decompressed(_xz_decompressor, data, max_size, "xz")
    if data.startswith(_GZIP_MAGIC):
        return _decompressed(lambda: zlib.decompressobj(_GZIP_WINDOW), data, max_size, "gzip")
    return data


def has_crc(data: bytes, crc: int) -> bool:
    """Return whether a CRC is that of a file, as it is or uncompressed (MAVLink's CRC-32).

    Raises:
        MetadataError: The CRC is not that of the file as it is, and its compressed data is damaged.
    """
    return file_crc32(data) == crc or file_crc32(unpack_content(data)) == crc


def _decompressed(make: Callable[[], _Decompressor], data: bytes, max_size: int, form: str) -> bytes:
    try:
        decompressor = make()
        content = decompressor.decompress(data, max_size + 1)
    except (OSError, ValueError, EOFError, MemoryError, zlib.error, _xz_error()) as error:
        raise MetadataError(f"the {form} data is damaged: {error}") from None
    if len(content) > max_size:
        raise MetadataError(f"the {form} data holds more than {max_size} bytes, more than any metadata")
    if not decompressor.eof:
        raise MetadataError(f"the {form} data ends too early")
    return content


def _xz_decompressor() -> _Decompressor:
    import lzma

    return lzma.LZMADecompressor(lzma.FORMAT_XZ, _MAX_XZ_MEMORY)


def _xz_error() -> type[Exception]:
    import lzma

    return lzma.LZMAError
