from __future__ import annotations

import json
from pathlib import Path

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.server.rows.template import MAX_COLUMNS, parse_row, parse_templates

#: The pages of the station read templates too: both pass the same cases.
CASES = json.loads((Path(__file__).parents[3] / "web/src/lib/rows/template-cases.json").read_text("utf-8"))


@pytest.mark.parametrize("case", CASES["rows"], ids=lambda case: f"{case['template']} {case['line']!r}")
def test_rows(case: dict) -> None:
    row = parse_row(parse_templates(case["template"]), case["line"])
    found = (None, None) if row is None else (row.message, row.fields)
    assert found == (case["message"], case["fields"])


@pytest.mark.parametrize("text", CASES["refused"])
def test_malformed_templates(text: str) -> None:
    with pytest.raises(InvalidArgumentError, match="invalid template"):
        parse_templates(text)


def test_columns_have_units_and_are_bounded() -> None:
    (template,) = parse_templates("lat:deg,_,alt:m")
    assert [each and each.unit for each in template.columns] == ["deg", None, "m"]
    with pytest.raises(InvalidArgumentError, match="128"):
        parse_templates(",".join(f"c{number}" for number in range(MAX_COLUMNS + 1)))
