"""The order in which an HTTP server begins the requests that have arrived.

A request costs a millisecond of processor time or more. If hundreds arrive at once, the event loop would
begin all of them before it returns to a request that came later, such as a pilot's. In the lane they begin
one after the other, one in each turn of the event loop. A request that comes first waits for none of them.
"""

from __future__ import annotations

import asyncio
import re
from collections import deque
from typing import TYPE_CHECKING, Final, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import TypeAlias

#: The largest head of a request in bytes; the server refuses a larger one.
MAX_HEAD: Final = 1 << 16
_END: Final = re.compile(rb"\n\r?\n")
_FIELD: Final = re.compile(rb"\n(authorization|cookie)[ \t]*:[ \t]*([^\r\n]*)", re.IGNORECASE)


class RequestHead(NamedTuple):
    """The part of a request's head that says whose request it is: empty texts for missing fields."""

    method: str
    authorization: str
    cookie: str


#: Decides by the head of a request whether it is handled before others.
ComesFirst: TypeAlias = "Callable[[RequestHead], bool]"


def has_whole_head(data: bytes | bytearray, start: int = 0) -> bool:
    """Return whether the head of a request is complete, or longer than any head may be.

    Args:
        data: The bytes of the request so far, without empty lines before it.
        start: The number of bytes of an earlier look.
    """
    return len(data) > MAX_HEAD or _END.search(data, max(0, start - 2)) is not None


def read_head(data: bytes | bytearray) -> RequestHead:
    """Return the head of a request."""
    end = _END.search(data)
    head = bytes(data[: MAX_HEAD if end is None else end.end()])
    fields = {name.lower(): value.strip().decode("latin-1") for name, value in _FIELD.findall(head)}
    method = head.partition(b" ")[0][:16].decode("latin-1")
    return RequestHead(method, fields.get(b"authorization", ""), fields.get(b"cookie", ""))


class RequestLane:
    """The requests of one server that have arrived and not begun."""

    def __init__(self) -> None:
        self._waiting: deque[Callable[[], None]] = deque()
        self._is_running = False

    def enter(self, begin: Callable[[], None]) -> None:
        """Call a function when its turn has come, after this call returns."""
        self._waiting.append(begin)
        if not self._is_running:
            self._is_running = True
            asyncio.get_running_loop().call_soon(self._run)

    async def turn(self) -> None:
        """Wait for a turn."""
        came = asyncio.get_running_loop().create_future()
        self.enter(lambda: None if came.done() else came.set_result(None))
        await came

    def _run(self) -> None:
        begin = self._waiting.popleft()
        self._is_running = bool(self._waiting)
        if self._is_running:
            asyncio.get_running_loop().call_soon(self._run)
        begin()
