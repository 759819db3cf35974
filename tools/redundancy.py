"""Counts of redundancy: Protocols with one implementation, and functions that only pass their parameters on.

`python -m tools.redundancy` prints both counts and the lines of Python in `src/mavstack`; `--list` adds the
places.
"""

from __future__ import annotations

import ast
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Iterator

SOURCES = Path(__file__).parents[1] / "src" / "mavstack"
#: Members of a Protocol from which on a second declaration of a class is worth to be avoided.
SIZEABLE = 3

Function: TypeAlias = ast.FunctionDef | ast.AsyncFunctionDef


@dataclass
class ClassFacts:
    """The place of a class, its bases, and the names of its public members."""

    place: str
    name: str
    bases: list[str]
    members: set[str] = field(default_factory=set)

    @property
    def is_protocol(self) -> bool:
        """True for a Protocol, also a generic one."""
        return "Protocol" in self.bases


def main(arguments: list[str]) -> int:
    """Print the counts."""
    trees = {path: ast.parse(path.read_text("utf-8")) for path in sorted(SOURCES.rglob("*.py"))}
    single = list(single_protocols(trees))
    passing = list(pass_through_functions(trees))
    lines = sum(path.read_text("utf-8").count("\n") for path in trees)
    print(f"Protocols of {SIZEABLE} members and more with one implementation: {len(single)}")
    print(f"functions that only pass their parameters on: {len(passing)}")
    print(f"lines of Python in src/mavstack: {lines}")
    if "--list" in arguments:
        print(*single, *passing, sep="\n")
    return 0


def single_protocols(trees: dict[Path, ast.Module]) -> Iterator[str]:
    """Yield each sizeable Protocol that at most one class of the package implements, and that class."""
    classes = [facts for path, tree in trees.items() for facts in _classes(path, tree)]
    by_name: dict[str, list[ClassFacts]] = {}
    for each in classes:
        by_name.setdefault(each.name, []).append(each)
    inherited = {id(each): _all_members(each, by_name) for each in classes}
    for protocol in classes:
        wanted = inherited[id(protocol)]
        if not protocol.is_protocol or len(wanted) < SIZEABLE:
            continue
        found = [each for each in classes if not each.is_protocol and wanted <= inherited[id(each)]]
        names = {each.name for each in found}
        roots = [each for each in found if not names & (_ancestors(each, by_name) - {each.name})]
        if len(roots) <= 1:
            yield f"{protocol.place}: {protocol.name} = {roots[0].name if roots else 'nothing'}"


def pass_through_functions(trees: dict[Path, ast.Module]) -> Iterator[str]:
    """Yield each function that does nothing but call another one with all its parameters, unchanged.

    Methods that a base class of the package demands are left out, because they cannot be left out there.
    """
    by_name: dict[str, list[ClassFacts]] = {}
    for path, tree in trees.items():
        for each in _classes(path, tree):
            by_name.setdefault(each.name, []).append(each)
    for path, tree in trees.items():
        demanded = {
            id(method)
            for item in _statements(tree)
            if isinstance(item, ast.ClassDef)
            for method in item.body
            if isinstance(method, Function) and method.name in _demanded_names(item, by_name)
        }
        for function in _statements(tree):
            if isinstance(function, Function) and id(function) not in demanded and _passes_on(function):
                yield f"{path.relative_to(SOURCES)}:{function.lineno} {function.name}"


def _demanded_names(item: ast.ClassDef, by_name: dict[str, list[ClassFacts]]) -> set[str]:
    """Return the names of the methods of the base classes of a class."""
    bases = set(map(_base_name, item.bases))
    ancestors = {
        name for base in bases for each in by_name.get(base, []) for name in _ancestors(each, by_name)
    }
    return {member for name in ancestors for each in by_name.get(name, []) for member in each.members}


