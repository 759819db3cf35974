"""The layers in both documents on the architecture are the layers that import-linter checks."""

from __future__ import annotations

import re
import tomllib

import pytest

from tests.docs.blocks import ROOT

DOCUMENTS = ("ARCHITECTURE.md", "docs/explanation/architecture.md")
_NAME = re.compile(r"(\w+)(?:/|\.py)(?= ·|  |$)", re.MULTILINE)


def contract() -> list[set[str]]:
    """The names of each layer in the contract, from the top."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["importlinter"]
    layers = next(each["layers"] for each in settings["contracts"] if each["type"] == "layers")
    return [{name.removeprefix("mavstack.") for name in layer.split(" | ")} for layer in layers]


def rows(document: str) -> list[str]:
    """The rows about Python packages in the first block of a document."""
    block = (ROOT / document).read_text("utf-8").split("```")[1]
    lines = block.partition("\n")[2].splitlines()
    return [line for line in lines if not line.startswith(("rust/", "tests/"))]


@pytest.mark.parametrize("document", DOCUMENTS)
def test_the_layers_are_those_of_the_contract(document: str) -> None:
    found = [set(_NAME.findall(row)) for row in rows(document) if not row.startswith(" ")]
    assert found == contract()


def test_both_documents_have_the_same_rows() -> None:
    first, second = map(rows, DOCUMENTS)
    assert first == second
