"""Objects of the API whose attributes cannot be assigned by mistake.

`vehicle.mode = "GUIDED"` would only create an attribute that hides the vehicle's mode, while nothing is sent.
"""

from __future__ import annotations

from inspect import getattr_static
from typing import TYPE_CHECKING, ClassVar


class ReadOnly:
    """Base of objects that refuse to assign a public attribute unless it is a property with a setter.

    A program's own subclass may have further attributes.
    """

    #: Public attributes that the constructor assigns, once.
    _constructed: ClassVar[frozenset[str]] = frozenset()

    if not TYPE_CHECKING:  # type checkers would accept any attribute

        def __setattr__(self, name: str, value: object) -> None:
            if name.startswith("_") or self._is_new(name) or is_settable_property(self, name):
                object.__setattr__(self, name, value)
            else:
                raise refused_assignment(self, name)

        def _is_new(self, name: str) -> bool:
            """Return whether the constructor or a program's own subclass assigns an attribute of its own."""
            kind = type(self)
            if name in self._constructed:
                return name not in self.__dict__
            return not kind.__module__.startswith("mavstack.") and not hasattr(kind, name)


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
