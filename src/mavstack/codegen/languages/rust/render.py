"""The files of a crate."""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING, Final

from mavstack.codegen.languages.rust.types import enum_types, enum_values, message_types, message_values
from mavstack.codegen.templates import Templates
from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.codegen.language import GeneratedFile
    from mavstack.codegen.library import Library

#: Files of the runtime, which contain nothing from the dialect except its names.
_RUNTIME: Final = ("crc", "encode", "info", "packet", "parser", "scan", "sha256", "signing", "wire")


def render(library: Library) -> Iterator[GeneratedFile]:
    """Yield the files of a crate.

    Args:
        library: The library.

    Yields:
        The files.

    Raises:
        InvalidArgumentError: The chosen package name is not a crate's name.
    """
    templates = _templates()
    types = enum_types(library)
    enums = list(enum_values(library, types))
    names = message_types(library)
    messages = [message_values(message, names[message.name], types) for message in library.messages]
    common = {"stamp": library.stamp, **_names(library), "example": _example(messages)}
    yield templates.file("Cargo.toml", "Cargo.toml.j2", **common)
    yield templates.file("README.md", "README.md.j2", **common)
    yield templates.file("src/lib.rs", "lib.rs.j2", version=library.version, **common)
    yield templates.file("src/message.rs", "message.rs.j2", messages=messages, **common)
    yield templates.file("src/messages/mod.rs", "messages.rs.j2", messages=messages, **common)
    yield templates.file("src/enums/mod.rs", "enums.rs.j2", enums=enums, **common)
    for name in _RUNTIME:
        yield templates.file(f"src/{name}.rs", f"{name}.rs.j2", **common)
    for message in messages:
        yield templates.file(
            f"src/messages/{message['module']}.rs", "struct.rs.j2", stamp=library.stamp, **message
        )
    for enum in enums:
        yield templates.file(f"src/enums/{enum['module']}.rs", "enum.rs.j2", stamp=library.stamp, **enum)


@cache
def _templates() -> Templates:
    return Templates("mavstack.codegen.languages.rust")


def package_name(library: Library) -> str:
    """Return the name of the package: the chosen one, or `mavlink-` and the dialect."""
    if not library.package:
        return f"mavlink-{re.sub('[^a-z0-9]+', '-', library.name).strip('-')}"
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_-]*", library.package):
        raise InvalidArgumentError(f"package must be a name such as mavlink-common, got {library.package!r}")
    return library.package


def _names(library: Library) -> dict[str, str]:
    """Return the names of the package, of the crate and of the dialect."""
    package = package_name(library)
    return {"package_name": package, "crate_name": package.replace("-", "_"), "dialect": library.name}


def _example(messages: list[dict[str, object]]) -> dict[str, object]:
    """Return the message of the examples: HEARTBEAT if there is one."""
    return next((message for message in messages if message["name"] == "HEARTBEAT"), messages[0])
