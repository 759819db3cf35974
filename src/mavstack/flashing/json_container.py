"""The files .px4 and .apj: JSON with the image, compressed by zlib and encoded by base64, and its board."""

from __future__ import annotations

import json
import zlib
from base64 import b64decode, b64encode
from binascii import Error
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, TypeGuard

from mavstack.flashing.failures import FirmwareFileError
from mavstack.flashing.firmware_file import MAX_FILE_SIZE, FirmwareFile, FirmwareKind

if TYPE_CHECKING:
    from collections.abc import Mapping

_KINDS: Final[Mapping[str, FirmwareKind]] = MappingProxyType(
    {"PX4FWv1": FirmwareKind.PX4, "PX4FWv2": FirmwareKind.PX4, "APJFWv1": FirmwareKind.APJ}
)
_MAGICS: Final = MappingProxyType({FirmwareKind.PX4: "PX4FWv1", FirmwareKind.APJ: "APJFWv1"})
#: Fields with large data, which `properties` leaves out.
_LARGE: Final = frozenset(
    {"image", "extf_image", "parameter_xml", "airframe_xml", "mavlink_metadata", "parameter_json"}
)
_WORD: Final = 4
_MAX_BOARD_ID: Final = 0xFFFF_FFFF


def parse_container(data: bytes, name: str) -> FirmwareFile:
    """Parse a .px4 or .apj file.

    Args:
        data: The content.
        name: The name of the file, for errors.

    Returns:
        The firmware.

    Raises:
        FirmwareFileError: The file is damaged, or names no board.
    """
    fields = _fields(data, name)
    magic = fields.get("magic")
    kind = _KINDS.get(magic) if isinstance(magic, str) else None
    if kind is None:
        raise FirmwareFileError(f"the magic is {magic!r}, not that of a .px4 or .apj file", name)
    board_id = fields.get("board_id")
    if not _is_number(board_id) or not 0 < board_id <= _MAX_BOARD_ID:
        raise FirmwareFileError("the file does not name its board (board_id)", name)
    image = _image(fields, "image", "image_size", name)
    if not image:
        raise FirmwareFileError("the file has no image", name)
    external = _image(fields, "extf_image", "extf_image_size", name)
    limit = fields.get("image_maxsize")
    return FirmwareFile(
        kind=kind,
        image=image,
        external=external,
        board_id=board_id,
        max_size=limit if _is_number(limit) and limit > 0 else None,
        signed=bool(fields.get("image_signed") or fields.get("signed_firmware")),
        name=_text(fields, "summary") or _text(fields, "description"),
        version=_text(fields, "version") or _text(fields, "git_identity") or _text(fields, "git_hash"),
        usb_ids=(_text(fields, "USBID"),) if fields.get("USBID") else (),
        properties={key: value for key, value in fields.items() if key not in _LARGE},
    )


def make_container(
    image: bytes,
    board_id: int,
    kind: FirmwareKind = FirmwareKind.PX4,
    *,
    external: bytes = b"",
    **fields: object,
) -> bytes:
    """Return a .px4 or .apj file.

    Args:
        image: The bytes for the internal flash.
        board_id: The board.
        kind: PX4 or APJ.
        external: The bytes for the external flash.
        fields: Further fields, or other values of the usual ones.

    Returns:
        The content of the file.
    """
    content: dict[str, object] = {
        "magic": _MAGICS[kind],
        "board_id": board_id,
        "board_revision": 0,
        "description": "firmware of a test",
        "summary": "test",
        "version": "1.0",
        "image_size": len(image),
        "image_maxsize": max(len(image), 1),
        "image": b64encode(zlib.compress(image)).decode("ascii"),
    }
    if external:
        content["extf_image_size"] = len(external)
        content["extf_image"] = b64encode(zlib.compress(external)).decode("ascii")
    return json.dumps(content | fields).encode("utf-8")


def _fields(data: bytes, name: str) -> dict[str, Any]:
    try:
        fields = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise FirmwareFileError(f"not JSON, the file may be cut off: {error}", name) from None
    if not isinstance(fields, dict):
        raise FirmwareFileError("not an object of JSON", name)
    return fields


def _image(fields: dict[str, Any], key: str, size_key: str, name: str) -> bytes:
    """Return an image in whole words; empty if the file has none."""
    text = fields.get(key)
    if text is None:
        return b""
    unpacker = zlib.decompressobj()
    try:
        image = unpacker.decompress(b64decode(text, validate=True), MAX_FILE_SIZE)
    except (Error, zlib.error, TypeError, ValueError) as error:
        raise FirmwareFileError(f"{key} is damaged: {error}", name) from None
    if not unpacker.eof:
        raise FirmwareFileError(f"{key} is damaged: its compressed data has no end", name)
    size = fields.get(size_key)
    if size is not None and size != len(image):
        raise FirmwareFileError(f"{key} has {len(image)} bytes, and {size_key} says {size}", name)
    return image + b"\xff" * (-len(image) % _WORD)


def _is_number(value: object) -> TypeGuard[int]:
    return isinstance(value, int) and not isinstance(value, bool)


def _text(fields: dict[str, Any], key: str) -> str:
    value = fields.get(key)
    return value if isinstance(value, str) else ""
