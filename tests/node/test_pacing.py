"""Pacing of a channel."""

from __future__ import annotations

import pytest

from mavstack.node.pacing import (
    DEFAULT_ESTIMATE,
    MAX_BULK_BURST,
    MAX_ESTIMATE,
    MIN_DEPTH,
    MIN_ESTIMATE,
    Pacer,
)
from mavstack.services import Priority

BULK, STREAM, CONTROL = Priority.BULK, Priority.STREAM, Priority.CONTROL


def send_for(
    pacer: Pacer, seconds: float, size: int = 50, priority: Priority = BULK, others: float = 0.0
) -> int:
    """Return the bulk bytes sent in some seconds, beside `others` bytes per second of control messages."""
    now, sent_bytes, due = 1000.0, 0, 0.0
    while now < 1000.0 + seconds:
        due += others / 1000
        if due >= size:
            due -= size
            pacer.sent(size, now)
        while pacer.has_room(priority, now):
            pacer.sent(size, now, priority)
            sent_bytes += size
        now += 0.001
    return sent_bytes


def test_without_a_known_bandwidth_there_is_no_limit() -> None:
    pacer = Pacer()
    assert all(pacer.has_room(priority, 0.0) for priority in Priority)
    pacer.sent(10**9, 0.0)
    assert pacer.has_room(BULK, 0.0)
    assert pacer.room_at(5.0) == 5.0


def test_bulk_rate_applies_without_a_known_bandwidth() -> None:
    pacer = Pacer(bulk_rate=500.0)
    assert send_for(pacer, 10, size=1) == pytest.approx(MAX_BULK_BURST + 5000, abs=3)
    burst = 0
    while pacer.has_room(BULK, 2000.0):  # silence allows one burst at most
        pacer.sent(10**6, 2000.0, BULK)
        burst += 1
    assert burst == MAX_BULK_BURST
    assert pacer.room_at(2000.0) == pytest.approx(2000.002)
    assert pacer.has_room(BULK, 2000.0021)
    assert pacer.has_room(STREAM, 2000.0)
    assert pacer.has_room(CONTROL, 2000.0)


def test_bulk_uses_the_bandwidth() -> None:
    assert send_for(Pacer(5760), 10) == pytest.approx(57_600, rel=0.02)


def test_bulk_uses_the_bandwidth_that_control_leaves() -> None:
    assert send_for(Pacer(5760), 10, others=2000) == pytest.approx(37_600, rel=0.03)


def test_received_bytes_count_on_a_half_duplex_channel() -> None:
    half, full = Pacer(5760, half_duplex=True), Pacer(5760)
    for pacer in (half, full):
        assert pacer.has_room(BULK, 0.0)
        pacer.received(2000, 0.0)
    assert not half.has_room(BULK, 0.0)
    assert full.has_room(BULK, 0.0)
    half.received(10**9, 0.0)  # the overdraft by received bytes is limited
    assert half.has_room(BULK, 0.2)


def test_silence_allows_only_a_short_burst() -> None:
    pacer, sent_bytes = Pacer(5760), {BULK: 0, STREAM: 0}
    pacer.has_room(BULK, 0.0)
    for _ in range(100):
        if pacer.has_room(BULK, 1000.0):
            pacer.sent(50, 1000.0)
            sent_bytes[BULK] += 50
    assert sent_bytes[BULK] == MIN_DEPTH
    for _ in range(100):
        if pacer.has_room(STREAM, 1000.0):
            pacer.sent(50, 1000.0, STREAM)
            sent_bytes[STREAM] += 50
    assert sent_bytes[STREAM] == 50  # bulk waits: the streams' share of the burst


