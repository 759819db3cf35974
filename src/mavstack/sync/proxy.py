"""A blocking proxy of any object of the async API: the same names, with blocking calls.

There is no second implementation. A proxy looks an attribute up in the event loop's thread and converts its
value:

    async method                     a method that blocks until the result
    plain method, property           called in the loop's thread
    async iterator                   an iterator
    async context manager            a context manager
    object of the node or vehicle    a proxy; in events and group results too
    list, mapping                    a copy, with proxies of such objects
    anything else                    unchanged: messages, packets and plain values are immutable
"""

from __future__ import annotations

import asyncio
from collections.abc import Iterator, Mapping
from functools import cached_property, wraps
from inspect import getattr_static, isawaitable, iscoroutinefunction
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar

from mavstack.node.api_object import (
    LoopBound,
    ReadOnly,
    is_api_class,
    is_settable_property,
    refused_assignment,
)
from mavstack.sync.classes import wrapped_classes
from mavstack.vehicle.events import VehicleEvent

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType
    from typing import Self

    from mavstack.node.blocking_portal import BlockingPortal
    from mavstack.node.command_handlers import AnyHandler


class Blocking:
    """The blocking proxy of one object."""

    #: The async class that each subclass wraps.
    _wrapped: ClassVar[type] = object

    def __init__(self, inner: Any, portal: BlockingPortal) -> None:  # noqa: ANN401 (any object of the API)
        object.__setattr__(self, "_inner", inner)
        object.__setattr__(self, "_portal", portal)

    _inner: Any
    _portal: BlockingPortal

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401 (any attribute)
        if name.startswith("_"):
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
        inner = self._inner
        return self._portal.call(lambda: self._convert_attribute(getattr(inner, name)))

    def __setattr__(self, name: str, value: object) -> None:
        inner = self._inner
        if name.startswith("_") or not _is_settable(inner, name):
            raise refused_assignment(inner, name)
        self._portal.call(lambda: setattr(inner, name, _unwrap(value)))

    def __dir__(self) -> list[str]:
        return [name for name in dir(self._inner) if not name.startswith("_") or name.startswith("__")]

    def __repr__(self) -> str:
        return f"<blocking {self._inner!r}>"

    def __iter__(self) -> Iterator[Any]:
        inner = self._inner
        if hasattr(type(inner), "__anext__"):
            return self
        return iter([self._wrap(item) for item in self._portal.call(lambda: list(inner))])

    def __len__(self) -> int:
        inner = self._inner
        return self._portal.call(lambda: len(inner))

    def __bool__(self) -> bool:
        return bool(self._inner)

    def __getitem__(self, key: Any) -> Any:  # noqa: ANN401 (any item)
        inner = self._inner
        return self._wrap(self._portal.call(lambda: inner[_unwrap(key)]))

    def __contains__(self, item: object) -> bool:
        inner = self._inner
        return self._portal.call(lambda: _unwrap(item) in inner)

    def __eq__(self, other: object) -> bool:
        return self._inner is _unwrap(other)

    def __hash__(self) -> int:
        return hash(self._inner)

    def __next__(self) -> Any:  # noqa: ANN401 (an item of the iterator)
        inner = self._inner

        async def get_next() -> tuple[Any, ...]:
            try:
                return (await anext(inner),)
            except StopAsyncIteration:
                return ()

        items = self._portal.wait(get_next())
        if not items:
            raise StopIteration
        return self._wrap(items[0])

    def __enter__(self) -> Self:
        self._portal.wait(self._inner.__aenter__())
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if not self._portal.closed:  # if it is closed, the node has left the context already
            self._portal.wait(self._inner.__aexit__(kind, error, trace))

    def _convert_attribute(self, value: Any) -> Any:  # noqa: ANN401 (any value)
        return self._blocking(value) if callable(value) and not _needs_proxy(value) else self._wrap(value)

    def _blocking(self, method: Callable[..., Any]) -> Callable[..., Any]:
        async def run(args: tuple[Any, ...], named: dict[str, Any]) -> Any:  # noqa: ANN401 (as below)
            result = method(*map(_unwrap, args), **{name: _unwrap(value) for name, value in named.items()})
            return self._wrap(await result if isawaitable(result) else result)

        @wraps(method)
        def call(*args: Any, **named: Any) -> Any:  # noqa: ANN401 (the method's own)
            return self._portal.wait(run(args, named))

        return call

    def _wrap(self, value: Any) -> Any:  # noqa: ANN401 (any value)
        if _needs_proxy(value):
            return blocking_class(type(value))(value, self._portal)
        if isinstance(value, list):
            return [self._wrap(item) for item in value]
        if isinstance(value, Mapping):
            return {self._wrap(key): self._wrap(item) for key, item in value.items()}
        return value


