"""A conversation with a bootloader, sans-IO: requests of a generator, replies that end with a status.

The generator yields a `Request` and gets the bytes of its reply; a refusal or a timeout is raised where it
waits. Bytes that arrive while nothing is awaited belong to an earlier conversation, and are dropped.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, Generic, TypeAlias, TypeVar

from mavstack.errors import InvalidStateError
from mavstack.flashing.failures import BootloaderError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

INSYNC, OK, FAILED, INVALID, BAD_SILICON = 0x12, 0x10, 0x11, 0x13, 0x14
#: Size of a status in bytes: INSYNC and the result.
STATUS_SIZE: Final = 2
_TEXTS: Final[Mapping[int, str]] = MappingProxyType(
    {
        FAILED: "FAILED",
        INVALID: "INVALID",
        BAD_SILICON: "its chip has a fault, and cannot be programmed",
    }
)
#: Seconds to wait for the reply to a request.
REPLY_TIMEOUT: Final = 2.0

T = TypeVar("T")


def fixed(size: int) -> Callable[[bytes], int | None]:
    """Return a function that finds the end of a reply of so many bytes before its status."""
    whole = size + STATUS_SIZE
    return lambda data: whole if len(data) >= whole else None


def refusable(size: int) -> Callable[[bytes], int | None]:
    """Return `fixed(size)` for a request that old bootloaders refuse; its reply never looks like that."""
    refusal = bytes((INSYNC, INVALID))
    return lambda data: STATUS_SIZE if data == refusal else fixed(size)(data)


def counted(data: bytes) -> int | None:
    """Return the size of a text whose length comes first, in 32 bits; None while it is not complete."""
    size = int.from_bytes(data[:4], "little") if len(data) >= 4 else None
    return None if size is None else fixed(4 + min(size, 255))(data)


STATUS_ONLY: Final = fixed(0)


@dataclass(frozen=True, slots=True)
class Request:
    """A request to a bootloader.

    Attributes:
        data: Its bytes.
        operation: The operation for errors, such as "erasing".
        size: Returns the bytes of a complete reply, its status included; None while bytes are missing.
        timeout: Seconds for the reply.
    """

    data: bytes
    operation: str
    size: Callable[[bytes], int | None] = STATUS_ONLY
    timeout: float = REPLY_TIMEOUT


Steps: TypeAlias = Generator[Request, bytes, T]


class Conversation(Generic[T]):
    """The program's side of a conversation.

    Args:
        steps: The requests.
        now: Seconds of any clock.
    """

    def __init__(self, steps: Steps[T], now: float) -> None:
        self._steps = steps
        self._buffer = bytearray()
        self._to_send: list[bytes] = []
        self._request: Request | None = None
        self._deadline: float | None = None
        self._result: T | None = None
        self._error: BootloaderError | None = None
        self.done = False
        self._resume(lambda: next(steps), now)

    def receive(self, data: bytes, now: float) -> None:
        """Process bytes of the bootloader."""
        request = self._request
        if request is None:
            return
        self._buffer += data
        size = request.size(bytes(self._buffer))
        if size is None:
            return
        reply = bytes(self._buffer[:size])
        error = _error_of(reply, request)
        if error is None:
            self._resume(lambda: self._steps.send(reply[:-STATUS_SIZE]), now)
        else:
            self._fail(error, now)

    def data_to_send(self) -> bytes:
        """Return the bytes for the bootloader, once."""
        data = b"".join(self._to_send)
        self._to_send.clear()
        return data

    def next_timeout(self) -> float | None:
        """Return the time at which the present request fails; None at the end."""
        return self._deadline

    def handle_timeout(self, now: float) -> None:
        """Fail the present request if its time is over."""
        if self._request is None or self._deadline is None or now < self._deadline:
            return
        refusal = self._buffer[:STATUS_SIZE]
        if len(refusal) == STATUS_SIZE and refusal[0] == INSYNC and refusal[1] in _TEXTS:
            self._fail(_refused(self._request, refusal[1]), now)
        else:
            text = f"{self._request.operation} failed: the bootloader does not answer"
            self._fail(BootloaderError(text), now)

    def result(self) -> T:
        """Return the result of the generator, or raise its error."""
        if self._error is not None:
            raise self._error
        if not self.done:
            raise InvalidStateError("the conversation has not ended yet")
        return self._result  # type: ignore[return-value]

    def _fail(self, error: BootloaderError, now: float) -> None:
        self._resume(lambda: self._steps.throw(error), now)

    def _resume(self, step: Callable[[], Request], now: float) -> None:
        self._buffer.clear()
        try:
            request = step()
        except StopIteration as end:
            self._end()
            self._result = end.value
        except BootloaderError as error:
            self._end()
            self._error = error
        else:
            self._request, self._deadline = request, now + request.timeout
            self._to_send.append(request.data)

    def _end(self) -> None:
        self.done, self._request, self._deadline = True, None, None


def _error_of(reply: bytes, request: Request) -> BootloaderError | None:
    mark, status = reply[-STATUS_SIZE:]
    if mark == INSYNC and status == OK:
        return None
    if mark == INSYNC and status in _TEXTS:
        return _refused(request, status)
    return BootloaderError(f"{request.operation} failed: the answer {reply[-16:].hex(' ')} is not one", -1)


def _refused(request: Request, status: int) -> BootloaderError:
    return BootloaderError(f"{request.operation} failed: {_TEXTS[status]}, says the bootloader", status)
