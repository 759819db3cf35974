"""The response to a request that failed, made from the fields that its type has."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from mavstack.dialects import common
from mavstack.errors import ActionRefused, FileDenied, RemoteDenied, RemoteTimeout

if TYPE_CHECKING:
    from mavstack.bridges.core.types import Definition

_BOOLEANS: Final = ("success", "successful", "mode_sent")
_TEXTS: Final = ("message", "reason")
#: The `errno` values by MAVLink FTP error code.
_ERRNO: Final = {1: 5, 2: 5, 3: 22, 4: 9, 5: 24, 6: 0, 7: 38, 8: 17, 9: 13, 10: 2}
_EIO, _ETIMEDOUT = 5, 110


def refused(response: Definition, error: Exception) -> dict[str, Any]:
    """Return the fields of a response for a request that failed.

    Args:
        response: The definition of the response.
        error: The error.

    Returns:
        The fields: False, the MAV_RESULT, the number of errno and the text of the error, as far as the type
        has such fields. All others are 0 or empty.
    """
    names = {field.name for field in response.fields}
    found: dict[str, Any] = {name: False for name in _BOOLEANS if name in names}
    found |= {name: str(error) for name in _TEXTS if name in names}
    if "result" in names and "success" in names:
        found["result"] = result_of(error)
    if "r_errno" in names:
        found["r_errno"] = _errno(error)
    return found


def result_of(error: Exception) -> int:
    """Return the MAV_RESULT of an error: the result from the vehicle, or FAILED."""
    code = getattr(error, "code", None)
    if isinstance(error, RemoteDenied) and isinstance(code, int):
        return int(code)
    if isinstance(error, ActionRefused):
        return int(common.MavResult.TEMPORARILY_REJECTED)
    return int(common.MavResult.FAILED)


def _errno(error: Exception) -> int:
    if isinstance(error, FileDenied):
        return _ERRNO.get(int(error.code or 0), _EIO)
    return _ETIMEDOUT if isinstance(error, RemoteTimeout) else _EIO
