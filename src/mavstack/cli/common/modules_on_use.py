"""Large modules on first use: those that asyncio, dataclasses and urllib import, and few programs call.

`ssl` costs a program without TLS five megabytes, `inspect` and the modules that it imports one, `ipaddress` a
third, `locale` and `tokenize` a fifth each. A module of a subclass with `__getattr__` stands in until one of
its attributes is read. `asyncio.sslproto` reads some of `ssl` while it is imported, so it is loaded on first
use too. `importlib.util.LazyLoader` is not lazy enough: the second import of its module reads `__spec__`, and
thereby loads it.
"""

from __future__ import annotations

import argparse
import sys
import threading
from importlib.machinery import PathFinder
from importlib.util import find_spec, module_from_spec
from types import ModuleType

_MODULES = ("ssl", "inspect", "ipaddress", "locale", "tokenize", "linecache")


class _OnUse(ModuleType):
    """A module that is executed when an attribute is read that it does not have yet."""

    _loading = threading.RLock()

    def __getattr__(self, name: str) -> object:
        with self._loading:
            if type(self) is _OnUse and self.__spec__ is not None and self.__spec__.loader is not None:
                self.__class__ = ModuleType  # type: ignore[assignment]
                self.__spec__.loader.exec_module(self)
        return getattr(self, name)


def load_modules_on_use() -> None:
    """Let large modules be loaded when they are used; call it before asyncio is imported.

    A program that has imported asyncio already is left as it is. `argparse` no longer looks for translations
    of its words, since that would load `locale` for each parser.
    """
    vars(argparse)["_"] = str
    package = find_spec("asyncio")
    if "asyncio" in sys.modules or package is None:
        return
    for name in _MODULES:
        _load_on_use(name)
    _load_on_use("asyncio.sslproto", package.submodule_search_locations)


def _load_on_use(name: str, path: list[str] | None = None) -> None:
    spec = PathFinder.find_spec(name, path)
    if spec is not None and name not in sys.modules:
        module = module_from_spec(spec)
        module.__class__ = _OnUse
        sys.modules[name] = module
