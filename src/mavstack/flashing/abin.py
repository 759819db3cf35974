"""ArduPilot's .abin files: a header in text with the MD5 sum, and the image of the firmware."""

from __future__ import annotations

from hashlib import md5
from typing import Final

from mavstack.flashing.failures import FirmwareFileError
from mavstack.flashing.firmware_file import FirmwareFile, FirmwareKind

ABIN_START: Final = b"git version:"
_SEPARATOR: Final = b"--\n"
_MD5: Final = "MD5"
#: Maximum size of the header in bytes.
_MAX_HEADER: Final = 1024


def parse_abin(data: bytes, name: str) -> FirmwareFile:
    """Parse an .abin file, which is sent to the vehicle as it is.

    Args:
        data: The content.
        name: The name of the file, for errors.

    Returns:
        The firmware, whose image is the whole file.

    Raises:
        FirmwareFileError: The header is damaged, or the MD5 sum is wrong.
    """
    head, mark, image = data.partition(_SEPARATOR)
    if not mark or len(head) > _MAX_HEADER or not image:
        raise FirmwareFileError("the header of the .abin file has no end, or no image follows", name)
    fields = dict(
        line.split(": ", 1) for line in head.decode("ascii", "replace").splitlines() if ": " in line
    )
    expected = fields.get(_MD5, "").strip().lower()
    found = md5(image, usedforsecurity=False).hexdigest()
    if found != expected:
        raise FirmwareFileError(f"the MD5 sum is {found}, the header says {expected or 'none'}", name)
    version = fields.get("git version", "").strip()
    return FirmwareFile(kind=FirmwareKind.ABIN, image=data, name="ArduPilot", version=version)


def make_abin(image: bytes, version: str = "00000000") -> bytes:
    """Return an .abin file of an image."""
    total = md5(image, usedforsecurity=False).hexdigest()
    return f"git version: {version}\nMD5: {total}\n--\n".encode("ascii") + image
