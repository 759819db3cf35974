"""Steering a vehicle by streams: setpoints, sticks, channels, for as long as a block lasts.

    async with vehicle.setpoints(rate=20) as stream:
        stream.set(LocalSetpoint(velocity=(1, 0, 0)))
        await asyncio.sleep(5)

The newest value is repeated at the rate; leaving the block lets go, as the vehicle's firmware wants it told.
"""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Generic, Protocol, TypeVar

if TYPE_CHECKING:
    from types import TracebackType
    from typing import Self

    from mavstack.node.node import Node
    from mavstack.services import Service

LETTING_GO = 0.1
Value_contra = TypeVar("Value_contra", contravariant=True)
Sent = TypeVar("Sent")


class Sender(Protocol[Value_contra]):
    """What sends a stream: a service of `setpoints` or `manual_control`."""

    @property
    def active(self) -> bool:
        """Whether it still sends."""

    def set(self, value: Value_contra, now: float, /) -> None:
        """Send this from now on."""

    def stop(self, now: float, /) -> None:
        """Let go, then send nothing more."""


class ControlStream(Generic[Sent]):
    """A stream of one kind of value to one vehicle."""

    def __init__(self, node: Node, sender: Sender[Sent], service: Service) -> None:
        self._node = node
        self._sender = sender
        self._service = service

    def set(self, value: Sent) -> None:
        """Send this value, again and again, until the next one."""
        self._sender.set(value, self._node.now())
        self._node.wake(self._service)

    def stop(self) -> None:
        """Let go."""
        self._sender.stop(self._node.now())
        self._node.wake(self._service)

    async def _let_go(self) -> None:
        self.stop()
        while self._sender.active and self._node.is_open:  # noqa: ASYNC110 (it lets go more than once, by timers)
            await asyncio.sleep(LETTING_GO)

    async def __aenter__(self) -> Self:
        self._node.serve(self._service)
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            if self._node.is_open:
                await self._let_go()
        finally:
            self._node.engine.remove(self._service)
