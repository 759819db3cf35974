"""Files that the pages of the station read too: both must find the same plans."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from mavstack.errors import PlanFileError
from mavstack.files.plans import parse_plan, plan_json

CASES = json.loads(
    (Path(__file__).parents[3] / "web/src/views/plan/formats/plan-cases.json").read_text("utf-8")
)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_files(case: dict[str, Any]) -> None:
    if case.get("refused"):
        with pytest.raises(PlanFileError):
            parse_plan(case["file"])
        return
    plan = parse_plan(case["file"])
    found = plan_json(plan)
    for kind in ("mission", "fence", "rally"):
        items = [
            [item[key] for key in ("command", "frame", "params", "autocontinue")] for item in found[kind]
        ]
        assert items == case[kind]
    assert found["home"] == case["home"]
    assert len(plan.problems) == case["problems"]
