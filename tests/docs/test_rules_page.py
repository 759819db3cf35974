"""The page of rules has a row for each rule, with its own words."""

from __future__ import annotations

import pytest

from mavstack.logs.analysis import all_rules
from tests.docs.blocks import ROOT

PAGE = (ROOT / "docs" / "reference" / "rules.md").read_text("utf-8")


@pytest.mark.parametrize("rule", all_rules(), ids=lambda rule: rule.name)
def test_each_rule_is_described(rule):
    summary = " ".join(rule.description.split("\n\n")[0].split())
    assert f"| `{rule.name}` | {summary} |" in PAGE
