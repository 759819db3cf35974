"""The conversation with a simulated Iridium modem, in virtual time; any bytes of a modem do no harm."""

from __future__ import annotations

from random import Random

from hypothesis import given
from hypothesis import strategies as st

from mavstack.links.sbd_modem import FIRST_RETRY, MAX_SENT, MAX_WAITING, SbdModem
from mavstack.radio.sbd_simulator import SESSION_TIME, SimulatedSbdModem


class Pair:
    """A modem and its program, whose bytes may arrive in pieces."""

    def __init__(self, *, interval: float = 0.0, poll: float = 0.0, seed: int = 0) -> None:
        self.now = 0.0
        self.program = SbdModem(0.0, interval=interval, poll=poll)
        self.modem = SimulatedSbdModem()
        self.received: list[bytes] = []
        self._random = Random(seed)

    def run(self, seconds: float) -> None:
        end = self.now + seconds
        while True:
            self._exchange()
            dues = (self.program.next_timeout(), self.modem.next_timeout())
            due = min((due for due in dues if due is not None), default=end)
            if due >= end:
                self.now = end
                return
            self.now = max(due, self.now)
            self.program.handle_timeout(self.now)
            self.modem.advance(self.now)

    def _exchange(self) -> None:
        while (data := self.program.data_to_send()) or (answer := self.modem.output()):
            if data:
                self.modem.receive(data, self.now)
                continue
            while answer:
                size = self._random.randint(1, len(answer))
                self.program.receive(answer[:size], self.now)
                answer = answer[size:]
        self.received += self.program.take()


def test_packets_are_joined_to_messages():
    pair = Pair(interval=60)
    pair.run(1)
    for number in range(3):
        pair.program.send(bytes([number]) * 150, pair.now)
    pair.run(SESSION_TIME + 1)
    assert pair.modem.sent == [bytes([0]) * 150], "the first one goes at once"
    pair.run(60)
    assert pair.modem.sent[1:] == [bytes([1]) * 150 + bytes([2]) * 150]
    assert pair.program.statistics.credits == pair.modem.credits == 3 + 6
    assert pair.program.statistics.sessions == 2


@given(st.lists(st.binary(min_size=1, max_size=270), max_size=6), st.integers(0, 1000))
def test_messages_of_the_mailbox_arrive(messages, seed):
    pair = Pair(seed=seed)
    pair.run(1)
    for message in messages:
        pair.modem.deliver(message)
    pair.run(200)
    assert pair.received == messages
    assert pair.program.statistics.received == len(messages)


def test_without_a_signal_sessions_are_repeated_later():
    pair = Pair()
    pair.run(1)
    pair.modem.has_signal = False
    pair.program.send(b"report", pair.now)
    pair.run(FIRST_RETRY * 7 + 4 * SESSION_TIME)
    assert pair.program.statistics.failed == 3
    pair.modem.has_signal = True
    pair.run(300)
    assert pair.modem.sent == [b"report"]


def test_the_mailbox_is_checked_without_a_ring():
    pair = Pair(poll=600)
    pair.run(1)
    pair.modem.mailbox.append(b"hello")
    pair.run(650)
    assert pair.received == [b"hello"]
    pair.run(600)
    assert pair.program.statistics.credits == 1 + 1, "an empty mailbox costs one credit"


def test_too_much_is_dropped():
    modem = SbdModem(0.0)
    assert not modem.send(bytes(MAX_SENT + 1), 0.0)
    assert all(modem.send(bytes(MAX_SENT), 0.0) for _ in range(MAX_WAITING))
    assert not modem.send(bytes(MAX_SENT), 0.0)
    assert modem.statistics.dropped == 2


def test_an_empty_packet_starts_no_session():
    pair = Pair()
    pair.run(1)
    assert pair.program.send(b"", pair.now)
    assert pair.program.data_to_send() == b""
    pair.run(600)
    assert pair.program.statistics.sessions == pair.program.statistics.dropped == 0
    assert pair.program.next_timeout() is None


def test_a_modem_that_is_plugged_in_later():
    modem = SbdModem(0.0)
    assert modem.data_to_send() == b"ATE0\r"
    modem.handle_timeout(5.0)
    assert modem.data_to_send() == b"ATE0\r"


PIECES = st.lists(
    st.one_of(
        st.binary(max_size=400),
        st.sampled_from(
            [
                b"OK\r",
                b"READY\r",
                b"0\r\n",
                b"SBDRING\r",
                b"ERROR\r",
                b"+SBDIX: 0, 1, 1, 1, 5, 9\r\n",
                b"\0\x05hello\x02\x14",
            ]
        ),
    )
)


@given(PIECES, PIECES)
def test_any_bytes(first, second):
    modem = SbdModem(0.0, poll=10)
    now = 0.0
    for number, piece in enumerate([*first, *second]):
        modem.send(b"x" * (number % 30), now)
        modem.receive(piece, now)
        due = modem.next_timeout()
        now = now + 1 if due is None else max(now, due)
        modem.handle_timeout(now)
        modem.data_to_send()
        assert all(len(message) <= 270 for message in modem.take())
