"""A stream of one vehicle's messages, and seeing to it that they come.

    begun ── rate given ─────────────────────────────────► asked
      └── no rate: PATIENCE ── some came ─► done
                     └── none came ─► asked at the usual rate
    asked ── accepted ─► done
      └── refused: GRACE ── some came anyhow ─► done
                     └── none came ─► the stream raises the refusal

What a stream asked for with a rate it lets go when it ends; a usual rate stays, since whoever reads a message
once will want its latest value too. Of several kinds one may be refused while others come: `denied` tells.
"""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Generic, TypeVar

from mavstack.dialects import Message
from mavstack.errors import CommandDenied, LocalProtocolError, MavstackError, RemoteError
from mavstack.vehicle.telemetry.periodic import is_periodic

if TYPE_CHECKING:
    from types import TracebackType
    from typing import Any, Self

    from mavstack.node.subscription import Subscription
    from mavstack.vehicle.telemetry.rates import RateRequest
    from mavstack.vehicle.telemetry.telemetry import Telemetry

AnyMessage = TypeVar("AnyMessage", bound=Message)

#: The rate asked for where none is given, in hertz.
USUAL_RATE = 4.0
#: How long to wait for what may come by itself, in seconds.
PATIENCE = 1.5
#: How long after a refusal the message may come anyhow; and for so long what was heard before counts.
GRACE = 4.0


class Stream(Generic[AnyMessage]):
    """Iterate over it; `async with` ends it with the block, and so does forgetting it."""

    def __init__(
        self, telemetry: Telemetry, kinds: tuple[type[AnyMessage], ...], rate: float | None, queue: int
    ) -> None:
        if rate is not None and not kinds:
            raise LocalProtocolError("a rate is asked for of messages that are named")
        messages = telemetry.component.stream(*kinds, queue=queue)
        self._supply = _Supply(telemetry, kinds, rate, messages)
        self._messages = messages

    @property
    def dropped(self) -> int:
        """How many were lost because they were not read in time."""
        return self._messages.dropped

    @property
    def denied(self) -> dict[type[Message], CommandDenied]:
        """Which of the kinds the vehicle refused to send at the rate asked for."""
        return dict(self._supply.denied)

    def take(self) -> list[AnyMessage]:
        """All that has come and was not read, without waiting."""
        return self._messages.drain()

    def close(self) -> None:
        """Listen no more, and want no rate. Closing twice does nothing."""
        self._supply.end()

    def __aiter__(self) -> Self:
        return self

    async def __anext__(self) -> AnyMessage:
        supply = self._supply
        if not supply.begun:
            supply.begin()
        try:
            return await self._messages.__anext__()
        except StopAsyncIteration:
            if supply.error is None:
                raise
        raise supply.error

    async def __aenter__(self) -> Self:
        if not self._supply.begun:
            self._supply.begin()
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __del__(self) -> None:
        supply = self.__dict__.get("_supply")
        if supply is not None:
            supply.forgotten()


class _Supply:
    """Sees to it that the messages come. It does not know its stream, so that this can be forgotten."""

    def __init__(
        self,
        telemetry: Telemetry,
        kinds: tuple[type[Message], ...],
        rate: float | None,
        messages: Subscription[Any],
    ) -> None:
        self._telemetry, self._kinds, self._rate, self._messages = telemetry, kinds, rate, messages
        self._holds: list[RateRequest] = []
        self._task: asyncio.Task[None] | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self._since = 0.0
        self.denied: dict[type[Message], CommandDenied] = {}
        self.error: MavstackError | None = None
        self.begun = False

    def begin(self) -> None:
        """Wait for the messages, and ask for them if need be."""
        self.begun = True
        if not self._kinds or self._messages.closed:
            return
        self._since = self._telemetry.node.now() - GRACE
        if self._rate is not None:
            self._holds = [self._telemetry.rates.hold(kind, self._rate) for kind in self._kinds]
        self._loop = asyncio.get_running_loop()
        self._task = self._loop.create_task(self._supply())

    def end(self) -> None:
        """Nobody reads it any more."""
        self._messages.close()
        if self._task is not None:
            self._task.cancel()
        holds, self._holds = self._holds, []
        for hold in holds:
            self._telemetry.rates.release(hold)

    def forgotten(self) -> None:
        """The same, from wherever the collector runs."""
        if self._loop is None:
            self._messages.close()
        elif not self._loop.is_closed() and (self._holds or not self._messages.closed):
            self._loop.call_soon_threadsafe(self.end)

    async def _supply(self) -> None:
        try:
            await self._ask()
        except MavstackError as error:
            if not self._messages.closed:
                self._fail(error)

    async def _ask(self) -> None:
        kinds = self._kinds
        if self._rate is None:
            await asyncio.sleep(PATIENCE)
            kinds = tuple(kind for kind in kinds if is_periodic(kind) and not self._came(kind))
        for kind in kinds:
            await self._ask_for(kind)
        if self.denied:
            await asyncio.sleep(GRACE)
            if not any(map(self._came, self._kinds)):
                self._fail(next(iter(self.denied.values())))

    async def _ask_for(self, kind: type[Message]) -> None:
        rates = self._telemetry.rates
        if self._rate is None and kind not in rates.held:
            rates.hold(kind, USUAL_RATE)
        try:
            await rates.ask(kind)
        except CommandDenied as error:
            self.denied[kind] = error
        except RemoteError:
            return  # no answer yet: `Rates` goes on asking while the vehicle is alive

    def _came(self, kind: type[Message]) -> bool:
        heard_at = self._telemetry.heard_at(kind)
        return heard_at is not None and heard_at >= self._since

    def _fail(self, error: MavstackError) -> None:
        self.error = error
        self._messages.close()
