"""Check names and prose against the project's vocabulary.

    python -m tools.vocabulary [PATH...]

The list of banned words is `vocabulary.toml` beside this file. Identifiers are checked where they are defined
(classes, functions, arguments, assigned names), so a library's names do not count. Prose is docstrings,
comments and error texts of Python, comments of Rust, comments and texts of TypeScript, comments of Makefiles
and TOML, lines of YAML, and Markdown outside code blocks, in upper or lower case. The exit code is 1 if
anything was found.
"""

from __future__ import annotations

import argparse
import ast
import re
import sys
import tomllib
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

ROOT = Path(__file__).resolve().parents[1]
WORDS = Path(__file__).with_suffix(".toml")
DEFAULT_PATHS = (
    "src",
    "rust",
    "tests",
    "benchmarks",
    "examples",
    "tools",
    "backend",
    "changes",
    "docs",
    "web/src",
    "web/scripts",
    ".github",
)
DEFAULT_FILES = (
    "README.md",
    "ARCHITECTURE.md",
    "CONTRIBUTING.md",
    "CHANGELOG.md",
    "SECURITY.md",
    "web/README.md",
    "Makefile",
    "mkdocs.yml",
    ".pre-commit-config.yaml",
    "pyproject.toml",
    "Cargo.toml",
)
SUFFIXES = (".py", ".rs", ".md", ".ts", ".mjs", ".svelte", ".css", ".yml", ".yaml", ".toml")
MAKEFILE = "Makefile"
#: Files that hold generated or recorded text.
EXCLUDED = (
    "*/.build/*",
    "*/dialects/definitions/*",
    "*/target/*",
    "*/__pycache__/*",
    "*/site/*",
    "*/node_modules/*",
    "*/web/src/generated/*",
    "*/tools/vocabulary.toml",
)
_RUST_DEFINITION = re.compile(
    r"\b(?:fn|struct|enum|trait|mod|const|static|type|let(?: mut)?)\s+([A-Za-z_]\w*)"
)
_SCRIPT_DEFINITION = re.compile(r"\b(?:class|interface|type|function|const|let)\s+([A-Za-z_$]\w*)")
_SCRIPT_COMMENT = re.compile(r"(?://|/\*\*?|^\s*\*|<!--)\s?(.*?)(?:\*/|-->)?$")
#: Texts of more than one word.
_SCRIPT_TEXT = re.compile(r"'([^'\n]* [^'\n]*)'|`([^`\n]* [^`\n]*)`")
#: A comment at the beginning of a line, or behind white space.
_HASH_COMMENT = re.compile(r"(?:^|\s)#+\s(.*)$")
_RUST_COMMENT = re.compile(r"//[/!]*\s?(.*)$")
#: The texts are found so that a `#` in them is no comment.
_PYTHON_COMMENT_OR_TEXT = re.compile(
    r"""(?P<comment>\#.*)|(?s:(?P<quotes>\"{3}|'{3}|"|')(?:[^\\"']|\\.|(?!(?P=quotes)).)*+(?P=quotes))"""
)
_WITH_DOCSTRING = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
_LEAVES = (ast.Constant, ast.expr_context, ast.operator)


@dataclass(frozen=True)
class Finding:
    """A banned word in a file."""

    path: str
    line: int
    word: str
    replacement: str

    def __str__(self) -> str:
        return f"{self.path}:{self.line}: {self.word!r}: {self.replacement}"


