"""The records of all schemes, by name: those of `mavstack.links.schemes`, and those of other packages.

The modules of built-in records are found by their place, so that a new scheme needs no entry in a list.
Another package has an entry point of the group `mavstack.links` for each of its schemes, with the name of the
scheme. It loads a `LinkScheme`; a callable that takes a `LinkURL` and its `Options` and returns a `Link` is
accepted too, and is taken for a scheme that neither listens nor is reached over a network.
"""

from __future__ import annotations

import os
from functools import cache, lru_cache
from importlib import import_module
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

from mavstack.errors import InvalidArgumentError
from mavstack.links import schemes
from mavstack.links.scheme import AddressKind, LinkScheme
from mavstack.plugins import Registry

if TYPE_CHECKING:
    from collections.abc import Mapping
    from importlib.metadata import EntryPoint

ENTRY_POINTS: Final = "mavstack.links"


@cache
def builtin_schemes() -> Mapping[str, LinkScheme]:
    """Return the records of Mavstack by name, those of networks first."""
    modules = [import_module(f"{schemes.__name__}.{name}") for name in _module_names()]
    kinds = list(AddressKind)
    records: list[LinkScheme] = [record for module in modules for record in module.SCHEMES]
    records.sort(key=lambda record: (kinds.index(record.address), "+" in record.name))
    return MappingProxyType({record.name: record for record in records})


def _module_names() -> list[str]:
    """Return the modules of the package; `pkgutil` would import `inspect`, a large module, to find them."""
    files = (os.path.splitext(file) for folder in schemes.__path__ for file in os.listdir(folder))  # noqa: PTH122, PTH208
    return sorted({name for name, suffix in files if suffix in (".py", ".pyc")} - {"__init__"})


@lru_cache(maxsize=64)  # a look-up of entry points takes milliseconds
def find_scheme(name: str) -> LinkScheme | None:
    """Return the record of a scheme; None if there is none, or its plug-in cannot be loaded."""
    return SCHEMES.find(name)


def unknown_scheme(name: str, backend: str = "") -> LinkScheme:
    """Return the record of a scheme of which only the name is known, and perhaps the backend."""
    return LinkScheme(name, backend, AddressKind.ANY, f"{name}://", "A scheme of another package.")


def _plugin_scheme(entry: EntryPoint, loaded: Any) -> LinkScheme:  # noqa: ANN401 - of another package
    if not isinstance(loaded, LinkScheme):
        if not callable(loaded):
            raise InvalidArgumentError(f"{entry.value} is a {type(loaded).__name__}, not a LinkScheme")
        return unknown_scheme(entry.name, f"{entry.module}:{entry.attr}")
    if loaded.name != entry.name:
        raise InvalidArgumentError(f"its scheme is named {loaded.name!r}, its entry point {entry.name!r}")
    return loaded


#: All URL schemes of links.
SCHEMES: Final[Registry[LinkScheme]] = Registry(
    "scheme", ENTRY_POINTS, objects=builtin_schemes, convert=_plugin_scheme
)
