from __future__ import annotations

import pytest

from mavstack.cli.watch import traffic as module
from mavstack.cli.watch.traffic import Meter, Rate, Traffic
from mavstack.dialects import common
from mavstack.wire import Packet, encode


def packet(system: int = 1, message=None) -> Packet:
    message = message or common.Heartbeat()
    return Packet(encode(message, system=system, component=1), common)


def beat(traffic: Traffic, times) -> None:
    for time in times:
        traffic.add([packet()], time)


def stream(traffic: Traffic):
    return traffic.streams[1, 1, 0]


def test_counts_and_last_packet():
    traffic = Traffic()
    first, second = packet(), packet()
    traffic.add([first, packet(2), second], 5.0)
    assert traffic.packets == 3
    assert stream(traffic).count == 2
    assert stream(traffic).bytes == 2 * len(first)
    assert stream(traffic).packet is second
    assert set(traffic.streams) == {(1, 1, 0), (2, 1, 0)}


@pytest.mark.parametrize("now", [9.0, 9.3, 9.99, 10.9])
def test_rate_of_a_steady_stream_at_any_time(now):
    traffic = Traffic()
    beat(traffic, range(10))
    assert stream(traffic).rate(now).packets == pytest.approx(1.0)


@pytest.mark.parametrize("phase", [0.0, 0.2, 0.5, 0.8])
def test_rate_of_a_steady_stream_with_any_marks(phase):
    traffic = Traffic()
    for time in range(30):
        beat(traffic, [time + phase])
        traffic.mark()
    assert stream(traffic).rate(29.9).packets == pytest.approx(1.0)


def test_old_packets_do_not_count_after_marks():
    traffic = Traffic()
    beat(traffic, [index / 100 for index in range(1000)])
    for second in range(10, 20):
        traffic.mark()
        beat(traffic, [second])
    assert stream(traffic).rate(19.0).packets == pytest.approx(1.0, rel=0.2)


def test_rate_of_a_stopped_stream_falls_to_zero():
    traffic = Traffic()
    beat(traffic, [index / 10 for index in range(100)])
    steady = stream(traffic).rate(10.0).packets
    assert steady == pytest.approx(10.0)
    for _ in range(3):
        traffic.mark()
    assert stream(traffic).rate(20.0).packets < steady
    for _ in range(6):
        traffic.mark()
    assert stream(traffic).rate(20.0) == Rate()


def test_one_packet_has_no_rate():
    traffic = Traffic()
    beat(traffic, [1.0])
    assert stream(traffic).rate(100.0) == Rate()
    assert Meter(0.0).rate(5.0) == Rate()


def test_packets_of_one_moment_have_no_rate():
    traffic = Traffic()
    traffic.add([packet(), packet()], 1.0)
    assert stream(traffic).rate(1.0) == Rate()


def test_the_number_of_streams_is_bounded(monkeypatch):
    monkeypatch.setattr(module, "MAX_STREAMS", 3)
    traffic = Traffic()
    traffic.add([packet(system) for system in range(10)], 0.0)
    traffic.add([packet(0)], 1.0)
    assert len(traffic.streams) == 3
    assert (traffic.packets, traffic.untracked) == (11, 7)


def test_last_status_texts_are_kept():
    traffic = Traffic()
    for index in range(50):
        traffic.add([packet(message=common.Statustext(text=f"text {index}"))], index)
    assert [text.message.text for text in traffic.notices][-1] == "text 49"
    assert len(traffic.notices) < 10
