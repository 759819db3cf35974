"""Each public name, and each name that documentation and examples import, has an entry in the reference."""

from __future__ import annotations

import ast
import inspect
import re
from importlib import import_module
from typing import TYPE_CHECKING

from tests.docs.blocks import BLOCKS, ROOT, pages

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import ModuleType

_DIRECTIVE = re.compile(r"^::: (\S+)\n(?P<options>(?:    .*\n|\n)*)", re.MULTILINE)
#: Modules whose names have other pages: messages and enums, MSP messages, and the blocking copies of classes.
_GENERATED = ("mavstack.dialects.", "mavstack.msp.messages", "mavstack.sync")

#: Packages whose own packages are public too; those of other packages are parts of the implementation.
_DEEP = ("mavstack.files", "mavstack.logs", "mavstack.router", "mavstack.security", "mavstack.vehicle")
#: Packages without entries: the blocking copies of documented classes, and commands.
_WITHOUT_ENTRIES = ("mavstack.sync", "mavstack.cli")


def resolve(path: str) -> object:
    """Return a module, or an attribute of a module or class."""
    found: object = None
    parts = path.split(".")
    for length in range(len(parts), 0, -1):
        try:
            found = import_module(".".join(parts[:length]))
        except ImportError:
            continue
        for part in parts[length:]:
            found = getattr(found, part)
        return found
    raise ImportError(path)


def members(module: ModuleType, options: str) -> Iterator[object]:
    """The public names of a module, which its directive shows; with `members:` only these."""
    chosen = re.search(r"members: \[([^\]]*)\]", options)
    names = chosen[1].split(", ") if chosen else getattr(module, "__all__", vars(module))
    for name in names:
        value = getattr(module, name)
        if not name.startswith("_") and not inspect.ismodule(value):
            yield value


def documented() -> set[int]:
    """The objects with entries."""
    found: set[int] = set()
    for path in pages():
        for directive in _DIRECTIVE.finditer(path.read_text("utf-8")):
            value = resolve(directive[1])
            found |= {id(value)}
            if inspect.ismodule(value):
                found |= {id(each) for each in members(value, directive["options"])}
    return found


def imported() -> set[tuple[str, str]]:
    """The names that programs of the documentation and the examples import from Mavstack."""
    texts = [block.text for block in BLOCKS if block.language == "python"]
    texts += [path.read_text("utf-8") for path in (ROOT / "examples").rglob("*.py")]
    found = set()
    for text in texts:
        try:
            tree = ast.parse(text)
        except SyntaxError:  # the inside of a coroutine
            tree = ast.parse("async def main():\n" + re.sub("^", "    ", text, flags=re.MULTILINE))
        found |= {
            (node.module, alias.name)
            for node in ast.walk(tree)
            if isinstance(node, ast.ImportFrom)
            and node.module
            and node.module.partition(".")[0] == "mavstack"
            for alias in node.names
        }
    return found


def public_packages() -> Iterator[ModuleType]:
    """The packages whose `__all__` is the public API."""
    source = ROOT / "src" / "mavstack"
    yield import_module("mavstack")
    for path in sorted(source.glob("*/__init__.py")) + sorted(source.glob("*/*/__init__.py")):
        names = ["mavstack", *path.parent.relative_to(source).parts]
        package = ".".join(names)
        is_public = len(names) == 2 or package.rpartition(".")[0] in _DEEP
        if is_public and not package.startswith(_WITHOUT_ENTRIES):
            yield import_module(package)


def test_public_names_have_entries() -> None:
    known = documented()
    missing = [
        f"{package.__name__}.{name}"
        for package in public_packages()
        for name in getattr(package, "__all__", ())
        if id(getattr(package, name)) not in known
    ]
    assert missing == [], (
        "add a directive `::: PATH` to a page in docs/reference/api, or leave it out of __all__"
    )


def test_names_that_the_documentation_imports_have_entries() -> None:
    known = documented()
    missing = []
    for module, name in sorted(imported()):
        value = getattr(import_module(module), name, None)
        if not callable(value) or module.startswith(_GENERATED):
            continue
        if id(value) not in known:
            missing.append(f"{module}.{name}")
    assert missing == [], "add a directive `::: PATH` to a page in docs/reference/api"