def test_control_never_waits_and_streams_precede_bulk() -> None:
    pacer = Pacer(1000)
    pacer.sent(400, 0.0)
    assert [pacer.has_room(priority, 0.0) for priority in (CONTROL, STREAM, BULK)] == [True, True, False]
    pacer.sent(400, 0.0)
    assert [pacer.has_room(priority, 0.0) for priority in (CONTROL, STREAM, BULK)] == [True, False, False]
    again = pacer.room_at(0.0)
    assert not pacer.has_room(BULK, again - 0.01)
    assert pacer.has_room(BULK, again + 0.001)


def test_room_at_is_exact() -> None:
    pacer = Pacer(1000)
    pacer.sent(800, 0.0)
    assert pacer.has_room(BULK, pacer.room_at(0.0))


def use_for_a_second(pacer: Pacer, second: int, share: float, free_percent: int) -> None:
    """Use a share of the bandwidth for a second, then report the free queue space of the radio."""
    if pacer.bandwidth is not None:
        pacer.sent(round(share * pacer.bandwidth), second - 0.5)
    pacer.radio_status(free_percent, float(second))


def test_the_estimate_falls_quickly_and_rises_slowly() -> None:
    pacer = Pacer()
    pacer.radio_status(70, 0.0)
    assert pacer.learned
    assert pacer.bandwidth == DEFAULT_ESTIMATE
    use_for_a_second(pacer, 1, 1.0, 100)
    assert pacer.bandwidth == pytest.approx(DEFAULT_ESTIMATE * 1.15)
    for second in range(2, 5):
        use_for_a_second(pacer, second, 1.0, 10)
    assert pacer.bandwidth < DEFAULT_ESTIMATE / 3
    before = pacer.bandwidth
    use_for_a_second(pacer, 5, 1.0, 70)
    assert pacer.bandwidth == before
    for second in range(6, 100):
        use_for_a_second(pacer, second, 1.0, 0)
    assert pacer.bandwidth == MIN_ESTIMATE
    for second in range(100, 300):
        use_for_a_second(pacer, second, 1.0, 100)
    assert pacer.bandwidth == MAX_ESTIMATE


def test_an_idle_radio_does_not_raise_the_estimate() -> None:
    pacer = Pacer()
    for second in range(100):
        use_for_a_second(pacer, second, 0.1, 100)
    assert pacer.bandwidth <= DEFAULT_ESTIMATE * 1.15


def test_a_full_queue_lowers_the_estimate_below_the_used_bandwidth() -> None:
    pacer = Pacer()
    for second in range(3):
        use_for_a_second(pacer, second, 1.0, 100)
    use_for_a_second(pacer, 3, 0.4, 10)  # others used the channel
    assert pacer.bandwidth < DEFAULT_ESTIMATE * 0.4


def test_no_estimate_without_a_report_or_with_a_known_bandwidth() -> None:
    pacer = Pacer()
    for unknown in (101, 254, 255):
        pacer.radio_status(unknown, 0.0)
    assert pacer.bandwidth is None
    known = Pacer(3000)
    known.radio_status(0, 0.0)
    assert known.bandwidth == 3000


def test_streams_are_limited_to_a_share_only_while_bulk_waits() -> None:
    pacer, now = Pacer(5760), 1000.0
    sent_bytes = {STREAM: 0, BULK: 0}

    def second(*priorities: Priority) -> dict[Priority, int]:
        nonlocal now
        before = dict(sent_bytes)
        for _ in range(1000):
            now += 0.001
            for priority in priorities:
                if pacer.has_room(priority, now):
                    pacer.sent(50, now, priority)
                    sent_bytes[priority] += 50
        return {priority: sent_bytes[priority] - before[priority] for priority in sent_bytes}

    second(STREAM)
    assert second(STREAM)[STREAM] == pytest.approx(5760, rel=0.05)
    second(STREAM, BULK)
    both = second(STREAM, BULK)
    assert both[STREAM] == pytest.approx(0.15 * 5760, rel=0.1)
    assert both[BULK] == pytest.approx(0.85 * 5760, rel=0.1)
    second(STREAM)
    assert second(STREAM)[STREAM] == pytest.approx(5760, rel=0.05)
