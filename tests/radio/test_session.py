"""The AT session by itself: guard times, echo, noise, timeouts, replies cut anywhere."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import InvalidArgumentError, InvalidStateError, RadioError
from mavstack.radio import AtCommand, AtSession, Mode, Reply
from mavstack.radio.session import COMMAND_ATTEMPTS, ENTER_ATTEMPTS, GUARD_TIME, MAX_LINE, MAX_LINES


def ready(now=0.0):
    session = AtSession(now)
    session.enter(now)
    session.handle_timeout(now + GUARD_TIME)
    assert session.data_to_send() == b"+++"
    session.receive(b"OK\r\n", now + 2 * GUARD_TIME)
    assert session.mode is Mode.READY
    return session


def ask(session, command, reply, now=10.0):
    session.start(command, now)
    session.receive(reply, now)
    return session


def test_nothing_is_sent_in_the_guard_time():
    session = AtSession(5.0)
    session.enter(5.0)
    assert session.next_timeout() == 5.0 + GUARD_TIME
    session.handle_timeout(5.0 + GUARD_TIME - 0.01)
    assert session.data_to_send() == b""
    session.handle_timeout(5.0 + GUARD_TIME)
    assert session.data_to_send() == b"+++"


def test_packets_before_the_silence_are_tolerated():
    session = AtSession(0.0)
    session.enter(0.0)
    session.handle_timeout(2.0)
    session.receive(b"\xfd\x09OK\r\n\xfeOK\n\x00", 2.1)  # too early for an answer
    assert not session.done
    session.receive(b"\xfd\xff\x80OK\r\n", 3.1)
    assert session.result() == ()


def test_a_device_without_answer_is_given_up():
    session = AtSession(0.0)
    session.enter(0.0)
    sent = b""
    while not session.done:
        session.handle_timeout(session.next_timeout())
        sent += session.data_to_send()
    assert sent == b"+++\rAT\r" * ENTER_ATTEMPTS
    with pytest.raises(RadioError, match="no OK"):
        session.result()


def test_replies_end_by_their_kind():
    session = ready()
    assert ask(session, AtCommand("ATI", Reply.LINE), b"ATI\r\nSiK 2.2\r\n").result() == ("SiK 2.2",)
    assert ask(session, AtCommand("ATS3=1", Reply.RESULT), b"ATS3=1\r\nOK\r\n").result() == ("OK",)
    ask(session, AtCommand("ATI5", Reply.LINES), b"ATI5\r\nS0: A=1\r\nS1: B=2\r\nS2: C=")
    assert not session.done
    session.handle_timeout(session.next_timeout())
    assert session.result() == ("S0: A=1", "S1: B=2")  # half a line is none
    session.start(AtCommand("AT&T", Reply.NONE), 20.0)
    session.handle_timeout(session.next_timeout())
    assert session.result() == ()


def test_late_replies_of_an_earlier_command_are_dropped():
    session = ready()
    ask(session, AtCommand("RTS3?", Reply.LINE), b"17\r\nRTS3?\r\n")
    assert not session.done
    session.receive(b"25\r\n", 10.2)
    assert session.result() == ("25",)


def test_a_radio_without_echo_is_understood():
    session = ready()
    ask(session, AtCommand("ATI", Reply.LINE), b"SiK 1.9\r\n")
    session.handle_timeout(session.next_timeout())
    assert session.result() == ("SiK 1.9",)
    assert ask(session, AtCommand("ATI1", Reply.LINE), b"1.9\r\n").result() == ("1.9",)  # at once now


def test_errors_and_silence():
    session = ready()
    ask(session, AtCommand("ATS99?", Reply.LINE), b"ATS99?\r\nERROR\r\n")
    with pytest.raises(RadioError, match="answers ERROR"):
        session.result()
    session.start(AtCommand("RTI", Reply.LINE), 10.0)
    while not session.done:
        session.handle_timeout(session.next_timeout())
    assert session.data_to_send().count(b"RTI\r") == COMMAND_ATTEMPTS
    with pytest.raises(RadioError, match="remote radio is off, out of range"):
        session.result()


def test_leaving_turns_reports_off():
    session = ready()
    ask(session, AtCommand("AT&T=RSSI", Reply.NONE), b"AT&T=RSSI\r\n")
    session.handle_timeout(session.next_timeout())
    session.data_to_send()
    session.leave(20.0)
    while not session.done:
        session.handle_timeout(session.next_timeout())
    assert session.data_to_send() == b"AT&T\rATO\r"
    assert session.mode is Mode.TRANSPARENT


def test_misuse():
    with pytest.raises(InvalidStateError):
        AtSession(0).start(AtCommand("ATI", Reply.LINE), 0)
    with pytest.raises(InvalidStateError):
        AtSession(0).result()
    for text in ("A", "AT" * 9, "AT\r", "ATé"):
        with pytest.raises(InvalidArgumentError):
            AtCommand(text, Reply.LINE)


@pytest.mark.properties
@given(st.binary(max_size=200), st.sampled_from(Reply), st.integers(1, 7))
def test_any_bytes_end_in_an_outcome(data, reply, size):
    session = ready()
    session.start(AtCommand("RTI5", reply), 10.0)
    for start in range(0, len(data), size):
        session.receive(data[start : start + size], 10.0)
    for _ in range(20):
        if session.done:
            break
        session.handle_timeout(session.next_timeout())
    assert session.done
    assert session.mode is Mode.READY


def test_a_list_ends_although_the_device_is_never_silent():
    session, now = ready(), 10.0
    session.start(AtCommand("ATI5", Reply.LINES), now)
    while not session.done and now < 100.0:  # telemetry of a radio that is not in command mode any more
        session.receive(b"\xfd\x09\x00\x0a", now)
        session.handle_timeout(now)
        now += 0.1
    assert now < 40.0


def test_memory_is_bounded():
    session = ready()
    session.start(AtCommand("ATI5", Reply.LINES), 10.0)
    session.receive(b"x" * 10_000 + b"\r" + b"y\r" * 1000, 10.0)
    session.handle_timeout(session.next_timeout() + 5)
    lines = session.result()
    assert (len(lines), len(lines[0])) == (MAX_LINES, MAX_LINE)
