"""The docstrings of the compiled core are those of its stub, and every callable has a signature."""

from __future__ import annotations

import ast
import inspect
from pathlib import Path

import pytest

import mavstack
from mavstack import _core

STUB = ast.parse((Path(mavstack.__file__).parent / "_core.pyi").read_text("utf-8"))
DEFINITIONS = (ast.ClassDef, ast.FunctionDef)


def documented(body, prefix=""):
    """Yield name and docstring of the definitions in a stub that have a docstring."""
    for node in body:
        if isinstance(node, DEFINITIONS):
            text = ast.get_docstring(node)
            if text is not None:
                yield prefix + node.name, text
            if isinstance(node, ast.ClassDef):
                yield from documented(node.body, f"{node.name}.")


def words(text: str) -> list[str]:
    return inspect.cleandoc(text).split()


DOCUMENTED = dict(documented(STUB.body))
DOCUMENTED = {
    name: text for name, text in DOCUMENTED.items() if not name.startswith("HasCoreDialect")
}  # typing only


@pytest.mark.parametrize("name", DOCUMENTED)
def test_docstrings_equal_those_of_the_stub(name):
    target = _core
    for part in name.split("."):
        target = getattr(target, part)
    assert words(target.__doc__) == words(DOCUMENTED[name])


@pytest.mark.parametrize("name", ["Dialect", "Encoder", "Index", "Packet", "Parser", "Signing"])
def test_classes_have_a_signature_and_document_their_arguments(name):
    cls = getattr(_core, name)
    text = inspect.getdoc(cls)
    assert "Args:" in text
    for argument in inspect.signature(cls).parameters:
        assert f"\n    {argument}: " in text


@pytest.mark.parametrize("name", ["crc16", "encode", "fields_json", "looks_timestamped", "new_message_class"])
def test_functions_document_their_arguments(name):
    function = getattr(_core, name)
    text = inspect.getdoc(function)
    for argument in inspect.signature(function).parameters:
        assert f"\n    {argument}: " in text
