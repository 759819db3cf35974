"""The message rates requested from a component, remembered and requested again.

A component forgets the requested rates when it reboots, and some forget them when their link was gone. So
each rate is kept as long as a `RateRequest` holds it, the highest rate of a message counts, and a task
requests again

- all rates when the component rebooted or returned;
- the rate of a message that stays out though the component is alive, since a component that sends nothing
  but heartbeats does not show that it rebooted; each retry waits twice as long as the one before.

A refused rate is not requested again before a reboot or a return. When the last request of a message is
released, the default rate of the component is requested.
"""

from __future__ import annotations

import asyncio
import logging
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from mavstack.errors import CommandDenied, MavstackError
from mavstack.node.api_object import LoopBound
from mavstack.services.heartbeat import ComponentRebooted, ComponentReturned
from mavstack.services.message_request import DEFAULT, Interval
from mavstack.services.message_request.interval import name_of

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine, Mapping

    from mavstack.dialects import Message
    from mavstack.node import Node, RemoteComponent
    from mavstack.node.subscription import Subscription

    MessageClass = type[Message]

#: The interval at which missing messages are searched for, in seconds.
CHECK_INTERVAL = 5.0
#: A message is missing after this many of its intervals, and not before `CHECK_INTERVAL`.
MISSING_INTERVALS = 5.0
#: The longest time between two requests for a missing message, in seconds.
MAX_RETRY_INTERVAL = 60.0

logger = logging.getLogger("mavstack.vehicle")


@dataclass(eq=False, slots=True)
class RateRequest:
    """A request for a message at a rate in hertz, valid until it is released."""

    message: MessageClass
    rate: float


@dataclass(eq=False, slots=True)
class _MessageRate:
    """All requests for one message, and the state of asking the component for them."""

    message: MessageClass
    requests: list[RateRequest] = field(default_factory=list)
    asked: float | None = None
    denied: CommandDenied | None = None
    retry_at: float = 0.0
    retry_interval: float = CHECK_INTERVAL
    lock: asyncio.Lock = field(default_factory=asyncio.Lock)

    @property
    def rate(self) -> float:
        return max(request.rate for request in self.requests)


