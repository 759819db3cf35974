"""From a definition file as published to one of ours: the facts stay, the prose goes.

Importing again over a file keeps the line that each of its messages has, by name: our definition files are
the only home of these lines. `import_file` follows no includes, so files may come in any order.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from mavstack.dialects.includes import file_stem
from mavstack.dialects.xml_definitions import parse_definition
from mavstack.dialects.xml_reader import read_bytes
from mavstack.dialects.xml_writer import definition_xml

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.dialects.model import DialectDefinition


def read_file(path: str) -> DialectDefinition:
    """What one file says itself."""
    return parse_definition(read_bytes(path), path, file_stem(path))


def descriptions_in(path: str) -> dict[str, str]:
    """The line of each message in one of our own files; nothing if the file is not there."""
    if not Path(path).exists():
        return {}
    return {message.name: message.description for message in read_file(path).messages if message.description}


def import_file(source: str, target: str, descriptions: Mapping[str, str] | None = None) -> DialectDefinition:
    """Write the facts of `source` to `target`; given descriptions win over those that `target` has."""
    definition = read_file(source)
    text = definition_xml(definition, descriptions_in(target) | dict(descriptions or {}))
    Path(target).write_text(text, encoding="utf-8", newline="\n")
    return definition
