"""The bodies of requests: bounded, and JSON objects where JSON is expected."""

from __future__ import annotations

import json
from math import isfinite
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.types import Scope

#: The largest JSON body in bytes, unless a route allows a larger one.
MAX_BODY: Final = 1 << 16
#: The length of the longest 64-bit integer, digits and sign; a longer integer becomes a float.
_INTEGER_DIGITS: Final = 20


class RefusedError(Exception):
    """A request that is refused.

    Args:
        status: The status of the answer.
        problem: The reason, and what to do.
    """

    def __init__(self, status: int, problem: str) -> None:
        super().__init__(problem)
        self.status = status


def has_body(scope: Scope) -> bool:
    """Return whether a request has a body, by the fields of its head."""
    headers = dict(scope["headers"])
    return b"transfer-encoding" in headers or headers.get(b"content-length", b"0").strip(b" 0") != b""


async def read_bytes(request: Request, max_size: int = MAX_BODY) -> bytes:
    """Return the body of a request.

    Args:
        request: The request.
        max_size: The largest accepted number of bytes.

    Returns:
        The bytes.

    Raises:
        RefusedError: The body is larger.
    """
    data = bytearray()
    async for chunk in request.stream():
        data += chunk
        if len(data) > max_size:
            raise RefusedError(413, f"the request is larger than {max_size} bytes")
    return bytes(data)


async def read_json_object(request: Request, max_size: int = MAX_BODY) -> dict[str, Any]:
    """Return the JSON object in the body of a request.

    Args:
        request: The request.
        max_size: The largest accepted number of bytes.

    Returns:
        The members of the object.

    Raises:
        RefusedError: The body is larger, has another content type, or is not a JSON object.
    """
    if request.headers.get("content-type", "").partition(";")[0].strip().lower() != "application/json":
        raise RefusedError(415, "the request must be JSON (Content-Type: application/json)")
    values = parse_json(await read_bytes(request, max_size))
    if not isinstance(values, dict):
        raise RefusedError(400, "the request is not a JSON object")
    return values


def parse_json(data: bytes | str) -> object:
    """Return the value of a JSON text; None if it is not valid.

    NaN and infinities are not JSON. Numbers beyond the range of a float and halves of surrogate pairs are
    refused too: the first cannot be computed with, the second cannot be sent back in an answer.
    """
    try:
        value = json.loads(
            data, parse_constant=_refuse_constant, parse_float=_parse_number, parse_int=_parse_integer
        )
        json.dumps(value, ensure_ascii=False).encode()  # raises UnicodeEncodeError, a ValueError
    except (ValueError, RecursionError):
        return None
    return value


def _parse_number(text: str) -> float:
    value = float(text)
    if not isfinite(value):
        raise ValueError(text)
    return value


def _parse_integer(text: str) -> float:
    return int(text) if len(text) <= _INTEGER_DIGITS else _parse_number(text)


def _refuse_constant(word: str) -> object:
    raise ValueError(word)
