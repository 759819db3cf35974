"""The events of a remote component: `component.events()`, `vehicle.events()`.

    async for event in vehicle.events(severity=LogLevel.WARNING):
        print(event.severity.name, event.message, event.arguments)

The first stream or listener starts the receiver, which requests missing events from then on. The words of the
events are in the component's metadata: it is downloaded when the first event arrives, unless it is in the
user's cache. The events wait for it; if it cannot be had, they are delivered without words.
"""

from __future__ import annotations

import asyncio
import logging
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import MavstackError, MetadataError, RemoteTimeout
from mavstack.node.api_object import ApiObject, ReadOnly
from mavstack.node.metadata_files import MetadataAccess, MetadataFiles
from mavstack.node.params import USER_CACHE
from mavstack.node.time_budget import TimeBudget
from mavstack.services.events import (
    EventReceived,
    EventsLost,
    decode_event,
    parse_event_metadata,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from types import TracebackType
    from typing import Self

    from mavstack.node.clients import ComponentClients
    from mavstack.node.subscription import Subscription
    from mavstack.services.events import DecodedEvent, EventDefinition

#: Maximum seconds to download the metadata; received events wait for the download.
METADATA_TIMEOUT: Final = 60.0
#: Seconds after which the download is tried again if the component did not answer.
RETRY_INTERVAL: Final = 60.0
_LOGGER: Final = logging.getLogger("mavstack.node")
_NO_DEFINITIONS: Final[Mapping[int, EventDefinition]] = MappingProxyType({})


class EventMetadata:
    """The definitions of a component's events, downloaded when they are needed first."""

    def __init__(self, clients: ComponentClients) -> None:
        self._clients = clients
        self._files = MetadataFiles(clients)
        self._loading: asyncio.Task[None] | None = None
        #: The time of the next download attempt; None: no attempt until the component reboots.
        self._next_attempt: float | None = 0.0
        self.definitions = _NO_DEFINITIONS

    def clear_cache(self) -> None:
        """Download the metadata again when it is needed next, as after a reboot with another firmware."""
        self._files.clear_cache()
        self._next_attempt = 0.0

    async def get(self) -> Mapping[int, EventDefinition]:
        """Return the definitions; none if they cannot be had."""
        host = self._clients.host
        due = self._next_attempt is not None and host.is_open and host.now() >= self._next_attempt
        if self._loading is None and due:
            self._loading = asyncio.get_running_loop().create_task(self._load())
        if self._loading is not None:
            await asyncio.shield(self._loading)
        return self.definitions

    async def download(self, access: MetadataAccess) -> Mapping[int, EventDefinition]:
        """Return the definitions from the cache or from the component; raise if they cannot be had."""
        found = await self._files.get(common.CompMetadataType.EVENTS, access, _parse)
        self.definitions, self._next_attempt = MappingProxyType(found), None
        return self.definitions

    async def _load(self) -> None:
        now = self._clients.host.now
        try:
            await self.download(MetadataAccess(TimeBudget(METADATA_TIMEOUT, now), USER_CACHE))
        except RemoteTimeout as error:
            _LOGGER.info("events of %s without metadata for now: %s", self._clients.address, error)
            self._next_attempt = now() + RETRY_INTERVAL
        except MavstackError as error:
            _LOGGER.info("events of %s without metadata: %s", self._clients.address, error)
            self._next_attempt = None
        finally:
            self._loading = None


class EventStream(ReadOnly):
    """An async iterator of a component's events, in order and each once; made by `Vehicle.events`.

    Close it by `async with` or `close()`. It ends after `close`, or when the connection closes.
    """

    def __init__(
        self, subscription: Subscription[EventReceived | EventsLost], metadata: EventMetadata, severity: int
    ) -> None:
        self._subscription = subscription
        self._metadata = metadata
        self._severity = severity
        self._lost = 0

    @property
    def lost(self) -> int:
        """The number of events that the component could not send again."""
        return self._lost

    @property
    def dropped(self) -> int:
        """The number of events that were dropped because they were not read in time."""
        return self._subscription.dropped

    def close(self) -> None:
        """Unsubscribe. Idempotent."""
        self._subscription.close()

    def drain(self) -> list[DecodedEvent]:
        """Return all queued events and empty the queue, without waiting.

        Returns:
            The events, oldest first, with the words of the metadata that is known already.
        """
        found = []
        for event in self._subscription.drain():
            match event:
                case EventsLost(count=count):
                    self._lost += count
                case EventReceived(level=level) if level <= self._severity:
                    found.append(decode_event(event, self._metadata.definitions))
        return found

    def __aiter__(self) -> Self:
        return self

    async def __anext__(self) -> DecodedEvent:
        """Return the next event.

        Raises:
            StopAsyncIteration: The stream or its connection was closed.
        """
        while True:
            # Wait for the metadata before an event is taken, so that a cancelled wait loses no event.
            definitions = await self._metadata.get() if await self._subscription.wait() else _NO_DEFINITIONS
            match await anext(self._subscription):
                case EventsLost(count=count):
                    self._lost += count
                case EventReceived(level=level) as event if level <= self._severity:
                    return decode_event(event, definitions)

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


class EventListener(ApiObject):
    """A callback that is called with each event, until `close`; made by `Vehicle.add_event_listener`."""

    def __init__(self, stream: EventStream, callback: Callable[[DecodedEvent], object]) -> None:
        self._stream = stream
        self._callback = callback
        self._task = asyncio.get_running_loop().create_task(self._run())

    @property
    def lost(self) -> int:
        """The number of events that the component could not send again."""
        return self._stream.lost

    def close(self) -> None:
        """Unregister the callback. Idempotent."""
        self._stream.close()
        if self._task is not asyncio.current_task():
            self._task.cancel()

    async def _run(self) -> None:
        async for event in self._stream:
            try:
                self._callback(event)
            except Exception as error:  # noqa: BLE001 (a defect of the program must not end the listener)
                context = {"message": "the listener for events failed", "exception": error}
                asyncio.get_running_loop().call_exception_handler(context)


def _parse(data: bytes, uri: str) -> dict[int, EventDefinition]:
    try:
        return parse_event_metadata(data)
    except MetadataError as error:
        raise MetadataError(error.problem, uri, error.line) from None