def _passes_on(function: Function) -> bool:
    if function.name.startswith("__") or function.decorator_list:
        return False
    body = [part for part in function.body if not _is_docstring(part)]
    if len(body) != 1 or not isinstance(body[0], ast.Return | ast.Expr):
        return False
    call = body[0].value
    call = call.value if isinstance(call, ast.Await) else call
    if not isinstance(call, ast.Call):
        return False
    arguments = function.args
    names = [each.arg for each in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs)]
    names += [each.arg for each in (arguments.vararg, arguments.kwarg) if each is not None]
    own = [name for name in names if name not in ("self", "cls")]
    given = [part.value if isinstance(part, ast.Starred) else part for part in call.args]
    given += [part.value for part in call.keywords]
    passed = [part.id for part in given if isinstance(part, ast.Name) and part.id in own]
    return bool(own) and sorted(passed) == sorted(own) and all(map(_is_plain, given))


def _is_plain(value: ast.expr) -> bool:
    """Return whether an argument is a name, or an attribute of one; constants, in capitals, add something."""
    if isinstance(value, ast.Attribute):
        return not value.attr.isupper() and _is_plain(value.value)
    return isinstance(value, ast.Name) and not value.id.isupper()


def _is_docstring(part: ast.stmt) -> bool:
    return isinstance(part, ast.Expr) and isinstance(part.value, ast.Constant)


def _classes(path: Path, tree: ast.Module) -> Iterator[ClassFacts]:
    for item in _statements(tree):
        if isinstance(item, ast.ClassDef):
            bases = [_base_name(base) for base in item.bases]
            place = f"{path.relative_to(SOURCES)}:{item.lineno}"
            yield ClassFacts(place, item.name, bases, set(_members(item)))


def _statements(node: ast.AST) -> Iterator[ast.AST]:
    """Yield the statements in a node, in order; expressions have no definitions and are not searched."""
    for block in ("body", "handlers", "orelse", "finalbody", "cases"):
        for part in getattr(node, block, ()):
            yield part
            yield from _statements(part)


def _targets(function: ast.FunctionDef | ast.AsyncFunctionDef) -> Iterator[ast.expr]:
    """Yield the expressions to which the statements of a function assign."""
    for part in _statements(function):
        match part:
            case ast.Assign(targets=targets):
                yield from targets
            case ast.AnnAssign(target=target) | ast.AugAssign(target=target):
                yield target
            case ast.For(target=target) | ast.AsyncFor(target=target):
                yield target
            case ast.With(items=items) | ast.AsyncWith(items=items):
                yield from (item.optional_vars for item in items if item.optional_vars is not None)


def _base_name(base: ast.expr) -> str:
    """Return the name of a base class without its module; that of asyncio is no Protocol of types."""
    name = ast.unparse(base).partition("[")[0]
    return name if name == "asyncio.Protocol" else name.rpartition(".")[2]


def _members(item: ast.ClassDef) -> Iterator[str]:
    for part in item.body:
        if isinstance(part, ast.FunctionDef | ast.AsyncFunctionDef):
            yield part.name
            stored = (each for target in _targets(part) for each in ast.walk(target))
            yield from (
                each.attr
                for each in stored
                if isinstance(each, ast.Attribute) and isinstance(each.ctx, ast.Store)
            )
        elif isinstance(part, ast.AnnAssign | ast.Assign):
            for target in part.targets if isinstance(part, ast.Assign) else [part.target]:
                yield ast.unparse(target)


def _ancestors(item: ClassFacts, by_name: dict[str, list[ClassFacts]]) -> set[str]:
    found: set[str] = set()
    waiting = [item.name]
    while waiting:
        name = waiting.pop()
        if name not in found:
            found.add(name)
            waiting += [base for each in by_name.get(name, []) for base in each.bases]
    return found


def _all_members(item: ClassFacts, by_name: dict[str, list[ClassFacts]]) -> set[str]:
    names = (_ancestors(item, by_name) - {item.name}) | {"object"}
    parts = [item, *(each for name in names for each in by_name.get(name, []))]
    return {name for each in parts for name in each.members if not name.startswith("_")} | {
        name for each in parts for name in each.members if name in ("__len__", "__iter__", "__call__")
    }


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
