"""The files of a library in C++11."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.codegen.language import Language
from mavstack.codegen.languages.c.render import runtime_files
from mavstack.codegen.languages.c.reserved import RESERVED
from mavstack.codegen.languages.cpp11.dialects import dialect_parts
from mavstack.codegen.languages.cpp11.messages import message_parts
from mavstack.codegen.templates import Templates

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.codegen.language import GeneratedFile
    from mavstack.codegen.library import Library


def render(library: Library) -> Iterator[GeneratedFile]:
    """Yield the files of a library: the runtime, and a folder for each definition file."""
    yield from runtime_files(Templates("mavstack.codegen.languages.c", library=library), library)
    templates = Templates("mavstack.codegen.languages.cpp11", library=library)
    yield templates.file("message.hpp", "message.hpp.j2")
    yield templates.file("msgmap.hpp", "msgmap.hpp.j2")
    for file in library.files:
        parts = dialect_parts(library, file)
        yield templates.file(f"{file.name}/{file.name}.hpp", "dialect.hpp.j2", file=parts)
        yield templates.file(f"{file.name}/parser.hpp", "parser.hpp.j2", file=parts)
        yield templates.file(f"{file.name}/visit.hpp", "visit.hpp.j2", file=parts)
        for message in file.messages:
            path = f"{file.name}/mavlink_msg_{message.name.lower()}.hpp"
            values = message_parts(message, library.version)
            yield templates.file(path, "mavlink_msg.hpp.j2", m=message, v=values, dialect=parts.namespace)


LANGUAGE: Final = Language("cpp11", "C++11", render, RESERVED)
