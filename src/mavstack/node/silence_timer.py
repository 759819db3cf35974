"""The timer that ends an operation when its target falls silent.

An operation repeats its requests until it gives up, and a call may consist of several operations. If the
whole component is silent, its heartbeats included, each of them would wait without a result. The timer
therefore ends an operation when nothing of its target was received for `SILENCE_TIMEOUT` seconds, but never
within the first `GRACE_TIME` seconds of the operation, so that a component that is back is reached. An
operation whose caller gave a `timeout` is left alone, as is one whose target was never discovered.
"""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from types import TracebackType

    from mavstack.services import Address, Client, Operation
    from mavstack.services.heartbeat import ComponentInfo

#: Minimum seconds without a packet of the component, and after the beginning of the operation.
SILENCE_TIMEOUT: Final = 10.0
GRACE_TIME: Final = 1.5
#: Minimum seconds between two checks.
MIN_INTERVAL: Final = 0.1


class SilenceTimer:
    """Ends one operation if its target falls silent while a block lasts.

    Args:
        client: The client that runs the operation.
        operation: The operation.
        components: The discovered components.
        clock: Returns the time of the node, Unix seconds.
        on_expired: Called after the operation was ended.
    """

    def __init__(
        self,
        client: Client,
        operation: Operation[Any],
        components: Mapping[Address, ComponentInfo],
        clock: Callable[[], float],
        on_expired: Callable[[], None],
    ) -> None:
        self._client, self._operation = client, operation
        self._components, self._clock, self._on_expired = components, clock, on_expired
        self._begun_at = clock()
        self._handle: asyncio.TimerHandle | None = None

    def __enter__(self) -> None:
        if not self._operation.has_timeout:
            self._set()

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._handle is not None:
            self._handle.cancel()

    def _set(self) -> None:
        delay = max(self._due() - self._clock(), MIN_INTERVAL)
        self._handle = asyncio.get_running_loop().call_later(delay, self._check)

    def _due(self) -> float:
        """Return when the operation ends if nothing more is received."""
        info = self._components.get(self._client.target)
        if info is None:
            return self._clock() + SILENCE_TIMEOUT
        silence = info.last_seen + max(SILENCE_TIMEOUT, info.timeout)
        return max(silence, self._begun_at + GRACE_TIME)

    def _check(self) -> None:
        self._handle = None
        info, now = self._components.get(self._client.target), self._clock()
        if self._operation.done:
            return
        if info is not None and not info.alive and now >= self._due():
            self._client.time_out(self._operation, now, f"it fell silent {now - info.last_seen:.0f} s ago")
            self._begun_at = now  # a procedure may continue with another request
            self._on_expired()
        if not self._operation.done:
            self._set()
