"""The conversation with an Iridium modem for short burst data (SBD: 9602, 9603, RockBLOCK), sans-IO.

A session (AT+SBDIX) sends the message in the modem (AT+SBDWB) and fetches one from the mailbox of the gateway
(AT+SBDRB). A message to the gateway has up to 340 bytes, one from it up to 270. Sessions cost money and take
some ten seconds, so packets are collected for `interval` seconds and joined; of more than `MAX_WAITING`
messages the oldest is dropped. The mailbox is checked after SBDRING, while more messages wait there, and each
`poll` seconds. A session that fails is repeated later, at growing intervals. Source: Iridium's ISU AT command
reference.
"""

from __future__ import annotations

import re
from collections import deque
from dataclasses import dataclass
from enum import Enum, auto
from typing import Final

#: Maximum size of a message to the gateway, and from it, in bytes.
MAX_SENT: Final = 340
MAX_RECEIVED: Final = 270
#: Maximum number of messages that wait for a session.
MAX_WAITING: Final = 8
#: Number of bytes that cost one credit of a RockBLOCK.
CREDIT_SIZE: Final = 50
#: Timeout of a command in seconds, and of a session.
COMMAND_TIMEOUT: Final = 5.0
SESSION_TIMEOUT: Final = 90.0
#: Seconds until the first repetition of a failed session, and maximum seconds until a further one.
FIRST_RETRY: Final = 10.0
MAX_RETRY: Final = 300.0
#: Largest result of a session which means that the message was sent.
_MAX_SENT_STATUS: Final = 4
_MAX_LINE: Final = 400
_SETUP: Final = ("ATE0", "AT&K0", "AT+SBDMTA=1", "AT+SBDD2")
_RESULT: Final = re.compile(r"\+SBDIX: *(\d+), *(\d+), *(\d+), *(\d+), *(\d+), *(\d+)", re.ASCII)


class _Step(Enum):
    SETUP = auto()
    IDLE = auto()
    WRITE = auto()  # AT+SBDWB was sent, READY is expected
    DATA = auto()  # the message was sent, the result is expected
    WRITTEN = auto()  # the modem has the message, OK is expected
    SESSION = auto()
    ENDED = auto()  # the session ended, OK is expected
    READ = auto()
    CLEAR = auto()


@dataclass(slots=True)
class SbdStatistics:
    """Counters of a modem.

    Attributes:
        sessions: Sessions that were begun.
        failed: Sessions without success.
        sent: Messages that the gateway has.
        received: Messages from the gateway.
        credits: Credits of 50 bytes for both, and one for each check of an empty mailbox.
        dropped: Packets that were dropped, because too many waited or they were too large.
    """

    sessions: int = 0
    failed: int = 0
    sent: int = 0
    received: int = 0
    credits: int = 0
    dropped: int = 0


