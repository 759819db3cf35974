"""The parts of an object of the API, declared in its class and made when they are first used.

    class RemoteComponent(ReadOnly):
        params = Part(Params, "The parameters.", clear_cache=Params.clear_cache)
        mission = Part(Plans, "The mission.", lambda component: Plans(component, PlanType.MISSION))

A row names the part, its class, how it is made, and what a reboot does to it. The caches, the stubs of the
blocking API and the index of the documentation are derived from the rows.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Generic, TypeVar, overload

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from typing import Self

    from mavstack.services import Address, Service

Made = TypeVar("Made")


class Part(Generic[Made]):
    """A part of an object; as an attribute of the object it is the part itself.

    Args:
        kind: The class of the part.
        doc: The docstring of the attribute.
        make: Makes the part for an object; None: the class is called with the object.
        clear_cache: Discards the state that the part cached before a reboot; None: it caches none.
        server: Makes the other side of the service for an address; simulated vehicles run it. None: it needs
            more than an address.
        offered: True if the console and the station offer the calls of the part by themselves; see
            `part_calls`.
    """

    def __init__(
        self,
        kind: type[Made],
        doc: str,
        make: Callable[[Any], Made] | None = None,
        *,
        clear_cache: Callable[[Made], object] | None = None,
        server: Callable[[Address], Service] | None = None,
        offered: bool = False,
    ) -> None:
        self.kind = kind
        self.server = server
        self.offered = offered
        self.__doc__ = doc
        self.name = ""
        self._make: Callable[[Any], Made] = kind if make is None else make
        self._clear_cache = clear_cache

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    @overload
    def __get__(self, owner: None, kind: type) -> Self: ...
    @overload
    def __get__(self, owner: object, kind: type) -> Made: ...
    def __get__(self, owner: object | None, kind: type) -> Self | Made:
        """Make the part; from then on the object holds it, and this method is not called."""
        if owner is None:
            return self
        made = self._make(owner)
        vars(owner)[self.name] = made
        return made

    def made(self, owner: object) -> Made | None:
        """Return the part of an object; None if it was not used yet."""
        return vars(owner).get(self.name)

    def clear_cache(self, owner: object) -> None:
        """Discard the state that the part of an object cached before a reboot."""
        made = self.made(owner)
        if made is not None and self._clear_cache is not None:
            self._clear_cache(made)


def parts_of(kind: type) -> Iterator[Part[Any]]:
    """Yield the parts of a class in the order of their declaration, those of its bases first."""
    for base in reversed(kind.__mro__):
        yield from (member for member in vars(base).values() if isinstance(member, Part))


def clear_caches(owner: object) -> None:
    """Discard the state that the parts of an object cached before a reboot."""
    for part in parts_of(type(owner)):
        part.clear_cache(owner)
