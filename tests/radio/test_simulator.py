"""The simulated radios behave like the firmware where programs notice."""

from __future__ import annotations

from mavstack.radio import RadioPair


def settle(pair, now, duration=5.0):
    end = now + duration
    while (due := pair.next_timeout()) is not None and due <= end:
        pair.advance(due)
    pair.advance(end)
    return end


def in_command_mode():
    pair = RadioPair()
    pair.receive(0, b"+++", 10.0)
    now = settle(pair, 10.0)
    assert pair.output(0) == b"OK\r\n"
    return pair, now


def test_the_guard_times_count():
    pair = RadioPair()
    pair.receive(0, b"x", 10.0)
    pair.receive(0, b"+++", 10.5)  # too soon after data
    assert not pair.near.in_command_mode
    now = settle(pair, 10.5)
    assert not pair.near.in_command_mode
    pair.receive(0, b"+++", now)
    pair.receive(0, b"x", now + 0.5)  # data in the second silence
    now = settle(pair, now)
    assert not pair.near.in_command_mode
    pair.receive(0, b"++++", now)
    settle(pair, now)
    assert not pair.near.in_command_mode


def test_bytes_are_lost_while_a_command_runs():
    pair, now = in_command_mode()
    pair.receive(0, b"ATI\rATO\r", now)
    settle(pair, now)
    assert pair.output(0) == b"ATI\r\nSiK 2.2 on HM-TRP\r\n"
    assert pair.near.in_command_mode


def test_data_passes_only_with_equal_shared_parameters():
    pair = RadioPair()
    pair.receive(0, b"hello", 10.0)
    settle(pair, 10.0)
    assert pair.output(1) == b"hello"
    pair.far.set(NETID=9)
    pair.receive(0, b"hello", 20.0)
    settle(pair, 20.0)
    assert pair.output(1) == b""
    pair.far.set(NETID=25, TXPOWER=3)
    assert pair.connected(30.0)


def test_stored_parameters_apply_after_a_restart():
    pair, now = in_command_mode()
    for text in (b"ATS3=9\r", b"AT&W\r", b"ATZ\r"):
        pair.receive(0, text, now)
        now = settle(pair, now)
    assert pair.near.running[3] == 9
    assert not pair.near.in_command_mode


def test_defaults_registers_and_errors():
    pair, now = in_command_mode()
    for text in (b"ATS4=3\r", b"AT&F\r", b"ATS4?\r", b"ATS4\r", b"AT&X\r", b"AT&T=X\r", b"ATI9\r", b"ATI4\r"):
        pair.receive(0, text, now)
        now = settle(pair, now)
    replies = [line for line in pair.output(0).decode().split("\r\n") if not line.startswith("AT") and line]
    assert replies == ["OK", "OK", "20", "ERROR", "ERROR", "ERROR", "ERROR", "1"]


def test_an_overlong_command_ends_command_mode():
    pair, now = in_command_mode()
    pair.receive(0, b"x" * 20, now)
    assert not pair.near.in_command_mode


def test_reports_are_switched():
    pair, now = in_command_mode()
    pair.receive(0, b"AT&T=RSSI\r", now)
    now = settle(pair, now)
    pair.advance(now + 1)
    assert b"L/R RSSI: 180/176" in pair.output(0)
    pair.receive(0, b"AT&T=RSSI\r", now + 1)
    settle(pair, now + 1)
    assert not pair.near.reports
