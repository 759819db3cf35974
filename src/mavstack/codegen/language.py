"""The registry of languages.

Each built-in language is an object of `Language` in a package below `mavstack.codegen.languages`, imported
when it is used. Other packages add languages by entry points of the group `mavstack.code_generators`: the
entry point has the name of the language and loads a `Language`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.plugins import Registry

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.codegen.library import Library

ENTRY_POINTS: Final = "mavstack.code_generators"

#: The built-in languages: packages below `mavstack.codegen.languages`, each with an object LANGUAGE.
LANGUAGES: Final[tuple[str, ...]] = (
    "c",
    "cpp11",
    "python",
    "typescript",
    "java",
    "lua",
    "wireshark",
    "rust",
    "go",
    "csharp",
    "swift",
)


class GeneratedFile(NamedTuple):
    """One file of a generated library.

    Attributes:
        path: Path below the output folder, with `/` between its parts.
        text: The whole text, with a line feed at the end of each line.
    """

    path: str
    text: str


class Language(NamedTuple):
    """A language for which libraries are generated.

    Attributes:
        name: Name on the command line, such as "c".
        title: Name for users, such as "C99".
        render: Yields the files of a library.
        reserved_words: Words that the language reserves; `mav dialect check` warns of fields with such names.
    """

    name: str
    title: str
    render: Callable[[Library], Iterator[GeneratedFile]]
    reserved_words: frozenset[str] = frozenset()


_REGISTRY: Final[Registry[Language]] = Registry(
    "language", ENTRY_POINTS, {name: f"mavstack.codegen.languages.{name}:LANGUAGE" for name in LANGUAGES}
)


def language_names() -> tuple[str, ...]:
    """Return the names of all languages, those of other packages included."""
    return _REGISTRY.names()


def language(name: str) -> Language:
    """Return the language of a name.

    Args:
        name: The name, such as "typescript".

    Returns:
        The language.

    Raises:
        InvalidArgumentError: There is no such language.
        MissingExtraError: The language needs Jinja2, which is not installed.
    """
    return _REGISTRY.get(name)
