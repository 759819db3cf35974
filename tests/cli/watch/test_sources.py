"""Several links and files in one picture."""

from __future__ import annotations

import json

import pytest

from mavstack.cli.common.errors import UsageError
from mavstack.cli.watch.live_table import render
from mavstack.cli.watch.observer import Selection
from mavstack.cli.watch.sources import open_sources, take_picture, take_summary
from mavstack.cli.watch.trend import TrendRow
from mavstack.dialects import Dialect, common
from mavstack.wire import encode
from tests.cli.conftest import flight, stamped

ALL = Dialect.load("all")


def two_links():
    """The vehicle 1/1 heard over two links, of which the second loses every other packet."""
    sources = open_sources(["udpin://0.0.0.0:14550", "udpin://0.0.0.0:14560"], ALL, Selection())
    for source, step in zip(sources, (1, 2), strict=True):
        source.observer.open("link")
        for data in flight(20)[::step]:
            source.observer.receive("link", data, 1.0)
    return sources


def test_the_rows_of_two_links_are_distinguished():
    picture = take_picture(two_links())
    rows = {(row.name, row.source): row.count for row in picture.messages}
    assert rows["ATTITUDE", "A 1/1"] == 20
    assert rows["ATTITUDE", "B 1/1"] == 10
    assert [row.source for row in picture.components] == ["A 1/1", "A 255/190", "B 1/1"]
    assert picture.totals.packets == picture.selected == 33


@pytest.mark.parametrize(("width", "height"), [(80, 24), (120, 40), (40, 10)])
def test_the_display_of_two_links_fits(width, height):
    lines = [line.plain for line in render(take_picture(two_links()), width, height)]
    assert len(lines) <= height
    assert max(map(len, lines)) <= width
    text = "\n".join(lines)
    assert "A udpin://0.0.0.0:14550" in text
    assert "B udpin://0.0.0.0:14560" in text


def test_the_display_has_trends_and_the_activity():
    from dataclasses import replace

    trends = [TrendRow("A 1/1", "ATTITUDE.roll", (0.0, 1.0, 2.0), "2.0°")]
    picture = replace(take_picture(two_links()), trends=trends, activity="recorded 3 packets to x.tlog")
    text = "\n".join(line.plain for line in render(picture, 80, 24))
    assert "▁▅█ 2.0°" in text
    assert "recorded 3 packets to x.tlog" in text


def test_the_summary_of_two_links():
    summary = take_summary(two_links())
    assert summary["messages"] == {"ATTITUDE": 30, "HEARTBEAT": 3}
    assert summary["sources"] == ["1/1", "255/190"]
    second = summary["by_source"][1]
    assert second["source"] == "udpin://0.0.0.0:14560"
    assert second["messages"] == {"ATTITUDE": 10, "HEARTBEAT": 1}


def test_two_files(mav, tmp_path):
    paths = [tmp_path / name for name in ("a.tlog", "b.tlog")]
    paths[0].write_bytes(stamped(flight(5)))
    paths[1].write_bytes(stamped([encode(common.SystemTime(), system=2, component=1)]))
    result = mav("watch", *paths, "--once", "--json")
    summary = json.loads(result.out)
    assert summary["messages"] == {"ATTITUDE": 5, "HEARTBEAT": 2, "SYSTEM_TIME": 1}
    assert [part["source"] for part in summary["by_source"]] == list(map(str, paths))
    text = mav("watch", *paths, "--once").out
    assert "2 sources" in text
    assert f"B {paths[1]}: 1 packets" in text
    lines = [json.loads(line) for line in mav("watch", *paths, "--json").out.splitlines()]
    assert [line["source"] for line in lines] == [str(paths[0])] * 7 + [str(paths[1])]
    assert " B     2/1 SYSTEM_TIME" in mav("watch", *paths).out


def test_a_file_may_appear_twice(mav, tlog):
    summary = json.loads(mav("watch", tlog, tlog, "--once", "--json").out)
    assert summary["packets"] == 44


def test_too_many_sources_are_refused():
    with pytest.raises(UsageError, match="at most 26 sources"):
        open_sources(["udpin://0.0.0.0:1"] * 27, ALL, Selection())
