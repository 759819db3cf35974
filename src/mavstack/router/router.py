"""The router: endpoints that are opened, opened again, added, removed and changed while packets flow.

    async with Router(load_config("router.toml")) as router:
        await router.serve_forever()

The engine forwards the packets on a thread of its own. This class lives in the event loop and touches only
the packets of endpoints that Python carries (WebSockets, recorders …). A reload opens and closes only
endpoints whose transport changed; packets of all others flow on, because the engine changes filters between
two packets.
"""

from __future__ import annotations

import asyncio
import logging
from collections import deque
from contextlib import suppress
from dataclasses import replace
from time import time
from typing import TYPE_CHECKING

from mavstack.errors import InvalidArgumentError, InvalidStateError, LinkError, MavstackError
from mavstack.router.attachments import Attachments
from mavstack.router.changes import Add, NeedsRestart, Reconfigure, Remove, applicable, steps_between
from mavstack.router.config.names import Names
from mavstack.router.endpoints import make_endpoint
from mavstack.router.engine import ENDED, RouterEngine
from mavstack.router.filters import rules_of
from mavstack.router.guard import Guard

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from types import TracebackType
    from typing import Self

    from mavstack.router.config import EndpointConfig, RouterConfig
    from mavstack.router.endpoints import Endpoint
    from mavstack.router.engine_events import RouterEvent
    from mavstack.router.engine_statistics import RouterStatistics
    from mavstack.router.firewall import Alert
    from mavstack.router.firewall.id_store import IdStore
    from mavstack.security import TimestampStore

_log = logging.getLogger("mavstack.router")
#: Seconds between two attempts to open an endpoint that could not be opened after a reload.
RETRY_INTERVAL = 5.0
#: Number of the newest alerts that snapshots of the router contain.
RECENT_ALERTS = 8
#: Interval at which the firewall checks the counters, in seconds.
TIMER_INTERVAL = 1.0
#: Interval of polling the engine's events in an event loop without socket readers, in seconds.
POLL_INTERVAL = 0.005


