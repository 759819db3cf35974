"""The simulated Iridium modem answers as the command reference says; any bytes do no harm."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import InvalidArgumentError
from mavstack.links.sbd_modem import checksum
from mavstack.radio.sbd_simulator import SESSION_TIME, SimulatedSbdModem


def answer(modem: SimulatedSbdModem, command: bytes, now: float = 0.0) -> bytes:
    modem.receive(command, now)
    return modem.output()


def test_a_session():
    modem = SimulatedSbdModem()
    assert answer(modem, b"ATE0\r") == b"ATE0\r\r\nOK\r\n"
    assert answer(modem, b"AT+SBDWB=5\r") == b"READY\r\n"
    assert answer(modem, b"hello\x02\x14") == b"\r\n0\r\n\r\nOK\r\n"
    assert answer(modem, b"AT+SBDIX\r") == b""
    modem.mailbox.extend([b"world", b"more"])
    modem.advance(SESSION_TIME)
    assert modem.output() == b"\r\n+SBDIX: 0, 1, 1, 1, 5, 1\r\n\r\nOK\r\n"
    assert answer(modem, b"AT+SBDRB\r") == b"\0\x05world" + checksum(b"world") + b"\r\nOK\r\n"
    assert (modem.sent, modem.credits) == ([b"hello"], 2)


def test_wrong_messages():
    modem = SimulatedSbdModem()
    answer(modem, b"ATE0\r")
    for written in (b"0", b"341", b"-1", b""):
        assert answer(modem, b"AT+SBDWB=" + written + b"\r") == b"\r\n3\r\n\r\nOK\r\n"
    answer(modem, b"AT+SBDWB=2\r")
    assert answer(modem, b"abxx") == b"\r\n2\r\n\r\nOK\r\n"
    assert answer(modem, b"AT+NONSENSE\r") == b"\r\nERROR\r\n"
    assert answer(modem, b"AT+CSQ\r") == b"\r\n+CSQ:4\r\n\r\nOK\r\n"
    for size in (0, 271):
        with pytest.raises(InvalidArgumentError, match=f"1 to 270 bytes, got {size}"):
            modem.deliver(bytes(size))
    assert not modem.mailbox


@given(st.lists(st.binary(max_size=100)))
def test_any_bytes(pieces):
    modem = SimulatedSbdModem()
    for number, piece in enumerate(pieces):
        answer(modem, piece, float(number))
        modem.advance(float(number))
