"""A blocking face over any object of the node: the same names, with waits in place of awaits.

There is no second implementation and nothing to keep up to date but the stub beside it: a proxy looks an
attribute up in the loop's thread, and what it finds there tells what to give back.

    async method            a method that waits
    plain method, property  called in the loop's thread
    async iterator          an iterator
    async context manager   a context manager
    object of the node      a proxy of it, and so for a vehicle, a group, an event that tells of a vehicle
    list, mapping           a copy of it, of proxies if it holds such objects
    anything else           itself: messages, packets, events and plain values cannot change
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import is_dataclass
from functools import wraps
from inspect import isawaitable
from typing import TYPE_CHECKING, Any

from mavstack.vehicle.vehicle_tracker import VehicleEvent

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType
    from typing import Self

    from mavstack.node.blocking_portal import BlockingPortal

#: Whose objects live in the loop's thread.
PACKAGES = ("mavstack.node.", "mavstack.vehicle.")


class Blocking:
    """The blocking face of one object."""

    def __init__(self, inner: Any, portal: BlockingPortal) -> None:  # noqa: ANN401 (any object of the node)
        self._inner = inner
        self._portal = portal

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401 (whatever the object has)
        if name.startswith("__"):
            raise AttributeError(name)
        inner = self._inner
        return self._portal.call(lambda: self._attribute(getattr(inner, name)))

    def __dir__(self) -> list[str]:
        return dir(self._inner)

    def __repr__(self) -> str:
        return f"<blocking {self._inner!r}>"

    def __iter__(self) -> Iterator[Any]:
        inner = self._inner
        if hasattr(type(inner), "__anext__"):
            return self
        return iter([self._face(item) for item in self._portal.call(lambda: list(inner))])

    def __len__(self) -> int:
        inner = self._inner
        return self._portal.call(lambda: len(inner))

    def __bool__(self) -> bool:
        return bool(self._inner)

    def __getitem__(self, key: Any) -> Any:  # noqa: ANN401 (whatever the mapping has)
        inner = self._inner
        return self._face(self._portal.call(lambda: inner[_inner(key)]))

    def __contains__(self, item: object) -> bool:
        inner = self._inner
        return self._portal.call(lambda: _inner(item) in inner)

    def __eq__(self, other: object) -> bool:
        return self._inner is _inner(other)

    def __hash__(self) -> int:
        return hash(self._inner)

    def __next__(self) -> Any:  # noqa: ANN401 (what the iterator yields)
        inner = self._inner

        async def following() -> tuple[Any, ...]:
            try:
                return (await anext(inner),)
            except StopAsyncIteration:
                return ()

        found = self._portal.wait(following())
        if not found:
            raise StopIteration
        return self._face(found[0])

    def __enter__(self) -> Self:
        self._portal.wait(self._inner.__aenter__())
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if not self._portal.closed:  # else there is nothing left to leave
            self._portal.wait(self._inner.__aexit__(kind, error, trace))

    def _attribute(self, found: Any) -> Any:  # noqa: ANN401 (any value)
        return self._method(found) if callable(found) and not _is_of_node(found) else self._face(found)

    def _method(self, method: Callable[..., Any]) -> Callable[..., Any]:
        async def called(args: tuple[Any, ...], named: dict[str, Any]) -> Any:  # noqa: ANN401 (as below)
            result = method(*map(_inner, args), **{name: _inner(value) for name, value in named.items()})
            return self._face(await result if isawaitable(result) else result)

        @wraps(method)
        def blocking(*args: Any, **named: Any) -> Any:  # noqa: ANN401 (the method's own)
            return self._portal.wait(called(args, named))

        return blocking

    def _face(self, found: Any) -> Any:  # noqa: ANN401 (any value)
        if _is_of_node(found):
            return Blocking(found, self._portal)
        if isinstance(found, list):
            return [self._face(item) for item in found]
        if isinstance(found, Mapping):
            return {self._face(key): self._face(value) for key, value in found.items()}
        return found


def _inner(argument: Any) -> Any:  # noqa: ANN401 (any value)
    return argument._inner if isinstance(argument, Blocking) else argument  # noqa: SLF001 (of this module)


def _is_of_node(found: object) -> bool:
    kind = type(found)
    if is_dataclass(kind) and not isinstance(found, VehicleEvent):
        return False
    lives = kind.__module__.startswith(PACKAGES) and not isinstance(found, str | tuple)
    return lives or hasattr(kind, "__anext__")