class Router:
    """A running router. An async context manager; closing it closes all endpoints.

    Args:
        config: The configuration.

    Attributes:
        config: The present configuration, with all changes made at run time.
        problems: The endpoints of the configuration that could not be opened, and why.
    """

    def __init__(self, config: RouterConfig) -> None:
        self.config = config
        self.problems: dict[str, str] = {}
        self._engine: RouterEngine | None = None
        self._attachments: Attachments | None = None
        self._endpoints: dict[str, Endpoint] = {}
        self._changing = asyncio.Lock()
        self._retry: asyncio.Task[None] | None = None
        self._timer: asyncio.Task[None] | None = None
        self._poll: asyncio.Handle | None = None
        self._closed = asyncio.Event()
        self._failure: InvalidStateError | None = None
        self._observers: list[Callable[[RouterEvent], None]] = []
        self._alert_observers: list[Callable[[Alert], None]] = []
        #: The newest alerts of the firewall with their Unix times, oldest first.
        self.recent_alerts: deque[tuple[float, Alert]] = deque(maxlen=RECENT_ALERTS)

    @property
    def endpoints(self) -> Mapping[str, Endpoint]:
        """The open endpoints by name."""
        return self._endpoints

    @property
    def is_open(self) -> bool:
        """True from `open` to `close`."""
        return self._engine is not None

    @property
    def engine(self) -> RouterEngine:
        """The engine.

        Raises:
            InvalidStateError: The router is not open.
        """
        if self._engine is None:
            raise InvalidStateError("the router is not open: use `async with`")
        return self._engine

    @property
    def attachments(self) -> Attachments:
        """The links of the engine and their endpoints.

        Raises:
            InvalidStateError: The router is not open.
        """
        if self._attachments is None:
            raise InvalidStateError("the router is not open: use `async with`")
        return self._attachments

    async def open(self) -> Self:
        """Open all endpoints.

        Returns:
            The router itself.

        Raises:
            LinkError: An endpoint cannot be opened; the text names it. None is open then.
        """
        dialect = Names(self.config.dialect).dialect
        self._engine = RouterEngine(dialect, duplicate_window=self.config.duplicate_window)
        try:
            guard = Guard(self._engine, self.config, rules_of, _timestamps, _ids)
            guard.on_alert = self._take_alert
            guard.load_keys(self.config)
            self._attachments = Attachments(self._engine, dialect, guard)
            guard.open(time())
            self._start_reading()
            for config in self.config.endpoints:
                await self._open_endpoint(config)
        except BaseException:
            await self.close()
            raise
        return self

    async def close(self) -> None:
        """Close all endpoints, then the engine. Idempotent."""
        self._closed.set()
        if self._retry is not None:
            self._retry.cancel()
            await asyncio.gather(self._retry, return_exceptions=True)
            self._retry = None
        if self._timer is not None:
            self._timer.cancel()
            await asyncio.gather(self._timer, return_exceptions=True)
            self._timer = None
        if self._attachments is not None:
            self._attachments.guard.close()
        for name in list(self._endpoints):
            await self._endpoints.pop(name).close()
        if self._poll is not None:
            self._poll.cancel()
        engine, self._engine, self._attachments = self._engine, None, None
        if engine is not None:
            with suppress(ValueError, OSError, NotImplementedError):
                asyncio.get_running_loop().remove_reader(engine.fileno())
            engine.close()

    async def serve_forever(self) -> None:
        """Wait until the router is closed.

        Raises:
            InvalidStateError: The engine ended by an internal error; nothing is forwarded any more.
        """
        await self._closed.wait()
        if self._failure is not None:
            raise self._failure

    def statistics(self) -> RouterStatistics:
        """Return the counters of the engine and the learned routes."""
        return self.engine.statistics()

    def add_observer(self, observer: Callable[[RouterEvent], None]) -> None:
        """Call a function with each event of the engine, such as a packet that a rule dropped."""
        self._observers.append(observer)

    def add_alert_observer(self, observer: Callable[[Alert], None]) -> None:
        """Call a function with each alert of the firewall."""
        self._alert_observers.append(observer)

    async def add(self, config: EndpointConfig) -> None:
        """Open a further endpoint.

        Raises:
            InvalidArgumentError: There is an endpoint of that name.
            LinkError: It cannot be opened.
        """
        async with self._changing:
            if self.config.endpoint(config.name) is not None:
                raise InvalidArgumentError(f"there is an endpoint {config.name} already: remove it first")
            await self._open_endpoint(config)
            self._store((*self.config.endpoints, config))

    async def remove(self, name: str) -> None:
        """Close an endpoint.

        Raises:
            InvalidArgumentError: There is no endpoint of that name.
        """
        async with self._changing:
            self._config_of(name)
            await self._close_endpoint(name)
            self._store(tuple(each for each in self.config.endpoints if each.name != name))

    async def change(self, config: EndpointConfig) -> None:
        """Replace the configuration of an endpoint, which stays open if its transport is the same.

        Raises:
            InvalidArgumentError: There is no endpoint of that name.
            LinkError: It cannot be opened again.
        """
        self._config_of(config.name)
        endpoints = (config if each.name == config.name else each for each in self.config.endpoints)
        await self.apply(replace(self.config, endpoints=tuple(endpoints)))
        if config.name in self.problems:
            raise LinkError(self.problems[config.name])

    async def pause(self, name: str, *, paused: bool = True) -> None:
        """Drop all packets from and to an endpoint, or forward them again.

        Raises:
            InvalidArgumentError: There is no endpoint of that name.
        """
        await self.change(replace(self._config_of(name), pause=paused))

    async def apply(self, config: RouterConfig) -> tuple[str, ...]:
        """Change to another configuration; unchanged links lose no packet.

        An endpoint that cannot be opened does not stop the others; it is tried again every few seconds.

        Args:
            config: The requested configuration.

        Returns:
            Notes for the user: endpoints that could not be opened, settings that need a restart.

        Raises:
            RouterConfigError: The table `[firewall]` is not valid; nothing was changed.
            SigningError: A key cannot be read; nothing was changed.
        """
        notes: list[str] = []
        async with self._changing:
            self._handle_timer()
            guard, has_changed = self.attachments.guard, config.firewall != self.config.firewall
            has_new_keys = guard.load_keys(config)
            if has_changed:
                guard.reload(config)
            for step in steps_between(self.config, config):
                match step:
                    case Remove(name):
                        await self._close_endpoint(name)
                    case Add(endpoint):
                        notes += await self._try_to_open(endpoint)
                    case Reconfigure(endpoint):
                        if endpoint.name in self._endpoints:
                            self._endpoints[endpoint.name].reconfigure(endpoint)
                    case NeedsRestart(setting):
                        notes.append(f"{setting} changes when the router is started again")
            self.config = applicable(self.config, config)
            if has_changed or has_new_keys:
                self.attachments.configure_all()
            self._start_timer()
        return tuple(notes)

    async def _try_to_open(self, config: EndpointConfig) -> list[str]:
        try:
            await self._open_endpoint(config)
        except MavstackError as error:
            text = str(error)
            self.problems[config.name] = text
            _log.error("%s", text)
            if self._retry is None or self._retry.done():
                self._retry = asyncio.get_running_loop().create_task(self._retry_problems())
            return [text]
        return []

    async def _retry_problems(self) -> None:
        while self.problems:
            await asyncio.sleep(RETRY_INTERVAL)
            async with self._changing:
                for name in list(self.problems):
                    config = self.config.endpoint(name)
                    if config is None:
                        del self.problems[name]
                        continue
                    with suppress(MavstackError):
                        await self._open_endpoint(config)

    async def _open_endpoint(self, config: EndpointConfig) -> None:
        self._handle_timer()
        endpoint = make_endpoint(config, self.attachments)
        try:
            await endpoint.open()
        except BaseException as error:
            await endpoint.close()
            if isinstance(error, LinkError):
                raise type(error)(f"endpoint {config.name}: {error}") from None
            raise
        self._endpoints[config.name] = endpoint
        self.problems.pop(config.name, None)
        self._start_timer()
        # wait until the engine has the endpoint, so that the next packet reaches it
        self.engine.synchronize()

    async def _close_endpoint(self, name: str) -> None:
        self.problems.pop(name, None)
        endpoint = self._endpoints.pop(name, None)
        if endpoint is not None:
            await endpoint.close()

    def _config_of(self, name: str) -> EndpointConfig:
        found = self.config.endpoint(name)
        if found is None:
            names = ", ".join(each.name for each in self.config.endpoints) or "none"
            raise InvalidArgumentError(f"there is no endpoint {name}; endpoints: {names}")
        return found

    def _store(self, endpoints: tuple[EndpointConfig, ...]) -> None:
        self.config = replace(self.config, endpoints=endpoints)

    def _start_timer(self) -> None:
        """Call the guard once a second from now on, if it has a firewall or keys."""
        if self._timer is None and self.attachments.guard.needs_timer:
            self._timer = asyncio.get_running_loop().create_task(self._run_timer())

    async def _run_timer(self) -> None:
        while True:
            await asyncio.sleep(TIMER_INTERVAL)
            self._handle_timer()

    def _handle_timer(self) -> None:
        self.attachments.guard.handle_timer(time())

    def _take_alert(self, alert: Alert) -> None:
        self.recent_alerts.append((time(), alert))
        for observer in self._alert_observers:
            observer(alert)

    def _start_reading(self) -> None:
        """Take events when they come, or at intervals if the event loop has no socket readers (Windows)."""
        try:
            asyncio.get_running_loop().add_reader(self.engine.fileno(), self._take_events)
        except NotImplementedError:
            self._poll_events()

    def _poll_events(self) -> None:
        self._poll = asyncio.get_running_loop().call_later(POLL_INTERVAL, self._poll_events)
        self._take_events()

    def _take_events(self) -> None:
        """Pass the events of the engine on to the endpoints that they are about."""
        for event in self.engine.events():
            self.attachments.guard.handle_event(event, time())
            match event:
                case ("readable", number):
                    owner = self.attachments.owner(number)
                    if owner is not None:
                        owner.readable(number)
                case ("ended",):
                    self._failure = InvalidStateError(ENDED)
                    self._closed.set()
                case ("closed", number, reason):
                    owner = self.attachments.owner(number)
                    if owner is not None:
                        owner.link_closed(number, reason)
            for observer in self._observers:
                observer(event)

    async def __aenter__(self) -> Self:
        return await self.open()

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()


def _timestamps() -> TimestampStore:
    """Return the store of this user's routers; a router without keys needs no folder for it."""
    from mavstack.router.gateway import timestamps_path
    from mavstack.security import TimestampStore

    return TimestampStore(timestamps_path())


def _ids() -> IdStore:
    from mavstack.router.firewall.id_store import IdStore, ids_path

    return IdStore(ids_path())
