"""The tree of errors, from `mavstack.errors`."""

from __future__ import annotations

from inspect import getdoc
from typing import TYPE_CHECKING

from mavstack import errors

if TYPE_CHECKING:
    from collections.abc import Iterator


def render() -> str:
    """Return the tree as nested Markdown lists."""
    return "\n".join(_lines(errors.MavstackError, 0))


def all_errors() -> list[type[Exception]]:
    """Return every class of the tree."""
    return list(_walk(errors.MavstackError))


def _walk(error: type[Exception]) -> Iterator[type[Exception]]:
    yield error
    for child in _children(error):
        yield from _walk(child)


def _children(error: type[Exception]) -> list[type[Exception]]:
    return [child for child in error.__subclasses__() if child.__module__ == errors.__name__]


def _lines(error: type[Exception], depth: int) -> Iterator[str]:
    builtin = [base.__name__ for base in error.__bases__ if base.__module__ == "builtins"]
    also = "" if builtin in ([], ["Exception"]) else f" (also a {', '.join(builtin)})"
    summary = (getdoc(error) or "").partition("\n\n")[0].replace("\n", " ")
    yield f"{'    ' * depth}- [`{error.__name__}`][mavstack.errors.{error.__name__}]{also}: {summary}"
    for child in _children(error):
        yield from _lines(child, depth + 1)