@dataclass(frozen=True)
class Vocabulary:
    """The banned words, with the places where each is allowed."""

    identifiers: dict[str, str]
    prose: dict[str, str]
    allowed: dict[str, list[str]]
    _banned: dict[str, tuple[str, ...]] = field(default_factory=dict, init=False)

    @classmethod
    def load(cls, path: Path = WORDS) -> Vocabulary:
        """Read the list from a TOML file."""
        data = tomllib.loads(path.read_text("utf-8"))
        return cls(data.get("identifiers", {}), data.get("prose", {}), data.get("allowed", {}))

    def check(self, path: str, text: str) -> list[Finding]:
        """Return the findings in one file, whose kind its name tells."""
        names, prose = _READERS[Path(path).suffix or Path(path).name](text)
        found = [*self._in_names(path, names), *self._in_prose(path, prose)]
        return sorted(found, key=lambda finding: (finding.line, finding.word))

    def _in_names(self, path: str, names: Iterable[tuple[int, str]]) -> Iterator[Finding]:
        for line, name in names:
            for word in self._banned_in(name):
                if not self._is_allowed(word, path):
                    yield Finding(path, line, name, self.identifiers[word])

    def _banned_in(self, name: str) -> tuple[str, ...]:
        if name not in self._banned:  # most names occur in many places
            parts = f"_{'_'.join(parts_of(name))}_"
            self._banned[name] = tuple(word for word in self.identifiers if f"_{word}_" in parts)
        return self._banned[name]

    @cached_property
    def _any_prose(self) -> re.Pattern[str]:
        return re.compile("|".join(f"(?:{pattern})" for pattern in self.prose), re.IGNORECASE)

    def _in_prose(self, path: str, prose: Iterable[tuple[int, str]]) -> Iterator[Finding]:
        # One search for all patterns leaves few lines to the search for each.
        for line, text in prose:
            if self._any_prose.search(text) is None:
                continue
            for pattern, replacement in self.prose.items():
                match = re.search(pattern, text, re.IGNORECASE)
                if match and not self._is_allowed(pattern, path):
                    yield Finding(path, line, match[0], replacement)

    def _is_allowed(self, word: str, path: str) -> bool:
        return any(fnmatchcase(path, pattern) for pattern in self.allowed.get(word, ()))


