"""The rates at which a component was asked to send its messages: remembered, and asked for again.

A vehicle forgets what it was asked for when it restarts, and some when their link was gone. So each rate is
held as long as somebody wants it, the highest of a message counts, and a task asks again

- for all of them when the component rebooted or returned;
- for one that is silent though the component is alive, since a vehicle that sends nothing but heartbeats does
  not show that it rebooted; each time it waits twice as long.

What was refused is not asked for again before a reboot or return. When nobody wants a rate any more the
component is told to send the message as it would by itself.
"""

from __future__ import annotations

import asyncio
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from mavstack.errors import CommandDenied, MavstackError
from mavstack.services.heartbeat import ComponentRebooted, ComponentReturned
from mavstack.services.message_request import DEFAULT, Interval
from mavstack.services.message_request.interval import name_of

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine, Mapping

    from mavstack.dialects import Message
    from mavstack.node import RemoteComponent
    from mavstack.node.subscription import Subscription

    Kind = type[Message]

#: How often to look whether what was asked for comes, in seconds.
LOOK = 5.0
#: Silent is what did not come for so many of its intervals, and not for `LOOK` either.
INTERVALS = 5.0
#: The longest that is waited before a silent message is asked for again.
LONGEST_WAIT = 60.0


@dataclass(eq=False, slots=True)
class RateRequest:
    """Somebody's wish to have a message at a rate, in hertz."""

    kind: Kind
    rate: float


@dataclass(eq=False, slots=True)
class _Wanted:
    """All wishes for one message, and what became of them."""

    kind: Kind
    holds: list[RateRequest] = field(default_factory=list)
    asked: float | None = None
    denied: CommandDenied | None = None
    again_at: float = 0.0
    wait: float = LOOK
    asking: asyncio.Lock = field(default_factory=asyncio.Lock)

    @property
    def rate(self) -> float:
        return max(hold.rate for hold in self.holds)


class Rates:
    """The rates of one component; `age` says how long ago a message came."""

    def __init__(self, component: RemoteComponent, age: Callable[[Kind], float | None]) -> None:
        self._component = component
        self._age = age
        self._wanted: dict[int, _Wanted] = {}
        self._tasks: set[asyncio.Task[None]] = set()
        self._watching: asyncio.Task[None] | None = None

    @property
    def held(self) -> Mapping[Kind, float]:
        """What is wanted now, in hertz."""
        return {wanted.kind: wanted.rate for wanted in self._wanted.values()}

    def denied(self, kind: Kind) -> CommandDenied | None:
        """The refusal of a message's rate, if it was refused."""
        wanted = self._wanted.get(_id(kind))
        return None if wanted is None else wanted.denied

    def hold(self, kind: Kind, rate: float) -> RateRequest:
        """Want a message at a rate from now on; `ask` says so to the component."""
        Interval.hertz(rate)  # raises for what is no rate
        hold = RateRequest(kind, rate)
        self._wanted.setdefault(_id(kind), _Wanted(kind)).holds.append(hold)
        if self._watching is None or self._watching.done():
            self._watching = self._begin(self._watch())
        return hold

    def release(self, hold: RateRequest) -> None:
        """Want it no more. Releasing twice does nothing."""
        wanted = self._wanted.get(_id(hold.kind))
        if wanted is None or hold not in wanted.holds:
            return
        wanted.holds.remove(hold)
        if not wanted.holds:
            del self._wanted[_id(hold.kind)]
        if wanted.asked is not None and self._component.node.is_open:
            self._begin(self._fall_back(wanted))

    async def ask(self, kind: Kind) -> None:
        """Ask for a message's rate, unless it was asked for; raises `CommandDenied` or `CommandTimeout`."""
        wanted = self._wanted.get(_id(kind))
        if wanted is None:
            return
        async with wanted.asking:
            if wanted.denied is not None:
                raise wanted.denied
            if wanted.holds and wanted.asked != wanted.rate:
                await self._ask(wanted)

    async def ensure(self, kind: Kind, rate: float) -> bool:
        """Have a message come at least about so often for good; False if the component refused or is silent.

        Nothing is asked for while it comes, and a wish like this is remembered once.
        """
        age = self._age(kind)
        if self.held.get(kind, 0.0) < rate:
            self.hold(kind, rate)
        if age is not None and age <= 2.0 / rate:
            return True
        try:
            await self.ask(kind)
        except MavstackError:
            return False
        return True

    async def close(self) -> None:
        """Ask for nothing more."""
        tasks = tuple(self._tasks)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    async def _ask(self, wanted: _Wanted) -> None:
        rate = wanted.rate
        now = self._component.node.now()
        wanted.again_at = now + max(wanted.wait, INTERVALS / rate)
        wanted.asked = rate  # cancelled, it may have been asked for
        try:
            await self._component.set_message_rate(wanted.kind, rate)
        except CommandDenied as error:
            wanted.asked, wanted.denied = None, _named(error, wanted.kind, rate)
            raise wanted.denied from error
        except MavstackError:
            wanted.asked = None
            raise

    async def _fall_back(self, wanted: _Wanted) -> None:
        """Ask for what is left after somebody let go."""
        with suppress(MavstackError):
            if _id(wanted.kind) in self._wanted:
                await self.ask(wanted.kind)
            elif wanted.asked is not None:
                wanted.asked = None
                await self._component.set_message_rate(wanted.kind, DEFAULT)

    async def _watch(self) -> None:
        node = self._component.node
        async with node.events(ComponentRebooted, ComponentReturned) as events:
            while self._wanted:
                try:
                    async with asyncio.timeout(LOOK):
                        if not await self._lost(events):
                            return
                except TimeoutError:
                    await self._ask_for_silent()
                    continue
                for wanted in self._wanted.values():
                    wanted.asked = wanted.denied = None
                    wanted.wait = LOOK
                await self._ask_each(list(self._wanted.values()))

    async def _lost(self, events: Subscription[Any]) -> bool:
        """Wait until the component may have forgotten; False if the node closed."""
        async for event in events:
            if event.component.address == self._component.address:
                return True
        return False

    async def _ask_for_silent(self) -> None:
        info = self._component.info
        if info is None or not info.alive or not self._component.node.is_open:
            return
        now = self._component.node.now()
        silent = []
        for wanted in self._wanted.values():
            age = self._age(wanted.kind)
            if age is not None and age <= max(LOOK, INTERVALS / wanted.rate):
                wanted.wait = LOOK
            elif wanted.denied is None and now >= wanted.again_at:
                wanted.asked = None
                wanted.wait = min(2 * wanted.wait, LONGEST_WAIT)
                silent.append(wanted)
        await self._ask_each(silent)

    async def _ask_each(self, all_wanted: list[_Wanted]) -> None:
        for wanted in all_wanted:
            with suppress(MavstackError):
                await self.ask(wanted.kind)

    def _begin(self, work: Coroutine[Any, Any, None]) -> asyncio.Task[None]:
        task = asyncio.get_running_loop().create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)
        return task


def _named(error: CommandDenied, kind: Kind, rate: float) -> CommandDenied:
    """The refusal, saying of which message."""
    what = f"{name_of(kind)} at {rate:g} Hz"
    named = CommandDenied(what, error.target, attempts=error.attempts, answer=error.answer, code=error.code)
    named.detail, named.status_texts = error.detail, error.status_texts
    return named


def _id(kind: Kind) -> int:
    return int(kind.__mavlink_row__[0])
