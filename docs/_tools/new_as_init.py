"""A griffe extension: a class of the compiled core that has only `__new__` shows it as its constructor."""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING, Any

import griffe

if TYPE_CHECKING:
    from griffe import Class


class NewAsInit(griffe.Extension):
    """Give each class with `__new__` and no `__init__` an `__init__` with the same parameters."""

    def on_class_members(self, *, cls: Class, **_: Any) -> None:  # noqa: ANN401 (the interface of griffe)
        """Copy the constructor."""
        new = cls.members.get("__new__")
        if not isinstance(new, griffe.Function) or "__init__" in cls.members:
            return
        constructor = copy.copy(new)
        constructor.name = "__init__"
        constructor.parameters = griffe.Parameters(
            griffe.Parameter("self", kind=griffe.ParameterKind.positional_or_keyword),
            *list(new.parameters)[1:],
        )
        cls.set_member("__init__", constructor)
