"""The whole MAVLink system: `mavstack.connect`, `Vehicle`, `Node`, `Parser`, `open_log` and the rest.

Names are imported on first use (PEP 562), so that `import mavstack` costs next to nothing. They are listed in
the stub of this module, which type checkers read too.
"""

from __future__ import annotations

from importlib import import_module

__version__ = "0.1.0"


_MODULES: dict[str, str] = {}  # the module of each public name, filled on first use


def _modules() -> dict[str, str]:
    """Return the module of each name, from the lines `from module import name as name` of the stub."""
    if not _MODULES:
        text = __loader__.get_data(f"{__path__[0]}/__init__.pyi").decode()
        lines = (line.split() for line in text.splitlines() if line.startswith("from "))
        _MODULES.update((words[-1], words[1]) for words in lines)
    return _MODULES


def __getattr__(name: str) -> object:
    if name == "__all__":
        return sorted(_modules())
    module = _modules().get(name)
    if module is None:
        raise AttributeError(f"module 'mavstack' has no attribute {name!r}")
    value = getattr(import_module(module), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_modules(), "__all__"})
