"""The registry of languages.

Each built-in language is an object of `Language` in a package below `mavstack.codegen.languages`, imported
when it is used. Other packages add languages by entry points of the group `mavstack.code_generators`: the
entry point has the name of the language and loads a `Language`.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from importlib.metadata import EntryPoints

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


@dataclass(frozen=True, slots=True)
class GeneratedFile:
    """One file of a generated library.

    Attributes:
        path: Path below the output folder, with `/` between its parts.
        text: The whole text, with a line feed at the end of each line.
    """

    path: str
    text: str


@dataclass(frozen=True)
class Language:
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


def language_names() -> tuple[str, ...]:
    """Return the names of all languages, those of other packages included."""
    return (*LANGUAGES, *sorted(_plugins().names - set(LANGUAGES)))


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
    if name in LANGUAGES:
        builtin: Language = import_module(f"mavstack.codegen.languages.{name}").LANGUAGE
        return builtin
    found = _plugins()
    if name not in found.names:
        raise InvalidArgumentError(f"language must be one of {', '.join(language_names())}, got {name!r}")
    plugin: Language = found[name].load()
    return plugin


def _plugins() -> EntryPoints:
    from importlib.metadata import entry_points

    return entry_points(group=ENTRY_POINTS)