class SbdModem:
    """One modem.

    Args:
        now: The time, in seconds.
        interval: Seconds between the starts of two sessions, at least.
        poll: Seconds after which the mailbox is checked; 0: only after SBDRING.
    """

    def __init__(self, now: float, *, interval: float = 60.0, poll: float = 0.0) -> None:
        self.statistics = SbdStatistics()
        self._interval, self._poll = interval, poll
        self._waiting: deque[bytes] = deque()
        self._received: list[bytes] = []
        self._output = bytearray()
        self._input = bytearray()
        self._step = _Step.SETUP
        self._setup = deque(_SETUP)
        self._due: float | None = now + COMMAND_TIMEOUT
        self._next_session = now
        self._next_poll = now + poll
        self._retry = FIRST_RETRY
        self._sending: bytes | None = None
        self._must_check = self._has_message = False
        self._command(self._setup[0])

    # Interface to the program

    def send(self, packet: bytes, now: float) -> bool:
        """Queue a packet; False if it, or an older one, was dropped. Nothing is sent for an empty one."""
        if len(packet) > MAX_SENT:
            self.statistics.dropped += 1
            return False
        if not packet:  # modems refuse a message without bytes, which would be repeated without an end
            return True
        if self._waiting and len(self._waiting[-1]) + len(packet) <= MAX_SENT:
            self._waiting[-1] += packet
        else:
            self._waiting.append(bytes(packet))
        kept = len(self._waiting) <= MAX_WAITING
        if not kept:
            self._waiting.popleft()
            self.statistics.dropped += 1
        self._begin_if_due(now)
        return kept

    def take(self) -> list[bytes]:
        """Return the messages that were received since the last call."""
        received, self._received = self._received, []
        return received

    def data_to_send(self) -> bytes:
        """Return the bytes for the modem since the last call."""
        data = bytes(self._output)
        self._output.clear()
        return data

    def next_timeout(self) -> float | None:
        """Return when to call `handle_timeout`; None: never."""
        if self._step is not _Step.IDLE:
            return self._due
        times = [self._next_session] if self._wants_session else []
        if self._poll:
            times.append(max(self._next_poll, self._next_session))
        return min(times, default=None)

    def handle_timeout(self, now: float) -> None:
        """Handle the timers that are due."""
        if self._step is not _Step.IDLE and self._due is not None and now >= self._due:
            self._time_out(now)
        if self._poll and now >= self._next_poll:
            self._must_check = True
        self._begin_if_due(now)

    # Interface to the modem

    def receive(self, data: bytes, now: float) -> None:
        """Process bytes of the modem."""
        self._input += data
        while self._step_once(now):
            pass
        del self._input[: max(len(self._input) - 4096, 0)]
        self._begin_if_due(now)

    def _step_once(self, now: float) -> bool:
        """Process one line or one message; return whether there was one."""
        if self._step is _Step.READ and (message := self._message()) is not None:
            self._take_message(message, now)
            return True
        end = self._input.find(b"\r")
        if self._step is _Step.READ or end < 0:
            return False
        line = bytes(self._input[:end]).decode("ascii", "replace").strip()[:_MAX_LINE]
        del self._input[: end + 1]
        if line:
            self._take_line(line, now)
        return True

    def _message(self) -> bytes | None:
        """Return the message after AT+SBDRB with its length and its sum; None if it is not complete."""
        while self._input and self._input[0] in b"\r\n":
            del self._input[:1]
        if len(self._input) < 2:
            return None
        size = int.from_bytes(self._input[:2], "big")
        if size > MAX_RECEIVED:  # an echo or a line of text instead: messages are not that long
            self._input.clear()
            return b""
        if len(self._input) < size + 4:
            return None
        body, total = bytes(self._input[2 : size + 2]), self._input[size + 2 : size + 4]
        del self._input[: size + 4]
        return body if checksum(body) == total else b""

    def _take_message(self, message: bytes, now: float) -> None:
        if message:
            self.statistics.received += 1
            self.statistics.credits += -(-len(message) // CREDIT_SIZE)
            self._received.append(message)
        self._enter(_Step.CLEAR, now)
        self._command("AT+SBDD2")

    def _take_line(self, line: str, now: float) -> None:
        if line == "SBDRING":
            self._must_check = True
        elif found := _RESULT.search(line):
            self._session_ended([int(group) for group in found.groups()], now)
        elif line == "ERROR":
            self._failed(now)
        elif line == "OK":
            self._confirmed(now)
        elif self._step is _Step.WRITE and line == "READY" and self._sending is not None:
            self._output += self._sending + checksum(self._sending)
            self._enter(_Step.DATA, now)
        elif self._step is _Step.DATA and line.isdecimal():
            self._written(line, now)

    def _confirmed(self, now: float) -> None:
        match self._step:
            case _Step.SETUP:
                self._advance_setup(now)
            case _Step.WRITTEN:
                self._begin_session(now)
            case _Step.ENDED:
                self._enter(_Step.READ if self._has_message else _Step.CLEAR, now)
                self._command("AT+SBDRB" if self._has_message else "AT+SBDD2")
            case _Step.CLEAR:
                self._enter(_Step.IDLE, now)

    def _advance_setup(self, now: float) -> None:
        self._setup.popleft()
        if self._setup:
            self._enter(_Step.SETUP, now)
            self._command(self._setup[0])
        else:
            self._enter(_Step.IDLE, now)

    def _written(self, status: str, now: float) -> None:
        if status == "0":
            self._enter(_Step.WRITTEN, now)
        else:
            self._failed(now)

    # Sessions

    @property
    def _wants_session(self) -> bool:
        return bool(self._waiting or self._sending or self._must_check)

    def _begin_if_due(self, now: float) -> None:
        if self._step is not _Step.IDLE or not self._wants_session or now < self._next_session:
            return
        if self._sending is None and self._waiting:
            self._sending = self._waiting.popleft()
        if self._sending is None:
            self._begin_session(now)
            return
        self._enter(_Step.WRITE, now)
        self._command(f"AT+SBDWB={len(self._sending)}")

    def _begin_session(self, now: float) -> None:
        self.statistics.sessions += 1
        self._next_session = now + self._interval
        self._next_poll = now + self._poll
        self._step, self._due = _Step.SESSION, now + SESSION_TIMEOUT
        self._command("AT+SBDIX")

    def _session_ended(self, result: list[int], now: float) -> None:
        if self._step is not _Step.SESSION:
            return
        sent_status, _, received_status, _, _, queued = result
        if sent_status > _MAX_SENT_STATUS or received_status == 2:
            self._failed(now)
            return
        self._retry = FIRST_RETRY
        self._must_check = queued > 0
        if queued:
            self._next_session = now
        if self._sending is not None:
            self.statistics.sent += 1
            self.statistics.credits += -(-len(self._sending) // CREDIT_SIZE)
            self._sending = None
        elif received_status == 0:
            self.statistics.credits += 1
        self._has_message = received_status == 1
        self._enter(_Step.ENDED, now)

    def _failed(self, now: float) -> None:
        if self._step is _Step.SESSION:
            self.statistics.failed += 1
            self._must_check = self._must_check or self._sending is None
        self._next_session = now + self._retry
        self._retry = min(self._retry * 2, MAX_RETRY)
        self._enter(_Step.IDLE, now)

    def _time_out(self, now: float) -> None:
        if self._step is _Step.SETUP:
            self._setup = deque(_SETUP)
            self._enter(_Step.SETUP, now)
            self._command(self._setup[0])
        else:
            self._failed(now)

    def _enter(self, step: _Step, now: float) -> None:
        self._step = step
        self._due = None if step is _Step.IDLE else now + COMMAND_TIMEOUT

    def _command(self, text: str) -> None:
        self._output += text.encode() + b"\r"


def checksum(message: bytes) -> bytes:
    """Return the sum of the bytes of a message, as it follows the message on the wire."""
    return (sum(message) & 0xFFFF).to_bytes(2, "big")
