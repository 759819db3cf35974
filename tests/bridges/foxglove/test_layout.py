"""The layout for Foxglove: its panels, and topics that exist."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import pytest

from mavstack.bridges.core.table import ALL
from mavstack.bridges.foxglove.layout import layout_text, topics_of, write_layout

if TYPE_CHECKING:
    from pathlib import Path


def leaves(tree: Any) -> list[str]:
    return [tree] if isinstance(tree, str) else [*leaves(tree["first"]), *leaves(tree["second"])]


def splits(tree: Any) -> list[dict[str, Any]]:
    return [] if isinstance(tree, str) else [tree, *splits(tree["first"]), *splits(tree["second"])]


def test_each_panel_has_a_place_and_each_place_a_panel() -> None:
    layout = json.loads(layout_text())
    assert sorted(leaves(layout["layout"])) == sorted(layout["configById"])
    assert all(name.partition("!")[2] for name in layout["configById"])
    assert {each["direction"] for each in splits(layout["layout"])} == {"row", "column"}
    assert all(10 <= each["splitPercentage"] <= 90 for each in splits(layout["layout"]))
    assert {"globalVariables", "userNodes", "playbackConfig"} <= set(layout)


def test_all_topics_and_services_exist() -> None:
    pytest.importorskip("foxglove")
    from mavstack.bridges.foxglove.panels import PANELS

    rows = {row.name if row.name.startswith("/") else f"/mavros/{row.name}" for row in ALL}
    panels = {f"/mavros/{panel.name}" for panel in PANELS.values()}
    shown = topics_of(json.loads(layout_text()))
    assert len(shown) > 10
    assert shown <= rows | panels


def test_a_vehicle_with_a_name(tmp_path: Path) -> None:
    write_layout(tmp_path / "alpha.json", "/alpha/mavros")
    layout = json.loads((tmp_path / "alpha.json").read_text())
    topics = topics_of(layout) - {"/diagnostics"}
    assert all(topic.startswith("/alpha/mavros/") for topic in topics)
    assert layout["configById"]["3D!pose"]["followTf"] == "alpha/base_link"
    assert layout["configById"]["map!place"]["layer"] == "map"
