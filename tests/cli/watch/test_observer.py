from __future__ import annotations

from mavstack.cli.watch.observer import Observer, Selection
from mavstack.dialects import Dialect
from tests.cli.conftest import flight, stamped

ALL = Dialect.load("all")


def test_closed_channel_keeps_its_counts():
    observer = Observer(ALL)
    for name in ("one", "two"):
        observer.open(name)
        observer.receive(name, b"".join(flight(8)), 1.0)
    observer.close("one")
    assert list(observer.channels) == ["two"]
    totals = observer.totals()
    assert totals.packets == observer.traffic.packets == 20
    assert totals.sources[1, 1].received == 18


def test_loss_is_counted_per_channel():
    observer = Observer(ALL)
    packets = flight(20)
    observer.open("whole")
    observer.open("lossy")
    observer.receive("whole", b"".join(packets), 1.0)
    observer.receive("lossy", b"".join(packets[:5] + packets[10:]), 1.0)
    totals = observer.totals()
    assert totals.sources[1, 1].lost == 5
    assert totals.all_sources.lost == 5
    assert 0 < totals.all_sources.loss < 0.2


def test_reopened_channel_is_a_new_stream():
    observer = Observer(ALL)
    observer.open("one")
    observer.receive("one", flight()[0][:-4], 1.0)
    observer.open("one")
    assert len(observer.receive("one", flight()[0], 2.0)) == 1


def test_only_selected_packets_are_traffic():
    observer = Observer(ALL, Selection(frozenset({0}), 255))
    observer.open("one")
    observer.receive("one", b"".join(flight()), 1.0)
    assert observer.traffic.packets == 1
    assert observer.totals().packets == 22


def test_recorded_times():
    observer = Observer(ALL)
    assert observer.recorded_seconds is None
    observer.open("log", timestamped=True)
    observer.receive("log", stamped(flight(9)), 0.0)
    assert round(observer.recorded_seconds, 6) == 1.0


def test_duration_of_recorded_time():
    observer = Observer(ALL)
    observer.open("log", timestamped=True)
    assert len(observer.receive("log", stamped(flight(18)), 0.0, 0.5)) == 6
    assert observer.beyond_duration
