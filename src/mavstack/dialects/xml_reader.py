"""XML parsing to a small tree with line numbers, safe for malformed or malicious files.

Only elements, attributes and text are read. A document type declaration is refused, so that there are no
entities to expand and no external files to fetch; size, depth and number of elements are limited. Every
problem is a `DialectError` with the file and the line.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NoReturn
from xml.parsers import expat

from mavstack.bounded_file import read_file_bounded
from mavstack.errors import DialectError

if TYPE_CHECKING:
    from collections.abc import Iterator

MAX_FILE_BYTES = 16 * 1024 * 1024
MAX_DEPTH = 16
MAX_ELEMENTS = 500_000


class Element:
    """An XML element: its attributes, children, text and line."""

    __slots__ = ("attributes", "children", "line", "tag", "texts")

    def __init__(self, tag: str, attributes: dict[str, str], line: int) -> None:
        self.tag = tag
        self.attributes = attributes
        self.line = line
        self.children: list[Element] = []
        self.texts: list[str] = []

    @property
    def text(self) -> str:
        """The text directly in this element, with stripped lines."""
        text = "".join(self.texts).strip()
        if text.isprintable():
            return text  # a printable text has no line ends
        return "\n".join([line.strip() for line in text.splitlines()])

    def named(self, tag: str) -> Iterator[Element]:
        """Return the direct children with a tag."""
        return (child for child in self.children if child.tag == tag)

    def first(self, tag: str) -> Element | None:
        """Return the first direct child with a tag, or None."""
        for child in self.children:
            if child.tag == tag:
                return child
        return None


class _TreeBuilder:
    """The expat handlers."""

    def __init__(self, path: str) -> None:
        self.path = path
        self.parser = expat.ParserCreate()
        self.parser.buffer_text = True
        self.parser.StartElementHandler = self.start
        self.parser.EndElementHandler = self.end
        self.parser.CharacterDataHandler = self.characters
        self.parser.StartDoctypeDeclHandler = self.doctype
        self.parser.EntityDeclHandler = self.doctype
        self.root: Element | None = None
        self.open: list[Element] = []
        self.count = 0

    def fail(self, problem: str) -> NoReturn:
        raise DialectError(problem, self.path, self.parser.CurrentLineNumber)

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        self.count += 1
        if self.count > MAX_ELEMENTS:
            self.fail(f"more than {MAX_ELEMENTS} elements")
        parents = self.open
        if len(parents) >= MAX_DEPTH:
            self.fail(f"elements nested deeper than {MAX_DEPTH}")
        element = Element(tag, attributes, self.parser.CurrentLineNumber)
        if parents:
            parents[-1].children.append(element)
        else:
            self.root = element
        parents.append(element)

    def end(self, _tag: str) -> None:
        self.open.pop()

    def characters(self, text: str) -> None:
        if self.open:
            self.open[-1].texts.append(text)

    def doctype(self, *_: object) -> None:
        self.fail("document type and entity declarations are not allowed")


def read_tree(data: bytes, path: str) -> Element:
    """Parse an XML document; return its root element."""
    if len(data) > MAX_FILE_BYTES:
        raise DialectError(f"larger than {MAX_FILE_BYTES} bytes", path)
    if not data.strip():
        raise DialectError("the file is empty", path, 1)
    builder = _TreeBuilder(path)
    try:
        builder.parser.Parse(data, True)
    except expat.ExpatError as error:
        raise _syntax_error(error, data, path) from None
    except (LookupError, ValueError) as error:
        raise DialectError(f"cannot be decoded: {error}", path, 1) from None
    if builder.root is None:
        raise DialectError("the file has no element", path, 1)
    return builder.root


def _syntax_error(error: expat.ExpatError, data: bytes, path: str) -> DialectError:
    """Convert an error of expat; an undecodable byte is reported as such."""
    if b"encoding=" not in data[:200]:
        try:
            data.decode()
        except UnicodeDecodeError as undecodable:
            return DialectError("not UTF-8 text", path, data.count(b"\n", 0, undecodable.start) + 1)
    return DialectError(f"not well-formed XML: {expat.ErrorString(error.code)}", path, error.lineno)


def read_bytes(path: str) -> bytes:
    """Read a definition file."""
    try:
        return read_file_bounded(path, MAX_FILE_BYTES + 1)
    except FileNotFoundError:
        raise DialectError("no such file", path) from None
    except (OSError, ValueError) as error:
        raise DialectError(f"cannot be read: {getattr(error, 'strerror', None) or error}", path) from None
