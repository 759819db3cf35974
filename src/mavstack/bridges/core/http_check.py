"""Requests of `mav bridge check` by HTTP, in a thread."""

from __future__ import annotations

import asyncio
from functools import partial
from http.client import HTTPException
from typing import Final
from urllib.error import HTTPError, URLError
from urllib.request import Request, urlopen

from mavstack.errors import LinkError

#: Seconds in which a server must answer.
ANSWER_TIMEOUT: Final = 5.0
#: Maximum size of an answer in bytes.
MAX_ANSWER: Final = 32 << 20


async def ask(url: str, data: bytes | None = None, content: str = "") -> tuple[int, bytes]:
    """Return the status and the body of an answer.

    Args:
        url: The URL, of HTTP.
        data: The body of a POST; None: a GET.
        content: The type of the body.

    Raises:
        LinkError: Nothing answers there, or its answer is not HTTP.
    """
    headers = {"Content-Type": content} if content else {}
    request = Request(url, data, headers)  # noqa: S310 (the caller has checked the scheme)
    return await asyncio.get_running_loop().run_in_executor(None, partial(_send, request))


def _send(request: Request) -> tuple[int, bytes]:
    try:
        with urlopen(request, timeout=ANSWER_TIMEOUT) as answer:  # noqa: S310 (as above)
            return answer.status, answer.read(MAX_ANSWER)
    except HTTPError as error:
        return error.code, b""
    except HTTPException:
        raise LinkError(f"asking {request.full_url} failed: no HTTP server answers there") from None
    except (URLError, OSError, ValueError) as error:
        reason = getattr(error, "reason", error)
        raise LinkError(
            f"asking {request.full_url} failed: {getattr(reason, 'strerror', None) or reason}"
        ) from None
