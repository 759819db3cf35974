"""Control streams: setpoints, manual control or channel overrides, repeated while a block runs.

    async with component.setpoints(rate=20) as stream:
        stream.set(LocalSetpoint(velocity=(1, 0, 0)))
        await asyncio.sleep(5)

The last value is repeated at the rate. Leaving the block releases control as the protocol requires.
"""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Generic, Protocol, TypeVar

from mavstack.node.api_object import ReadOnly

if TYPE_CHECKING:
    from types import TracebackType
    from typing import Self

    from mavstack.node.host import NodeHost
    from mavstack.services import Service

#: Seconds between two checks whether all repetitions of the release were sent.
RELEASE_INTERVAL = 0.1
Value_contra = TypeVar("Value_contra", contravariant=True)
ControlValue = TypeVar("ControlValue")


class Sender(Protocol[Value_contra]):
    """A service that repeats one value: a sender of setpoints, manual control or channel overrides."""

    @property
    def active(self) -> bool:
        """True until the release was sent as often as the protocol requires."""

    def set(self, value: Value_contra, now: float, /) -> None:
        """Repeat this value from now on."""

    def stop(self, now: float, /) -> None:
        """Release control, then send nothing more."""


class ControlStream(ReadOnly, Generic[ControlValue]):
    """A stream of one type of value to a remote component; an async context manager."""

    def __init__(self, host: NodeHost, sender: Sender[ControlValue], service: Service) -> None:
        self._host = host
        self._sender = sender
        self._service = service

    def set(self, value: ControlValue) -> None:
        """Send a value, and repeat it until the next one.

        Args:
            value: The setpoint, stick positions or channel values.

        Raises:
            InvalidStateError: The node is closed.
            SystemIdConflictError: Several vehicles use its system id, and none was chosen.
        """
        if error := self._host.refusal_of(self._service.source_filter, "steering"):
            raise error
        self._sender.set(value, self._host.now())
        self._host.wake(self._service)

    def stop(self) -> None:
        """Release control; the next `set` takes control again."""
        self._sender.stop(self._host.now())
        self._host.wake(self._service)

    async def _release(self) -> None:
        self.stop()
        # The release is repeated by timers, and no event reports the end of the repetitions.
        while self._sender.active and self._host.is_open:  # noqa: ASYNC110
            await asyncio.sleep(RELEASE_INTERVAL)

    async def __aenter__(self) -> Self:
        self._host.serve(self._service)
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            if self._host.is_open:
                await self._release()
        finally:
            self._host.remove(self._service)
