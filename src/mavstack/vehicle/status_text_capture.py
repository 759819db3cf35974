"""The status texts that a vehicle sends during an operation, attached to the operation's error.

Firmwares acknowledge a refusal with a bare MAV_RESULT and send the reason as STATUSTEXT, ArduPilot before the
acknowledgement and PX4 before or after it. So the texts are collected while the operation runs, and after a
refusal for a moment more. Errors of other operations, of parameters or files, get the texts that arrived
until then; see `Connection`.
"""

from __future__ import annotations

import asyncio
from contextlib import closing, suppress
from typing import TYPE_CHECKING, Final, TypeVar

from mavstack.dialects import common
from mavstack.errors import ModeTimeout, RemoteDenied, RemoteError
from mavstack.services.statustext import StatusText
from mavstack.vehicle.event_capture import EventCapture

if TYPE_CHECKING:
    from collections.abc import Coroutine, Iterable
    from types import TracebackType
    from typing import Any, Self

    from mavstack.vehicle.telemetry import values
    from mavstack.vehicle.vehicle import Vehicle

Result = TypeVar("Result")

#: The time after a refusal in which its reason may arrive, in seconds.
REASON_TIMEOUT = 0.6
#: The time in which all texts of one reason arrive, in seconds.
REASON_SPAN = 0.1
#: The severity from which a text is a reason. A less severe text is a reason only if it arrives before a
#: refusal without a warning: ArduPilot explains by a text of severity INFO why a servo output cannot be set.
MIN_SEVERITY = common.MavSeverity.WARNING
MAX_TEXTS = 6
#: Warnings without a reason: ArduRover sends the reason before them, in a less severe text.
_WITHOUT_REASON: Final = frozenset({"Flight mode change failed"})


class StatusTextCapture:
    """Collects the status texts of a vehicle while a block lasts."""

    def __init__(self, vehicle: Vehicle) -> None:
        self._vehicle = vehicle
        self._texts = vehicle.connection.events(StatusText)
        self._warnings: dict[str, None] = {}
        self._remarks: dict[str, None] = {}

    @property
    def warnings(self) -> tuple[str, ...]:
        """The last texts of severity WARNING and above, each once, oldest first."""
        self._collect()
        return tuple(self._warnings)

    @property
    def remarks(self) -> tuple[str, ...]:
        """The last texts of severity NOTICE and INFO, each once, oldest first."""
        self._collect()
        return tuple(self._remarks)

    def _collect(self) -> None:
        for text in self._texts.drain():
            if text.source.system == self._vehicle.system and text.severity <= common.MavSeverity.INFO:
                texts = self._warnings if text.severity <= MIN_SEVERITY else self._remarks
                texts.pop(text.text, None)
                texts[text.text] = None
                if len(texts) > MAX_TEXTS:
                    del texts[next(iter(texts))]

    async def wait_for_warning(self, timeout: float) -> None:
        """Wait for a warning for `timeout` seconds, unless there is one."""
        if self.warnings:
            return
        with suppress(TimeoutError):
            async with asyncio.timeout(timeout):
                while not self.warnings:
                    if not await self._texts.wait():
                        return
            await asyncio.sleep(REASON_SPAN)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Stop collecting. Idempotent."""
        self._texts.close()


def attach_status_texts(error: RemoteError, texts: Iterable[values.StatusText]) -> None:
    """Attach the warnings among some texts to an error, unless it has texts."""
    warnings = [text.text for text in texts if text.severity <= MIN_SEVERITY]
    error.status_texts = error.status_texts or tuple(dict.fromkeys(reversed(warnings)))[MAX_TEXTS - 1 :: -1]


async def with_status_texts(
    vehicle: Vehicle, operation: Coroutine[Any, Any, Result], name: str = ""
) -> Result:
    """Await an operation; attach the vehicle's warnings, or the reasons of a refusal, to its error.

    Args:
        vehicle: The vehicle.
        operation: The operation.
        name: The name of the action in the error, if the operation is all of it; empty: its own name.

    Returns:
        The result of the operation.
    """
    with StatusTextCapture(vehicle) as capture, closing(EventCapture(vehicle.component)) as events:
        try:
            return await operation
        except RemoteError as error:
            remarks = capture.remarks if isinstance(error, RemoteDenied | ModeTimeout) else ()
            if isinstance(error, RemoteDenied):
                await capture.wait_for_warning(REASON_TIMEOUT)
            error.status_texts = _reasons(remarks, error.status_texts or capture.warnings)
            error.events = error.events or events.take()
            if name:
                error.rename(name)
            raise


def _reasons(remarks: tuple[str, ...], warnings: tuple[str, ...]) -> tuple[str, ...]:
    """Return the texts that give the reason; some warnings say only that the request failed."""
    if _WITHOUT_REASON.issuperset(warnings):
        return (*(text for text in remarks if text not in warnings), *warnings)
    return warnings
