"""A language from another package, for tests of the registry, the output and the command."""

from __future__ import annotations

import sys
from importlib.metadata import EntryPoint, EntryPoints
from typing import TYPE_CHECKING

import pytest

from mavstack.codegen import ENTRY_POINTS, GeneratedFile, Language

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.codegen import Library


def render(library: Library) -> Iterator[GeneratedFile]:
    for message in reversed(library.messages):
        yield GeneratedFile(f"messages/{message.name.lower()}.txt", f"{library.stamp}\n{message.name}\n")
    yield GeneratedFile("README.md", f"# {library.package or library.name}\n")


def escaping(_library: Library) -> Iterator[GeneratedFile]:
    yield GeneratedFile("../outside.txt", "text\n")


def absolute(_library: Library) -> Iterator[GeneratedFile]:
    yield GeneratedFile("/etc/outside.txt", "text\n")


def doubled(_library: Library) -> Iterator[GeneratedFile]:
    yield GeneratedFile("a.txt", "1\n")
    yield GeneratedFile("a.txt", "2\n")


TEXT = Language("text", "Plain text", render, reserved_words=frozenset({"roll"}))
ESCAPING = Language("escaping", "Files elsewhere", escaping)
ABSOLUTE = Language("absolute", "Files elsewhere", absolute)
DOUBLED = Language("doubled", "Files twice", doubled)
#: The module, not the function of that name.
registry = sys.modules["mavstack.codegen.language"]
NAMES = ("text", "escaping", "absolute", "doubled")


@pytest.fixture
def plugins(monkeypatch):
    """Make the languages of this module those of an installed package."""
    found = EntryPoints(EntryPoint(name, f"{__name__}:{name.upper()}", ENTRY_POINTS) for name in NAMES)
    monkeypatch.setattr(registry._REGISTRY, "plugins", lambda: found)
    return found
