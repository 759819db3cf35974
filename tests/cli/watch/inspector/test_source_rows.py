"""The rows of the list of sources."""

from __future__ import annotations

from dataclasses import replace

from mavstack.dialects import common
from mavstack.wire import encode
from tests.cli.watch.inspector.watched import LINKS, Watched


def test_a_link_and_its_components_with_rate_and_loss():
    watched = Watched()
    watched.fly(9)
    watched.lose(10)
    watched.send(common.Attitude())
    watched.send(common.Attitude(), system=2)
    watched.inspector.update(watched.now)
    link, first, second = watched.inspector.sources
    assert (link.name, link.counts.lost, link.bad_bytes) == (LINKS[0], 10, 0)
    assert (first.name, first.counts.received, first.counts.lost, first.counts.loss) == (
        "1/1",
        11,
        10,
        10 / 21,
    )
    assert first.detail == "ARMED LOITER active quadrotor ArduPilot"
    assert (second.name, second.counts.lost) == ("2/1", 0)
    assert link.rate > 9
    assert first.rate > 9


def test_several_channels_have_a_row_each():
    watched = Watched()
    watched.fly(1)
    observer = watched.sources[0].observer
    observer.open("udpin 127.0.0.1:9")
    observer.receive("udpin 127.0.0.1:9", b"junk" + encode(common.Heartbeat(), system=9, component=1), 0.2)
    watched.inspector.update(0.2)
    link, first, second, *components = watched.inspector.sources
    assert (link.counts.received, first.counts.received, second.counts.received) == (3, 2, 1)
    assert (first.channel, second.channel, second.bad_bytes) == (LINKS[0], "udpin 127.0.0.1:9", 4)
    assert [row.address for row in (link, *components)] == ["this link", "1/1", "9/1"]


def test_several_links_have_letters():
    watched = Watched(links=2)
    watched.fly(1, label="A")
    watched.fly(1, label="B")
    rows = watched.inspector.sources
    assert [row.address for row in rows] == ["link A", "A 1/1", "link B", "B 1/1"]
    assert rows[0].name == f"A {LINKS[0]}"
    (message,) = (row for row in watched.inspector.messages if row.label == "B" and row.name == "ATTITUDE")
    assert [row.includes(message) for row in rows] == [False, False, True, True]
    assert not rows[3].includes(replace(message, system=7))
