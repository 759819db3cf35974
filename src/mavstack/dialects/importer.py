"""Import of published definition files: the facts are kept, the descriptions are not.

Importing a file again keeps the one-line description of each message that our file has, by name: our
definition files are the only source of these lines. `import_file` does not follow includes, so files can be
imported in any order.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from mavstack.atomic_file import write_file_atomically
from mavstack.dialects.includes import file_stem
from mavstack.dialects.xml_definitions import parse_definition
from mavstack.dialects.xml_reader import read_bytes
from mavstack.dialects.xml_writer import definition_xml

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.dialects.model import DialectDefinition


def read_file(path: str) -> DialectDefinition:
    """Read the definition in one file, without its includes."""
    return parse_definition(read_bytes(path), path, file_stem(path))


def descriptions_in(path: str) -> dict[str, str]:
    """Return the descriptions by message name in one of our files; none if the file does not exist."""
    if not Path(path).exists():
        return {}
    return {message.name: message.description for message in read_file(path).messages if message.description}


def import_file(source: str, target: str, descriptions: Mapping[str, str] | None = None) -> DialectDefinition:
    """Import a definition file.

    Args:
        source: Path of the published XML file.
        target: Path of our XML file, which is written.
        descriptions: Descriptions by message name, in place of those in `target`.

    Returns:
        The definition in `source`.

    Raises:
        DialectError: A file cannot be read.
        OSError: The file cannot be written; an existing one is unchanged.
    """
    definition = read_file(source)
    text = definition_xml(definition, descriptions_in(target) | dict(descriptions or {}))
    write_file_atomically(target, text)
    return definition
