"""Reading files of parameter metadata of any known form; they come from outside and are not trusted.

| file | from |
|---|---|
| parameters.json, .json.xz | PX4, and any component (parameter.schema.json) |
| parameters.xml | PX4 |
| apm.pdef.json | ArduPilot |
| apm.pdef.xml, .xml.gz, .xml.xz | ArduPilot |

The form follows from the content. Documents with entities are refused, as in dialects.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from mavstack.bounded_file import read_file_bounded
from mavstack.dialects.xml_reader import read_tree
from mavstack.errors import DialectError, MetadataError
from mavstack.files.parameter_metadata import ardupilot_json, ardupilot_xml, component_json, px4_xml
from mavstack.services.component_metadata import MAX_CONTENT, parse_json, unpack_content
from mavstack.services.parameters.metadata import MetadataTable

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.dialects.xml_reader import Element
    from mavstack.services.parameters.metadata import ParameterMetadata

    Document: TypeAlias = dict[str, Any]
    Entries: TypeAlias = Iterator[ParameterMetadata]

#: The function that recognises each JSON form, and the function that reads it.
_JSON_FORMS: Final[tuple[tuple[Callable[[Document], bool], Callable[[Document], Entries]], ...]] = (
    (component_json.recognises, component_json.read),
    (ardupilot_json.recognises, ardupilot_json.read),
)
_XML_FORMS: Final[tuple[tuple[Callable[[Element], bool], Callable[[Element], Entries]], ...]] = (
    (ardupilot_xml.recognises, ardupilot_xml.read),
    (px4_xml.recognises, px4_xml.read),
)
_BYTE_ORDER_MARK: Final = b"\xef\xbb\xbf"


def read_parameter_metadata(path: str | os.PathLike[str]) -> MetadataTable:
    """Read a file of parameter metadata: ArduPilot's apm.pdef.xml or .json, PX4's parameters.xml or .json.

    Args:
        path: The file; it may be compressed with xz or gzip.

    Returns:
        The metadata by parameter name.

    Raises:
        MetadataError: The content is not metadata of parameters; the error holds the line, if there is one.
        OSError: The file cannot be read.
    """
    return parse_parameter_metadata(read_metadata_file(path), os.fspath(path))


def read_metadata_file(path: str | os.PathLike[str]) -> bytes:
    """Return the bytes of a file, or its beginning if it is larger than any metadata.

    Args:
        path: The file.

    Raises:
        OSError: The file cannot be read.
    """
    return read_file_bounded(path, MAX_CONTENT + 1)


def parse_parameter_metadata(data: bytes, source: str) -> MetadataTable:
    """Read parameter metadata from the bytes of a file.

    Args:
        data: The file; it may be compressed with xz or gzip.
        source: Where it comes from, for the table and for errors.

    Returns:
        The metadata by parameter name.

    Raises:
        MetadataError: The content is not metadata of parameters.
    """
    try:
        table = MetadataTable(_entries(unpack_content(data)), source)
    except (MetadataError, DialectError) as error:
        raise MetadataError(error.problem, source, error.line) from None
    if not table:
        raise MetadataError("it describes no parameter", source)
    return table


def _entries(content: bytes) -> Entries:
    start = content.removeprefix(_BYTE_ORDER_MARK).lstrip()[:1]
    if start == b"<":
        root = read_tree(content, "")
        for recognises_root, read_root in _XML_FORMS:
            if recognises_root(root):
                return read_root(root)
        raise MetadataError(f"<{root.tag[:40]}> is not the root of a file of parameter metadata")
    if start == b"{":
        document = parse_json(content)
        for recognises, read in _JSON_FORMS:
            if recognises(document):
                return read(document)
        raise MetadataError("the JSON describes no parameter")
    raise MetadataError("it is neither XML nor JSON, so it is not a file of parameter metadata")