class Rates(LoopBound):
    """The requested message rates of one component; `age` returns the seconds since a message arrived."""

    def __init__(
        self, node: Node, component: RemoteComponent, age: Callable[[MessageClass], float | None]
    ) -> None:
        self._node = node
        self._component = component
        self._age = age
        self._rates: dict[int, _MessageRate] = {}
        self._permanent: dict[int, RateRequest] = {}
        self._tasks: set[asyncio.Task[None]] = set()
        self._watching: asyncio.Task[None] | None = None

    @property
    def held(self) -> Mapping[MessageClass, float]:
        """The rates that are requested now, in hertz, by message class."""
        return {entry.message: entry.rate for entry in self._rates.values()}

    def denied(self, message: MessageClass) -> CommandDenied | None:
        """Return the refusal of a message's rate; None if it was not refused."""
        entry = self._rates.get(_id(message))
        return None if entry is None else entry.denied

    def hold(self, message: MessageClass, rate: float) -> RateRequest:
        """Keep a rate in hertz from now on; `ask` sends it to the component."""
        Interval.hertz(rate)  # raises for a number that is not a rate
        request = RateRequest(message, rate)
        self._rates.setdefault(_id(message), _MessageRate(message)).requests.append(request)
        if self._watching is None or self._watching.done():
            self._watching = self._begin(self._watch())
        return request

    def set_permanently(self, message: MessageClass, rate: float | None) -> None:
        """Hold a rate in place of the one that was set for the message before; None: hold none."""
        number = _id(message)
        before = self._permanent.pop(number, None)
        if rate is not None:
            self._permanent[number] = self.hold(message, rate)
        if before is not None:
            self.release(before)

    def release(self, request: RateRequest) -> None:
        """Keep a rate no longer. Idempotent."""
        entry = self._rates.get(_id(request.message))
        if entry is None or request not in entry.requests:
            return
        entry.requests.remove(request)
        if not entry.requests:
            del self._rates[_id(request.message)]
        if entry.asked is not None and self._node.is_open:
            self._begin(self._fall_back(entry))

    async def ask(self, message: MessageClass) -> None:
        """Ask the component for the rate of a message, unless it was asked already.

        Raises:
            CommandDenied: The component refused, now or before.
            CommandTimeout: The component did not answer.
        """
        entry = self._rates.get(_id(message))
        if entry is None:
            return
        async with entry.lock:
            if entry.denied is not None:
                raise entry.denied
            if entry.requests and entry.asked != entry.rate:
                await self._ask(entry)

    async def ensure(self, message: MessageClass, rate: float) -> bool:
        """Keep a message at `rate` hertz or more permanently; return False if it was refused or not answered.

        Nothing is sent while the message arrives often enough, and such a request is kept once.
        """
        age = self._age(message)
        if self.held.get(message, 0.0) < rate:
            self.hold(message, rate)
        if age is not None and age <= 2.0 / rate:
            return True
        try:
            await self.ask(message)
        except MavstackError:
            return False
        return True

    async def close(self) -> None:
        """Stop asking."""
        tasks = tuple(self._tasks)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    async def _ask(self, entry: _MessageRate) -> None:
        rate = entry.rate
        entry.retry_at = self._node.now() + max(entry.retry_interval, MISSING_INTERVALS / rate)
        entry.asked = rate  # set before the request, which may be sent even if this task is cancelled
        try:
            await self._component.set_message_rate(entry.message, rate)
        except CommandDenied as error:
            entry.asked, entry.denied = None, _named(error, entry.message, rate)
            logger.debug("%s", entry.denied)
            raise entry.denied from error
        except MavstackError:
            entry.asked = None
            raise

    async def _fall_back(self, entry: _MessageRate) -> None:
        """Ask for the rate that is left after a request was released."""
        with suppress(MavstackError):
            if _id(entry.message) in self._rates:
                await self.ask(entry.message)
            elif entry.asked is not None:
                entry.asked = None
                await self._component.set_message_rate(entry.message, DEFAULT)

    async def _watch(self) -> None:
        async with self._node.events(ComponentRebooted, ComponentReturned) as events:
            while self._rates:
                try:
                    async with asyncio.timeout(CHECK_INTERVAL):
                        if not await self._restarted(events):
                            return
                except TimeoutError:
                    await self._ask_for_missing()
                    continue
                for entry in self._rates.values():
                    entry.asked = entry.denied = None
                    entry.retry_interval = CHECK_INTERVAL
                await self._ask_each(list(self._rates.values()))

    async def _restarted(self, events: Subscription[Any]) -> bool:
        """Wait until the component may have forgotten the rates; return False if the node closed."""
        async for event in events:
            if event.component.address == self._component.address:
                return True
        return False

    async def _ask_for_missing(self) -> None:
        info = self._component.info
        if info is None or not info.alive or not self._node.is_open:
            return
        now = self._node.now()
        missing = []
        for entry in self._rates.values():
            age = self._age(entry.message)
            if age is not None and age <= max(CHECK_INTERVAL, MISSING_INTERVALS / entry.rate):
                entry.retry_interval = CHECK_INTERVAL
            elif entry.denied is None and now >= entry.retry_at:
                entry.asked = None
                entry.retry_interval = min(2 * entry.retry_interval, MAX_RETRY_INTERVAL)
                missing.append(entry)
        await self._ask_each(missing)

    async def _ask_each(self, entries: list[_MessageRate]) -> None:
        for entry in entries:
            with suppress(MavstackError):
                await self.ask(entry.message)

    def _begin(self, work: Coroutine[Any, Any, None]) -> asyncio.Task[None]:
        task = asyncio.get_running_loop().create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)
        return task


def _named(error: CommandDenied, message: MessageClass, rate: float) -> CommandDenied:
    """Return the refusal with the message and its rate as the operation."""
    named = CommandDenied(
        f"streaming {name_of(message)} at {rate:g} Hz from",
        error.target,
        attempts=error.attempts,
        answer=error.answer,
        code=error.code,
    )
    named.detail, named.status_texts = error.detail, error.status_texts
    return named


def _id(message: MessageClass) -> int:
    return int(message.__mavlink_row__[0])
