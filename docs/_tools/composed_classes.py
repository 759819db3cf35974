"""A griffe extension: calls that a class binds, and parts, are shown as its methods and properties."""

from __future__ import annotations

import copy
from types import FunctionType
from typing import Any

import griffe

from mavstack.node.parts import Part
from mavstack.sync.classes import wrapped_classes


class ComposedClasses(griffe.Extension):
    """Give each class of the API the methods that it binds and the properties of its parts."""

    def on_package(self, *, loader: Any, **_: Any) -> None:  # noqa: ANN401 (the interface of griffe)
        """Replace the attributes of the classes."""
        modules = loader.modules_collection
        for kind in wrapped_classes().values():
            for name, value in vars(kind).items():
                found = _member(name, value, modules)
                if found is not None:
                    modules[kind.__module__][kind.__name__].set_member(name, found)


def _member(
    name: str, value: object, modules: griffe.ModulesCollection
) -> griffe.Function | griffe.Attribute | None:
    """Return the method or property for an attribute of a class; None for a method that is defined in it."""
    if isinstance(value, FunctionType) and value.__qualname__ == value.__name__:
        function: griffe.Function = copy.copy(modules[f"{value.__module__}.{value.__name__}"])
        first = griffe.Parameter("self", kind=griffe.ParameterKind.positional_or_keyword)
        function.parameters = griffe.Parameters(first, *list(function.parameters)[1:])
        function.name = name
        return function
    if isinstance(value, Part):
        attribute = griffe.Attribute(name, docstring=griffe.Docstring(value.__doc__ or ""))
        attribute.annotation = griffe.ExprName(value.kind.__name__, parent=modules[value.kind.__module__])
        attribute.labels = {"property"}
        return attribute
    return None
