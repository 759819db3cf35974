"""The files of a Swift package."""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING, Final

from mavstack.codegen.languages.swift.types import enum_types, enum_values, message_types, message_values
from mavstack.codegen.templates import Templates
from mavstack.dialects.names import class_name
from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.codegen.language import GeneratedFile
    from mavstack.codegen.library import Library

_RUNTIME: Final = (
    "Checksum",
    "Message",
    "MessageEncoder",
    "Packet",
    "Parser",
    "Payload",
    "SHA256",
    "Signing",
)


def render(library: Library) -> Iterator[GeneratedFile]:
    """Yield the files of a package.

    Args:
        library: The library.

    Yields:
        The files.

    Raises:
        InvalidArgumentError: The chosen name is not that of a Swift module.
    """
    templates = _templates()
    types = enum_types(library)
    names = message_types(library)
    messages = [message_values(message, names[message.name], types) for message in library.messages]
    example = next((message for message in messages if message["name"] == "HEARTBEAT"), messages[0])
    module, stamp = module_name(library), library.stamp
    values = {"stamp": stamp, "dialect": library.name, "module": module, "example": example}
    sources = f"Sources/{module}"
    yield templates.file("Package.swift", "Package.swift.j2", **values)
    yield templates.file("README.md", "README.md.j2", **values)
    yield templates.file(
        f"{sources}/Dialect.swift", "Dialect.swift.j2", messages=messages, version=library.version, **values
    )
    for name in _RUNTIME:
        yield templates.file(f"{sources}/{name}.swift", f"{name}.swift.j2", **values)
    # A module must not have two files with the same name, so the names of messages and enums get a suffix.
    for message in messages:
        path = f"{sources}/Messages/{message['type']}Message.swift"
        yield templates.file(path, "MessageStruct.swift.j2", stamp=stamp, **message)
    for enum in enum_values(library, types):
        path = f"{sources}/Enums/{enum['type']}Values.swift"
        yield templates.file(path, "Enum.swift.j2", stamp=stamp, **enum)


def module_name(library: Library) -> str:
    """Return the name of the module: the chosen one, or `Mavlink` and the dialect."""
    name = library.package or f"Mavlink{class_name(re.sub('[^A-Za-z0-9]+', '_', library.name).strip('_'))}"
    if not re.fullmatch(r"[A-Za-z_]\w*", name, re.ASCII):
        raise InvalidArgumentError(f"package must be a name such as MavlinkCommon, got {name!r}")
    return name


@cache
def _templates() -> Templates:
    return Templates("mavstack.codegen.languages.swift")
