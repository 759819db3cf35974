"""The dashboard and the rules that are shipped: their structure, their metrics, and promtool."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from typing import TYPE_CHECKING, Any

import pytest

from mavstack.bridges.core.metrics import LINK, METRICS, VEHICLE
from mavstack.bridges.prometheus.entry import ALERTS, DASHBOARD, shipped

if TYPE_CHECKING:
    from pathlib import Path

PROMTOOL = shutil.which("promtool")
KNOWN = {f"{VEHICLE}{metric.name}" for metric in METRICS} | {
    f"{VEHICLE}mode",
    f"{VEHICLE}info",
    f"{VEHICLE}received_packets_total",
    f"{VEHICLE}lost_packets_total",
    f"{LINK}received_packets_total",
}
NAME = re.compile(r"mavstack_\w+")


def panels() -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads(shipped(DASHBOARD))["panels"]
    return found


def expressions() -> list[str]:
    return [target["expr"] for panel in panels() for target in panel["targets"]]


def test_the_dashboard_has_panels_that_do_not_overlap() -> None:
    dashboard = json.loads(shipped(DASHBOARD))
    assert {"title", "uid", "schemaVersion", "templating", "time", "panels"} <= set(dashboard)
    assert len({panel["id"] for panel in panels()}) == len(panels()) > 10
    cells: set[tuple[int, int]] = set()
    for panel in panels():
        place = panel["gridPos"]
        assert place["x"] + place["w"] <= 24
        own = {
            (column, row)
            for column in range(place["x"], place["x"] + place["w"])
            for row in range(place["y"], place["y"] + place["h"])
        }
        assert not cells & own, panel["title"]
        cells |= own
    variables = {each["name"] for each in dashboard["templating"]["list"]}
    assert {name for text in expressions() for name in re.findall(r"\$(\w+)", text)} <= variables
    assert all(panel["datasource"]["uid"] == "${source}" for panel in panels())


@pytest.mark.parametrize("text", [*expressions(), shipped(ALERTS)], ids=lambda text: text[:40])
def test_all_metrics_exist(text: str) -> None:
    names = set(NAME.findall(text))
    assert names
    assert names <= KNOWN


@pytest.mark.interop
@pytest.mark.skipif(PROMTOOL is None, reason="promtool is not installed")
def test_promtool_accepts_the_rules_and_the_queries_of_the_dashboard(tmp_path: Path) -> None:
    rules = tmp_path / "alerts.yml"
    rules.write_text(shipped(ALERTS))
    queries = [{"record": "x:y", "expr": text.replace("$vehicle", "uav1")} for text in expressions()]
    for number, query in enumerate(queries):
        query["record"] = f"x:y{number}"
    panels_file = tmp_path / "panels.yml"
    panels_file.write_text(json.dumps({"groups": [{"name": "panels", "rules": queries}]}))
    done = subprocess.run(
        [str(PROMTOOL), "check", "rules", rules, panels_file], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert f"{len(queries)} rules found" in done.stdout
