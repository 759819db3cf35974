"""Registries of objects by name: built-in ones in modules, and those that other packages add.

A module is imported when its object is used first. Other packages are looked up, by entry points, only for
names that are not built in: the entry point has the name of the object and loads it.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Generic, TypeVar

from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Mapping
    from importlib.metadata import EntryPoints

Item = TypeVar("Item")


class Registry(Generic[Item]):
    """The objects of one kind.

    Args:
        noun: The kind, for errors, such as "format".
        group: Group of the entry points.
        builtin: Module and object by name, such as "mavstack.logs.formats.pcap:PCAP".
    """

    def __init__(self, noun: str, group: str, builtin: Mapping[str, str]) -> None:
        self._noun = noun
        self._group = group
        self._builtin = dict(builtin)

    def names(self) -> tuple[str, ...]:
        """Return all names, those of other packages last."""
        return (*self._builtin, *sorted(self.plugins().names - self._builtin.keys()))

    def plugins(self) -> EntryPoints:
        """Return the entry points of other packages."""
        from importlib.metadata import entry_points

        return entry_points(group=self._group)

    def get(self, name: str) -> Item:
        """Return the object of a name; a built-in one takes precedence.

        Raises:
            InvalidArgumentError: There is no such object.
        """
        if name in self._builtin:
            module, attribute = self._builtin[name].split(":")
            builtin: Item = getattr(import_module(module), attribute)
            return builtin
        found = self.plugins()
        if name not in found.names:
            raise InvalidArgumentError(f"{self._noun} must be one of {', '.join(self.names())}, got {name!r}")
        plugin: Item = found[name].load()
        return plugin
