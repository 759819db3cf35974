"""The files of a Python package, and their templates.

The package runs on CPython and on MicroPython: it imports only `struct`, `hashlib` and `binascii`, and has
classes with `__slots__` instead of data classes, and annotations that only name built-in types.
"""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.codegen.identifiers import enum_members, type_names
from mavstack.codegen.language import GeneratedFile, Language
from mavstack.codegen.languages.python.classes import RESERVED_WORDS, enum_class, message_class
from mavstack.codegen.languages.python.tables import field_table
from mavstack.codegen.templates import Templates
from mavstack.dialects.names import to_identifier
from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.codegen.library import DialectFile, Library

#: Modules that are the same for every dialect.
_RUNTIME: Final = ("_checksum", "_codec", "_message", "_packet", "_parser", "_signing")


class Names(NamedTuple):
    """The names of the classes, by the official names of messages and enums."""

    messages: dict[str, str]
    enums: dict[str, str]

    @classmethod
    def of(cls, library: Library) -> Names:
        """Return the names of a library."""
        messages = type_names((message.name for message in library.messages), {"Message", "Struct"})
        return cls(messages, type_names(enum.name for enum in library.enums))


def render(library: Library) -> Iterator[GeneratedFile]:
    """Yield the files of a package."""
    templates, package, names = _templates(), _package_name(library), Names.of(library)
    values = {
        "library": library,
        "package": package,
        "distribution": package.replace("_", "-"),
        "count": len(library.messages),
        "first": names.messages[library.messages[0].name],
    }
    for name in ("README.md", "pyproject.toml"):
        yield templates.file(name, f"{name}.j2", **values)
    for name in ("__init__.py", "py.typed", *(f"{name}.py" for name in _RUNTIME)):
        yield templates.file(f"{package}/{name}", f"{name}.j2", **values)
    members = enum_members(library)
    enums = "".join(
        templates.text("enum_class.py.j2", enum=enum_class(enum, names.enums[enum.name], members[enum.name]))
        for enum in library.enums
    )
    yield templates.file(f"{package}/enums.py", "enums.py.j2", classes=enums, **values)
    rows = "\n    ".join(field_table(library))
    yield templates.file(f"{package}/info.py", "info.py.j2", rows=rows, **values)
    yield _all_messages(library, f"{package}/messages/__init__.py")
    for file in library.files:
        if file.messages:
            path = f"{package}/messages/{_module_name(file)}.py"
            yield _messages_of_file(library, file, names, path)


def _all_messages(library: Library, path: str) -> GeneratedFile:
    names = [_module_name(file) for file in library.files if file.messages]
    return _templates().file(
        path,
        "messages.py.j2",
        library=library,
        star_imports="\n".join(f"from .{name} import *" for name in names),
        imports="\n".join(f"from .{name} import MESSAGES as _{name}" for name in names),
        tables=", ".join(f"_{name}" for name in names),
    )


def _messages_of_file(library: Library, file: DialectFile, names: Names, path: str) -> GeneratedFile:
    messages = [
        message_class(item, names.messages[item.name], names.enums, library.version) for item in file.messages
    ]
    return _templates().file(
        path,
        "messages_of_file.py.j2",
        library=library,
        file=file,
        exports=",\n    ".join(f'"{message.name}"' for message in messages),
        names=",\n    ".join(message.name for message in messages),
        classes="".join(_templates().text("message_class.py.j2", message=message) for message in messages),
    )


def _module_name(file: DialectFile) -> str:
    return _identifier(file.name.lower())


def _identifier(name: str) -> str:
    """Return the name of a module for that of a file, which may have any characters."""
    return to_identifier(re.sub(r"\W+", "_", name).strip("_"), RESERVED_WORDS)


@cache
def _templates() -> Templates:
    return Templates(__name__.rpartition(".")[0])


def _package_name(library: Library) -> str:
    name = library.package or _identifier(f"mavlink_{library.name}")
    if not name.isidentifier() or name in RESERVED_WORDS:
        raise InvalidArgumentError(f"package must be the name of a Python package, got {name!r}")
    return name


LANGUAGE: Final = Language("python", "Python, standalone", render, RESERVED_WORDS)
