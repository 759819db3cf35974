"""Base classes of the objects that belong to the thread of the event loop.

`mavstack.sync` reaches them through proxies. A class that names `ApiObject` or `ReadOnly` among its bases is
a class of the API: it has a blocking counterpart of the same name. Other classes, also a program's own
subclasses, have the counterpart of their nearest base of the API.

`vehicle.mode = "GUIDED"` would only create an attribute that hides the vehicle's mode, while nothing is sent.
So most classes of the API are `ReadOnly`.
"""

from __future__ import annotations

from inspect import get_annotations, getattr_static
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator


class LoopBound:
    """Base of objects that are used in the thread of the event loop alone."""

    __slots__ = ()


class ApiObject(LoopBound):
    """Base of the classes of the API."""

    __slots__ = ()


class ReadOnly(ApiObject):
    """Base of classes of the API that refuse to assign a public attribute unless it has a setter.

    The constructor assigns the attributes that the class body annotates, once. A program's own subclass may
    have further attributes.
    """

    __slots__ = ()

    if not TYPE_CHECKING:  # type checkers would accept any attribute

        def __setattr__(self, name: str, value: object) -> None:
            if name.startswith("_") or self._is_new(name) or is_settable_property(self, name):
                object.__setattr__(self, name, value)
            else:
                raise refused_assignment(self, name)

        def _is_new(self, name: str) -> bool:
            """Return whether an assignment creates an attribute: in the constructor or in a subclass."""
            kind = type(self)
            if any(name in get_annotations(base) for base in kind.__mro__ if is_api_class(base)):
                return not hasattr(self, name)
            return not is_api_class(kind) and not hasattr(kind, name)


def is_api_class(kind: type) -> bool:
    """Return whether a class has a blocking counterpart of the same name."""
    return kind is not ReadOnly and not {ApiObject, ReadOnly}.isdisjoint(kind.__bases__)


def api_classes() -> Iterator[type]:
    """Yield the classes of the API, as far as their modules are imported."""
    for base in (ApiObject, ReadOnly):
        yield from filter(is_api_class, base.__subclasses__())


def is_settable_property(owner: object, name: str) -> bool:
    """Return whether an attribute is a property with a setter."""
    member = getattr_static(type(owner), name, None)
    return isinstance(member, property) and member.fset is not None


def refused_assignment(owner: object, name: str) -> AttributeError:
    """Return the error of an assignment to an attribute that cannot be set."""
    text = f"{type(owner).__name__!r} object has no settable attribute {name!r}"
    if callable(getattr(type(owner), f"set_{name}", None)):
        text += f"; call set_{name}()"
    elif hasattr(type(owner), name):
        text += "; it is read-only"
    return AttributeError(text, name=name, obj=owner)
