from __future__ import annotations

from mavstack.cli.route.display import Picture, RateMeter, Rates, render
from mavstack.router.snapshot import EndpointState, RouteState, Snapshot


def state(name="ground", **values):
    return EndpointState(name, "udpin://0.0.0.0:14550", values.pop("state", "open"), **values)


def text(picture, width=100, height=30):
    return [line.plain.rstrip() for line in render(picture, width, height)]


def test_picture():
    snapshot = Snapshot(
        (
            state(received=10, lost=2, links=["a", "b"], group="radio"),
            state("sat", state="down", reason="no answer"),
        ),
        (RouteState(1, 1, ("ground",), 0.2), RouteState(2, 1, ("sat", "ground"), 75.0)),
    )
    picture = Picture(snapshot, {"ground": Rates(50.0, 4000.0, 20.0, 900.0, 3.0)}, 61.0)
    lines = text(picture)
    assert lines[0].startswith(" mav route")
    assert lines[0].endswith("1:01 min")
    assert lines[2:6] == [
        " ground               open            50  4.0 kB/s       20   900 B/s       3      2",
        "   udpin://0.0.0.0:14550, 2 links, group radio",
        " sat                  down             0     0 B/s        0     0 B/s       0      0",
        "   no answer",
    ]
    assert "   1/1      ground" in lines
    assert "   2/1      sat, ground  1:15 min ago" in lines


def test_many_endpoints_and_routes_fit():
    snapshot = Snapshot(
        tuple(state(f"endpoint{number}") for number in range(50)),
        tuple(RouteState(number, 1, ("a",), 0.0) for number in range(1, 200)),
    )
    lines = text(Picture(snapshot, {}, 0.0), width=40, height=20)
    assert len(lines) <= 20
    assert all(len(line) <= 40 for line in lines)
    assert any("more endpoints" in line for line in lines)


def test_the_newest_alerts_come_first_and_control_no_terminal():
    alerts = tuple((10.0 - number, f"floods: radio: alert {number}\x1b[2J") for number in range(5))
    lines = text(Picture(Snapshot((state(),), (), alerts), {}, 0.0))
    first = lines.index(" alerts of the firewall")
    assert [line.split("alert ")[1][0] for line in lines[first + 1 : first + 4]] == ["4", "3", "2"]
    assert "6 s ago" in lines[first + 1]
    assert not any("\x1b" in line for line in lines)


def test_without_packets():
    assert " no packet received yet" in text(Picture(Snapshot((state(),), ()), {}, 0.0))
    assert " no address is known now" in text(Picture(Snapshot((state(received=3),), ()), {}, 0.0))


def test_rates_are_those_of_the_last_second():
    meter = RateMeter()
    assert meter.update(Snapshot((state(received=10),), ()), 100.0) == {}
    assert meter.update(Snapshot((state(received=20),), ()), 100.5) == {}
    assert meter.update(Snapshot((state(received=30, sent_bytes=400),), ()), 102.0)["ground"] == Rates(
        10.0, 0, 0, 200
    )
    assert meter.update(Snapshot((state(received=5),), ()), 103.0)["ground"].received == 0