class BlockingGroup(Blocking):
    """The blocking proxy of a group of vehicles: `each` runs plain functions, each in a thread of its own."""

    def each(self, work: Callable[[Any], Any], **options: Any) -> Any:  # noqa: ANN401 (as in the stub)
        """Run a function for every vehicle; see `mavstack.Group.each`."""
        portal = self._portal

        async def run(vehicle: object) -> object:
            return await _run_in_thread(portal, lambda: work(self._wrap(vehicle)))

        return self._blocking(self._inner.each)(run, **options)


class BlockingCommandHandlers(Blocking):
    """The blocking proxy of command handlers: plain functions run in a thread of their own.

    A handler may therefore make blocking calls, also to its own node. The sender of the command receives
    IN_PROGRESS until it returns, as for an async handler.
    """

    def register(self, command: int) -> Callable[[AnyHandler], AnyHandler]:
        """Register a function as the handler of a command; see `mavstack.Node.on_command`."""
        portal, inner = self._portal, self._inner

        def decorate(handler: AnyHandler) -> AnyHandler:
            async def run(request: object) -> object:
                return await _run_in_thread(portal, lambda: handler(request))

            if iscoroutinefunction(handler):
                portal.call(lambda: inner.register(command)(handler))
            else:
                portal.call(lambda: inner._run_as_task(command, run, none_is_pending=True))  # noqa: SLF001 (its proxy)
            return handler

        return decorate


async def _run_in_thread(portal: BlockingPortal, work: Callable[[], object]) -> object:
    """Run a function in a thread of its own; a cancellation ends its blocking calls."""
    worker = portal.worker(work)
    try:
        return await asyncio.shield(worker.result)
    except asyncio.CancelledError:
        worker.cancel()
        await asyncio.wait([worker.result])
        worker.result.exception()  # retrieve the exception, so that asyncio does not log it
        raise


#: Blocking base classes that differ from `Blocking`, by the name of the async class.
_BASES: Mapping[str, type[Blocking]] = MappingProxyType(
    {"Group": BlockingGroup, "CommandHandlers": BlockingCommandHandlers}
)
#: The blocking class of each async class; filled on first use.
_classes: dict[type, type[Blocking]] = {}


def blocking_class(kind: type) -> type[Blocking]:
    """Return the blocking class of an async class, or of its nearest public base."""
    known = _classes.get(kind)
    if known is None:
        public = next(filter(is_api_class, kind.__mro__), None)
        if public is None:
            return Blocking
        base: type[Blocking] = _BASES.get(public.__name__, Blocking)
        parent = next(filter(is_api_class, public.__mro__[1:]), None)
        if parent is not None:
            base = blocking_class(parent)
        body = {"__doc__": public.__doc__, "__module__": "mavstack.sync", "_wrapped": public}
        known = _classes.get(public) or type(public.__name__, (base,), body)
        _classes[public] = _classes[kind] = known
    return known


def register(kind: type, blocking: type[Blocking]) -> None:
    """Use a class that is written by hand as the blocking class of an async class."""
    _classes[kind] = blocking


def class_named(name: str) -> type[Blocking]:
    """Return the blocking class of that name."""
    return blocking_class(wrapped_classes()[name])


def _unwrap(argument: Any) -> Any:  # noqa: ANN401 (any value)
    return argument._inner if isinstance(argument, Blocking) else argument  # noqa: SLF001 (of this module)


def _needs_proxy(value: object) -> bool:
    return isinstance(value, LoopBound | VehicleEvent) or hasattr(type(value), "__anext__")


def _is_settable(inner: object, name: str) -> bool:
    """Return whether a program may set an attribute: a property with a setter, or a data attribute."""
    member = getattr_static(type(inner), name, None)
    if isinstance(member, property) or isinstance(inner, ReadOnly):
        return is_settable_property(inner, name)
    if isinstance(member, cached_property) or callable(member):
        return False
    return hasattr(inner, name)
