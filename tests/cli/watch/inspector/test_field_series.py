"""The points of plotted fields, and the clocks of links."""

from __future__ import annotations

from mavstack.cli.watch.inspector.field_series import FieldSeries, LinkClock, PlottedField
from mavstack.cli.watch.inspector.field_table import FieldName
from mavstack.cli.watch.inspector.packet_store import PacketStore
from mavstack.dialects import common
from mavstack.wire import Packet, encode
from tests.cli.watch.inspector.watched import ALL, stream

ROLL = PlottedField(stream(), FieldName("roll"))


def add(store: PacketStore, time: float, message) -> None:
    store.add("", [Packet(encode(message, system=1, component=1), ALL)], time)


def test_packets_from_before_and_after_the_choice():
    store, series = PacketStore(), FieldSeries(ROLL, "ATTITUDE", "red")
    add(store, 1.0, common.Attitude(roll=0.0))
    series.update(store)
    add(store, 2.0, common.Attitude(roll=float("nan")))
    add(store, 3.0, common.Attitude(roll=1.0))
    series.update(store)
    series.update(store)
    assert [(time, value and round(value, 1)) for time, value in series.points(0.0, 9.0)] == [
        (1.0, 0.0),
        (2.0, None),
        (3.0, 57.3),
    ]
    assert [point.time for point in series.points(1.5, 2.5)] == [2.0]
    assert (series.title, series.unit) == ("1/1 ATTITUDE.roll", "°")


def test_the_clock_of_a_live_link_continues_and_that_of_a_replay_waits():
    live, replay = LinkClock(live=True), LinkClock(live=False)
    for clock in (live, replay):
        clock.receive(1000.0, 5.0)
    assert (live.at(7.0), replay.at(7.0)) == (1002.0, 1000.0)
