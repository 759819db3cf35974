"""Why a vehicle refused: the texts that it told people meanwhile, put into the error that a program gets.

Firmwares acknowledge a refusal with a bare MAV_RESULT and say the reason by STATUSTEXT, ArduPilot before the
acknowledgement and PX4 on either side of it. So what is asked for is asked while its texts are collected, and
a refusal waits a moment for those that come after it. Whatever else fails, a parameter or a file, takes along
what was told until then; see `Connection`.
"""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING, TypeVar

from mavstack.dialects import common
from mavstack.errors import RemoteDenied, RemoteError
from mavstack.services.statustext import StatusText

if TYPE_CHECKING:
    from collections.abc import Coroutine, Iterable
    from types import TracebackType
    from typing import Any, Self

    from mavstack.vehicle.telemetry.values import StatusText
    from mavstack.vehicle.vehicle import Vehicle

Result = TypeVar("Result")

#: How long the reason of a refusal may come after it, in seconds; a slow link takes longer.
AFTERWARDS = 0.6
#: Several reasons are told one after the other within so many seconds.
TOGETHER = 0.1
#: Texts that matter less are not reasons.
LEAST_SEVERITY = common.MavSeverity.WARNING
MOST_TEXTS = 6


class StatusTextCapture:
    """Collects what a vehicle tells people while a block lasts."""

    def __init__(self, vehicle: Vehicle) -> None:
        self._vehicle = vehicle
        self._texts = vehicle.connection.events(StatusText)
        self._warnings: dict[str, None] = {}

    @property
    def warnings(self) -> tuple[str, ...]:
        """What was told that may be a reason, each text once, the last ones."""
        for text in self._texts.drain():
            if text.source.system == self._vehicle.system and text.severity <= LEAST_SEVERITY:
                self._warnings.pop(text.text, None)
                self._warnings[text.text] = None
        while len(self._warnings) > MOST_TEXTS:
            del self._warnings[next(iter(self._warnings))]
        return tuple(self._warnings)

    async def wait_for_warning(self, seconds: float) -> None:
        """Wait for a text that may be a reason, if there is none yet."""
        if self.warnings:
            return
        with suppress(TimeoutError):
            async with asyncio.timeout(seconds):
                while not self.warnings:
                    if not await self._texts.wait():
                        return
            await asyncio.sleep(TOGETHER)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Listen no more. Closing twice does nothing."""
        self._texts.close()


def attach_status_texts(error: RemoteError, texts: Iterable[StatusText]) -> None:
    """Put those texts that may be reasons into an error, unless it has some."""
    reasons = [text.text for text in texts if text.severity <= LEAST_SEVERITY]
    error.status_texts = error.status_texts or tuple(dict.fromkeys(reversed(reasons)))[MOST_TEXTS - 1 :: -1]


async def with_status_texts(vehicle: Vehicle, asked: Coroutine[Any, Any, Result]) -> Result:
    """Wait for what was asked; an error that it ends with tells what the vehicle said meanwhile."""
    with StatusTextCapture(vehicle) as heard:
        try:
            return await asked
        except RemoteError as error:
            if isinstance(error, RemoteDenied):
                await heard.wait_for_warning(AFTERWARDS)
            error.status_texts = error.status_texts or heard.warnings
            raise
