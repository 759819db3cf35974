"""Registries of objects by name: built-in ones in modules, and those that other packages add.

A module is imported when its object is used first. Other packages are looked up, by entry points, only for
names that are not built in: the entry point has the name of the object and loads it.

A plug-in that cannot be loaded, is not of the right kind or has a name that is taken is left out: one warning
names it, with its package and the reason, and everything else works without it. It is an error only for the
caller that asks for it by its name.
"""

from __future__ import annotations

import os
import sys
from importlib import import_module
from importlib.machinery import PathFinder
from typing import TYPE_CHECKING, Any, Final, Generic, TypeVar

from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from importlib.metadata import EntryPoint, EntryPoints
    from pathlib import Path

Item = TypeVar("Item")
#: The ends of the folders with the metadata of distributions, and of their parents in old ones.
_METADATA: Final = (".dist-info", ".egg-info", "EGG-INFO")


class Registry(Generic[Item]):
    """The objects of one kind.

    Args:
        noun: The kind, for errors, such as "format".
        group: Group of the entry points.
        builtin: Module and object by name, such as "mavstack.logs.formats.pcap:PCAP".
        objects: Returns built-in objects that need no import, by name; None: there are none.
        convert: Makes the item of a plug-in from its entry point and the object that was loaded, and raises
            `InvalidArgumentError` if the object is not of the right kind; None: the object is the item.
        report: Called with one line for each plug-in that is left out; None: a warning is logged.
    """

    def __init__(
        self,
        noun: str,
        group: str,
        builtin: Mapping[str, str] | None = None,
        *,
        objects: Callable[[], Mapping[str, Item]] | None = None,
        convert: Callable[[EntryPoint, Any], Item] | None = None,
        report: Callable[[str], None] | None = None,
    ) -> None:
        self._noun = noun
        #: The group of entry points in the metadata of distributions.
        self.group = group
        self._builtin = dict(builtin or {})
        self._objects = objects
        self._convert = convert
        self._report = report or _log_warning
        self._left_out: set[str] = set()

    def names(self) -> tuple[str, ...]:
        """Return all names, those of other packages last; some of these may fail to load."""
        return (*self.builtin_names(), *self._plugin_names())

    def builtin_names(self) -> tuple[str, ...]:
        """Return the names of the built-in objects."""
        return (*self._builtin, *(self._objects() if self._objects else ()))

    def plugins(self) -> EntryPoints:
        """Return the entry points of other packages."""
        from importlib.metadata import EntryPoints, entry_points

        return entry_points(group=self.group) if _may_be_declared(self.group) else EntryPoints()

    def get(self, name: str) -> Item:
        """Return the object of a name; a built-in one takes precedence.

        Raises:
            InvalidArgumentError: There is no such object, or its plug-in cannot be loaded.
        """
        item = self._built_in(name)
        if item is not None:
            return item
        found = self.plugins()
        if name not in found.names:
            raise InvalidArgumentError(f"{self._noun} must be one of {', '.join(self.names())}, got {name!r}")
        try:
            return self._load(found[name])
        except Exception as error:
            self._leave_out(found[name], error)
            raise InvalidArgumentError(
                f"loading the {self._noun} {_name(found[name])} failed: {_reason(error)}"
            ) from error

    def find(self, name: str) -> Item | None:
        """Return the object of a name; None if there is none, or its plug-in cannot be loaded."""
        item = self._built_in(name)
        if item is not None:
            return item
        entry = next(iter(self.plugins().select(name=name)), None)
        return None if entry is None else self._load_or_leave_out(entry)

    def items(self) -> Iterator[tuple[str, Item]]:
        """Yield all names and objects, the built-in ones first, without plug-ins that cannot be loaded."""
        for name in self.builtin_names():
            yield name, self.get(name)
        yield from self.plugin_items()

    def plugin_items(self) -> Iterator[tuple[str, Item]]:
        """Yield names and objects of other packages, sorted, without those that cannot be loaded."""
        found, taken = self.plugins(), set(self.builtin_names())
        for name in sorted(found.names):
            if name in taken:
                self._leave_out(
                    found[name], InvalidArgumentError(f"there is a {self._noun} {name!r} already")
                )
            elif (item := self._load_or_leave_out(found[name])) is not None:
                yield name, item

    def _plugin_names(self) -> list[str]:
        return sorted(self.plugins().names - set(self.builtin_names()))

    def _built_in(self, name: str) -> Item | None:
        if name in self._builtin:
            module, attribute = self._builtin[name].split(":")
            builtin: Item = getattr(import_module(module), attribute)
            return builtin
        return self._objects().get(name) if self._objects else None

    def _load(self, entry: EntryPoint) -> Item:
        loaded = entry.load()
        item: Item = self._convert(entry, loaded) if self._convert else loaded
        return item

    def _load_or_leave_out(self, entry: EntryPoint) -> Item | None:
        try:
            return self._load(entry)
        except Exception as error:  # noqa: BLE001 - the code of another package may raise anything
            self._leave_out(entry, error)
            return None

    def _leave_out(self, entry: EntryPoint, error: Exception) -> None:
        if entry.name not in self._left_out:
            self._left_out.add(entry.name)
            self._report(f"plug-in {_name(entry)} was left out: {_reason(error)}")


def _may_be_declared(group: str) -> bool:
    """Return whether a distribution may have entry points of a group.

    `importlib.metadata` parses all metadata of all distributions, which took a quarter of the start of some
    commands. Almost always no distribution names the group, and a search for its name shows that.
    """
    if any(finder is not PathFinder and hasattr(finder, "find_distributions") for finder in sys.meta_path):
        return True
    section = f"[{group}]".encode()
    return any(_may_declare(path or ".", section) for path in sys.path)


def _may_declare(path: str, section: bytes) -> bool:
    from pathlib import Path  # takes longer than a generator of code

    try:
        with os.scandir(path) as entries:
            folders = [entry.path for entry in entries if entry.name.endswith(_METADATA)]
    except NotADirectoryError:
        return True  # an archive
    except OSError:
        return False
    return any(_is_in(section, Path(folder, "entry_points.txt")) for folder in folders)


def _is_in(section: bytes, file: Path) -> bool:
    try:
        return section in file.read_bytes()
    except OSError:
        return False


def _name(entry: EntryPoint) -> str:
    return f"{entry.name} of {entry.dist.name}" if entry.dist is not None else entry.name


def _reason(error: Exception) -> str:
    text = " ".join(str(error).split())
    return text if isinstance(error, InvalidArgumentError) else f"{type(error).__name__}: {text}"


def _log_warning(line: str) -> None:
    # The import of logging takes longer than a command that only looks up built-in objects.
    import logging

    logging.getLogger("mavstack.plugins").warning(line)
