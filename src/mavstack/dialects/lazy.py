"""Lazy attributes of dialect modules: classes are created when they are first accessed."""

from __future__ import annotations

import sys

from mavstack.dialects.dialect import Dialect

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path


def module_attributes(module: str, name: str) -> tuple[Callable[[str], object], Callable[[], list[str]]]:
    """Return `__getattr__` and `__dir__` of the module of an official dialect."""
    return _module_attributes(module, lambda: Dialect.load(name))


def file_module_attributes(
    module: str, path: Path
) -> tuple[Callable[[str], object], Callable[[], list[str]]]:
    """Return `__getattr__` and `__dir__` of the module of a user's dialect.

    Args:
        module: Name of the module.
        path: The definition file.
    """
    return _module_attributes(module, lambda: Dialect.from_xml(path))


def _module_attributes(
    module: str, load: Callable[[], Dialect]
) -> tuple[Callable[[str], object], Callable[[], list[str]]]:
    def get(attribute: str) -> object:
        if attribute.startswith("__") and attribute != "__all__":
            # The import system reads attributes such as `__path__`, which must not load the dialect.
            raise AttributeError(f"module {module!r} has no attribute {attribute!r}", name=attribute)
        dialect = load()
        value = _attribute(dialect, attribute)
        if value is None:
            raise AttributeError(
                f"dialect {dialect.name} has no message or enum class {attribute!r}", name=attribute
            )
        setattr(sys.modules[module], attribute, value)
        return value

    def names() -> list[str]:
        return sorted([*_class_names(load()), "core_dialect", "dialect"])

    return get, names


def _attribute(dialect: Dialect, attribute: str) -> object:
    if attribute == "core_dialect":
        return dialect.core_dialect
    if attribute == "dialect":
        return dialect
    if attribute == "__all__":
        return sorted(_class_names(dialect))
    if attribute in dialect.messages_by_class:
        return dialect[dialect.messages_by_class[attribute]]
    official = dialect.enums_by_class.get(attribute)
    return None if official is None else dialect.enums[official]


def _class_names(dialect: Dialect) -> set[str]:
    return dialect.messages_by_class.keys() | dialect.enums_by_class.keys()
