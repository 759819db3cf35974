"""The model of the inspector."""

from __future__ import annotations

import pytest

from mavstack.cli.watch.inspector.field_table import FieldName
from mavstack.cli.watch.inspector.model import SORTS, SPANS
from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from tests.cli.watch.inspector.watched import HEARTBEAT_ID, START, Watched, stream


def names(watched: Watched) -> list[str]:
    return [f"{row.name} {row.source}" for row in watched.inspector.messages]


def field(watched: Watched, name: str) -> str:
    return next(row.text for row in watched.inspector.fields if row.name.field == name)


def test_messages_with_rates_and_the_fields_of_the_selected_one():
    watched = Watched()
    watched.fly(20)
    watched.fly(20)
    attitude, heartbeat = watched.inspector.messages
    assert (attitude.name, attitude.count, heartbeat.count) == ("ATTITUDE", 40, 2)
    assert attitude.rate.packets == pytest.approx(10.0, rel=0.01)
    assert watched.inspector.selected_name == "ATTITUDE 1/1"
    assert field(watched, "roll") == "108.9°"
    watched.send(common.Attitude(roll=-0.5))
    watched.inspector.update(watched.now)
    assert field(watched, "roll") == "-28.6°"


def test_another_message_is_selected():
    watched = Watched()
    watched.fly()
    watched.inspector.select(stream(HEARTBEAT_ID))
    assert watched.inspector.selected_name == "HEARTBEAT 1/1"
    assert field(watched, "autopilot") == "ARDUPILOTMEGA"


@pytest.mark.parametrize(
    ("search", "found"),
    [
        ("", ["ATTITUDE 1/1", "ATTITUDE 2/1", "HEARTBEAT 1/1", "HEARTBEAT 2/1"]),
        ("beat", ["HEARTBEAT 1/1", "HEARTBEAT 2/1"]),
        ("A*E", ["ATTITUDE 1/1", "ATTITUDE 2/1"]),
        ("2/1", ["ATTITUDE 2/1", "HEARTBEAT 2/1"]),
        ("no such", []),
        ("[", []),
    ],
)
def test_search(search, found):
    watched = Watched()
    watched.fly()
    watched.fly(system=2)
    watched.inspector.search = search
    assert names(watched) == found


def test_the_messages_of_one_source():
    watched = Watched(links=2)
    for label, system in (("A", 1), ("A", 2), ("B", 1)):
        watched.fly(1, system, label)
    rows = {row.address: row for row in watched.inspector.sources}
    watched.inspector.toggle_scope(rows["A 2/1"])
    assert names(watched) == ["ATTITUDE A 2/1", "HEARTBEAT A 2/1"]
    watched.inspector.toggle_scope(rows["link B"])
    assert names(watched) == ["ATTITUDE B 1/1", "HEARTBEAT B 1/1"]
    watched.inspector.toggle_scope(rows["link B"])
    assert len(names(watched)) == 6


def test_orders():
    watched = Watched()
    watched.fly()
    watched.send(*[common.VfrHud()] * 30)
    watched.inspector.update(watched.now)
    orders = []
    for _ in SORTS:
        orders.append(names(watched)[0])
        watched.inspector.next_sort()
    assert orders[0] == "ATTITUDE 1/1"
    assert orders[2] == "VFR_HUD 1/1"
    assert watched.inspector.sort == SORTS[0]


def test_paused_everything_stays_and_nothing_is_lost():
    watched = Watched()
    watched.fly(10)
    watched.inspector.toggle_plot(FieldName("roll"))
    watched.inspector.toggle_pause()
    before = field(watched, "roll"), watched.inspector.messages, watched.inspector.plot
    watched.fly(20)
    assert (field(watched, "roll"), watched.inspector.messages, watched.inspector.plot) == before
    assert len(watched.inspector.packets) == 10
    watched.inspector.select(stream(HEARTBEAT_ID))
    assert len(watched.inspector.packets) == 1
    watched.inspector.toggle_pause()
    watched.inspector.select(stream())
    watched.inspector.update(watched.now)
    assert len(watched.inspector.packets) == 30
    assert len(watched.inspector.plot[0].points) == 30
    assert watched.inspector.messages[0].count == 30


def test_the_packets_of_one_message_or_of_all():
    watched = Watched()
    watched.fly(3)
    assert [entry.packet.name for entry in watched.inspector.packets] == ["ATTITUDE"] * 3
    watched.inspector.lists_all_packets = True
    newest, *_, oldest = watched.inspector.packets
    assert (newest.packet.name, oldest.packet.name) == ("ATTITUDE", "HEARTBEAT")
    assert newest.time == pytest.approx(START + 0.3)


def test_the_span_of_the_plot():
    watched = Watched()
    watched.fly(600)
    watched.inspector.toggle_plot(FieldName("roll"))
    counts = []
    for _ in SPANS:
        counts.append(round(len(watched.inspector.plot[0].points), -1))
        watched.inspector.next_span()
    assert counts == [300, 600, 600, 100]


def test_a_silent_live_link_moves_out_of_the_plot():
    watched = Watched()
    watched.fly(10)
    watched.inspector.toggle_plot(FieldName("roll"))
    watched.inspector.update(watched.now + 29.5)
    assert 0 < len(watched.inspector.plot[0].points) < 10


def test_activity():
    watched = Watched()
    assert watched.inspector.activity == ""
    watched.inspector.has_ended = True
    assert watched.inspector.activity == "ended"


def test_there_is_no_picture_before_the_first_update():
    with pytest.raises(InvalidArgumentError, match="before update"):
        _ = Watched().inspector.picture
