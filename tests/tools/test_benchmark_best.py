"""The best ratios of earlier runs beside those of today."""

from __future__ import annotations

import json

import pytest

from benchmarks import best
from benchmarks.measure import Ratio, Row
from benchmarks.report import Conditions, table


def row(median: float, *, higher: bool = True) -> Row:
    return Row("tlog", {}, (Ratio("times C", (median,) * 3, None, higher_is_better=higher),))


@pytest.mark.parametrize(
    ("today", "higher", "text"),
    [
        (5.0, True, "5"),
        (4.6, True, "5"),
        (4.4, True, "5 (LOST 12%)"),
        (5.4, False, "5"),
        (6.0, False, "5 (LOST 17%)"),
    ],
)
def test_a_loss_of_more_than_a_tenth_is_shown(today: float, higher: bool, text: str) -> None:
    ratio = row(today, higher=higher).ratios[0]
    assert best.describe({"tlog": {"times C": 5.0}}, "tlog", ratio) == text
    assert best.describe({}, "tlog", ratio) == ""


def test_only_better_ratios_are_recorded(tmp_path) -> None:
    known = {"tlog": {"times C": 5.0}, "other": {"x": 1.0}}
    assert best.updated(known, [row(4.0)]) == {"other": {"x": 1.0}, "tlog": {"times C": 5.0}}
    assert best.updated(known, [row(6.0)])["tlog"] == {"times C": 6.0}
    assert best.updated(known, [row(4.0, higher=False)])["tlog"] == {"times C": 4.0}
    best.write(known, tmp_path / "best.json")
    assert best.read(tmp_path / "best.json") == known


def test_the_table_has_the_best_so_far(monkeypatch, tmp_path) -> None:
    path = tmp_path / "best.json"
    path.write_text(json.dumps({"tlog": {"times C": 9.0}}))
    monkeypatch.setattr(best, "read", lambda: json.loads(path.read_text()))
    text = table([row(4.0)], Conditions("", "", 3))
    assert "best so far" in text
    assert "9 (LOST 56%)" in text