def parts_of(name: str) -> list[str]:
    """Split an identifier in snake_case or CamelCase into lower-case words."""
    return [part.lower() for part in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+", name)]


def python_text(text: str) -> tuple[list[tuple[int, str]], list[tuple[int, str]]]:
    """Return the names that a Python module defines and its prose, each with its line."""
    names: list[tuple[int, str]] = []
    prose: list[tuple[int, str]] = []
    for node in _nodes(ast.parse(text)):
        if (found := _defined(node)) is not None:
            names.append(found)
        if isinstance(node, _WITH_DOCSTRING):
            prose += _docstring(node)
        elif isinstance(node, ast.Raise):
            prose += _texts(node)
    return names, [*prose, *_comments(text)]


def _nodes(tree: ast.Module) -> Iterator[ast.AST]:
    """Yield the nodes of a module in any order, without the leaves: `ast.walk` takes three times as long."""
    nodes: list[ast.AST] = [tree]
    while nodes:
        node = nodes.pop()
        yield node
        for value in vars(node).values():
            if isinstance(value, list):
                nodes += [each for each in value if isinstance(each, ast.AST)]
            elif isinstance(value, ast.AST) and not isinstance(value, _LEAVES):
                nodes.append(value)


def _comments(text: str) -> Iterator[tuple[int, str]]:
    line, end = 1, 0
    for match in _PYTHON_COMMENT_OR_TEXT.finditer(text):
        if (comment := match["comment"]) is not None:
            line += text.count("\n", end, match.start())
            end = match.start()
            yield line, comment.lstrip("#:! ")


def rust_text(text: str) -> tuple[list[tuple[int, str]], list[tuple[int, str]]]:
    """Return the names that a Rust file defines and its comments, each with its line."""
    names, prose = [], []
    for number, line in enumerate(text.splitlines(), 1):
        code = line.partition("//")[0]
        names += [(number, match[1]) for match in _RUST_DEFINITION.finditer(code)]
        if comment := _RUST_COMMENT.search(line):
            prose.append((number, comment[1]))
    return names, prose


def script_text(text: str) -> tuple[list[tuple[int, str]], list[tuple[int, str]]]:
    """Return the names that a TypeScript or Svelte file defines, and its comments and texts."""
    names, prose = [], []
    for number, line in enumerate(text.splitlines(), 1):
        names += [(number, match[1]) for match in _SCRIPT_DEFINITION.finditer(line.partition("//")[0])]
        if comment := _SCRIPT_COMMENT.search(line):
            prose.append((number, comment[1]))
        prose += [(number, match[1] or match[2]) for match in _SCRIPT_TEXT.finditer(line)]
    return names, prose


def markdown_text(text: str) -> tuple[list[tuple[int, str]], list[tuple[int, str]]]:
    """Return no names and the lines of a Markdown file outside its code blocks."""
    prose, in_code = [], False
    for number, line in enumerate(text.splitlines(), 1):
        if line.lstrip().startswith("```"):
            in_code = not in_code
        elif not in_code:
            prose.append((number, line.lstrip("#-*> ")))
    return [], prose


def commented_text(text: str) -> tuple[list[tuple[int, str]], list[tuple[int, str]]]:
    """Return no names and the comments of a Makefile or a TOML file."""
    found = ((number, _HASH_COMMENT.search(line)) for number, line in enumerate(text.splitlines(), 1))
    return [], [(number, match[1]) for number, match in found if match]


def yaml_text(text: str) -> tuple[list[tuple[int, str]], list[tuple[int, str]]]:
    """Return no names and the lines of a YAML file: its values are titles and descriptions mostly."""
    return [], [(number, line.strip(" #-")) for number, line in enumerate(text.splitlines(), 1)]


_READERS = {
    MAKEFILE: commented_text,
    ".toml": commented_text,
    **dict.fromkeys((".yml", ".yaml"), yaml_text),
    ".py": python_text,
    ".rs": rust_text,
    ".md": markdown_text,
    **dict.fromkeys((".ts", ".mjs", ".svelte", ".css"), script_text),
}


def _defined(node: ast.AST) -> tuple[int, str] | None:
    match node:
        case ast.ClassDef() | ast.FunctionDef() | ast.AsyncFunctionDef():
            return node.lineno, node.name
        case ast.arg():
            return node.lineno, node.arg
        case ast.Name(ctx=ast.Store()):
            return node.lineno, node.id
        case ast.Attribute(ctx=ast.Store()):
            return node.lineno, node.attr
    return None


def _docstring(
    node: ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef,
) -> list[tuple[int, str]]:
    text = ast.get_docstring(node, clean=False)
    if text is None:
        return []
    return [(node.body[0].lineno + number, line.strip()) for number, line in enumerate(text.splitlines())]


def _texts(node: ast.AST) -> list[tuple[int, str]]:
    """Return the texts in an expression, such as the text of an error; gaps stand for its values."""
    return [
        (each.lineno, each.value)
        for each in ast.walk(node)
        if isinstance(each, ast.Constant) and isinstance(each.value, str)
    ]


def files_below(paths: Iterable[Path]) -> Iterator[Path]:
    """Yield the files to check below these paths, in order."""
    for path in paths:
        found = sorted(path.rglob("*")) if path.is_dir() else [path]
        for file in found:
            name = file.resolve().as_posix()
            is_source = (file.suffix in SUFFIXES or file.name == MAKEFILE) and file.is_file()
            if is_source and not any(fnmatchcase(name, pattern) for pattern in EXCLUDED):
                yield file


def main(arguments: list[str] | None = None) -> int:
    """Check the given paths, by default the whole project, and print what was found."""
    parser = argparse.ArgumentParser(prog="python -m tools.vocabulary", description=__doc__.split("\n")[0])
    parser.add_argument("paths", nargs="*", type=Path, help="files or folders (default: the whole project)")
    paths = parser.parse_args(arguments).paths
    if not paths:
        paths = [path for name in (*DEFAULT_PATHS, *DEFAULT_FILES) if (path := ROOT / name).exists()]
    vocabulary, count = Vocabulary.load(), 0
    for file in files_below(paths):
        path = file.resolve()
        name = path.relative_to(ROOT).as_posix() if path.is_relative_to(ROOT) else path.as_posix()
        for finding in vocabulary.check(name, file.read_text("utf-8")):
            print(finding)
            count += 1
    if count:
        print(f"{count} places use words outside the vocabulary (tools/vocabulary.toml)", file=sys.stderr)
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main())
