"""A message of several sources side by side."""

from __future__ import annotations

from mavstack.dialects import common
from tests.cli.watch.inspector.watched import Watched, stream


def test_the_sources_are_columns():
    watched = Watched(links=2)
    for label, system, roll in (("A", 1, 0.1), ("A", 2, 0.2), ("B", 1, 0.1)):
        watched.send(common.Attitude(roll=roll), system=system, label=label)
    watched.send(common.VfrHud(), label="B")
    watched.inspector.update(0.0)
    watched.inspector.select(stream(label="A"))
    comparison = watched.inspector.comparison
    assert comparison.sources == ["A 1/1", "A 2/1", "B 1/1"]
    rows = {row.name.field: row for row in comparison.rows}
    assert [value.text for value in rows["roll"].values] == ["5.7°", "11.5°", "5.7°"]
    assert (rows["roll"].differs, rows["yaw"].differs) == (True, False)


def test_nothing_is_selected():
    watched = Watched()
    watched.inspector.update(0.0)
    assert watched.inspector.comparison.rows == watched.inspector.fields == []
