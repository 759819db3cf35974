"""Files with decoders: one decoder, or those of a dashboard or of a project of dashboards."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Final

from mavstack.errors import InvalidArgumentError
from mavstack.server.rows.frame_decoder import FILE_TYPE, FrameDecoder, parse_decoder

if TYPE_CHECKING:
    from pathlib import Path

#: Maximum size of a decoder file in bytes.
MAX_FILE: Final = 2_000_000
_DASHBOARD: Final = "mavstack-dashboard"
_PROJECT: Final = "mavstack-project"


def read_decoders(path: Path) -> dict[str, FrameDecoder]:
    """Read all decoders of a file.

    Args:
        path: The file of a decoder, of a dashboard or of a project.

    Returns:
        The decoders by their names.

    Raises:
        InvalidArgumentError: The file cannot be read, is of another kind, or has a malformed decoder.
    """
    value = _read(path)
    kind = value.get("type")
    if kind == FILE_TYPE:
        found = [value]
    elif kind == _DASHBOARD:
        found = _objects(value, "decoders")
    elif kind == _PROJECT:
        found = [each for board in _objects(value, "dashboards") for each in _objects(board, "decoders")]
    else:
        raise _failed(path, f'its "type" must be one of {FILE_TYPE}, {_DASHBOARD}, {_PROJECT}')
    try:
        decoders = [parse_decoder(each) for each in found]
    except InvalidArgumentError as error:
        raise _failed(path, str(error)) from None
    return {each.name: each for each in decoders}


def read_decoder_file(path: Path, name: str = "") -> FrameDecoder:
    """Read one decoder of a file.

    Args:
        path: The file.
        name: The name of the decoder; empty: the only one.

    Returns:
        The decoder.

    Raises:
        InvalidArgumentError: See `read_decoders`; or the decoder is not there, or there are several.
    """
    decoders = read_decoders(path)
    if name in decoders:
        return decoders[name]
    names = ", ".join(decoders) or "none"
    if name:
        raise _failed(path, f"it has no decoder {name}: there are {names}")
    if len(decoders) != 1:
        raise _failed(path, f"it has {len(decoders)} decoders, not one: {names}")
    return next(iter(decoders.values()))


def _read(path: Path) -> dict[str, Any]:
    try:
        with path.open("rb") as file:
            data = file.read(MAX_FILE + 1)
    except (OSError, ValueError) as error:
        raise _failed(path, getattr(error, "strerror", None) or str(error)) from None
    if len(data) > MAX_FILE:
        raise _failed(path, f"it is longer than {MAX_FILE} bytes")
    try:
        value = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise _failed(path, f"it is not JSON: {error}") from None
    if not isinstance(value, dict):
        raise _failed(path, "it is not a JSON object")
    return value


def _objects(value: dict[str, Any], name: str) -> list[dict[str, Any]]:
    found = value.get(name, [])
    return [each for each in found if isinstance(each, dict)] if isinstance(found, list) else []


def _failed(path: Path, reason: str) -> InvalidArgumentError:
    return InvalidArgumentError(f"reading the decoder {path} failed: {reason}")
