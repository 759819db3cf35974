r"""A simulated Iridium modem with its gateway, sans-IO: AT commands in, answers out.

    modem = SimulatedSbdModem()
    modem.receive(b"AT+SBDIX\r", now)
    modem.advance(now + 10); modem.output()

`sent` has the messages that reached the gateway, `deliver` puts one into the mailbox and rings. `has_signal`
False makes sessions fail with status 32.
"""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidArgumentError
from mavstack.links.sbd_modem import CREDIT_SIZE, MAX_RECEIVED, MAX_SENT, checksum

if TYPE_CHECKING:
    from collections.abc import Callable

#: Default duration of a session in seconds.
SESSION_TIME: Final = 8.0
_NO_SIGNAL: Final = 32
_BARS: Final = 4


class SimulatedSbdModem:
    """One modem, its two buffers, and the mailbox at the gateway."""

    def __init__(self, session_time: float = SESSION_TIME) -> None:
        self.has_signal = True
        #: Messages that reached the gateway, and messages that wait at the gateway.
        self.sent: list[bytes] = []
        self.mailbox: deque[bytes] = deque()
        #: Number of sessions, and number of credits that they cost.
        self.sessions = self.credits = 0
        self._session_time = session_time
        self._echo = self._ring_alert = True
        self._outgoing = self._incoming = b""
        self._numbers = [0, 0]
        self._expected = 0
        self._input = bytearray()
        self._output = bytearray()
        self._session_ends: float | None = None

    def deliver(self, message: bytes) -> None:
        """Put a message into the mailbox of the modem, and ring.

        Raises:
            InvalidArgumentError: It is empty, or has more than 270 bytes.
        """
        if not 1 <= len(message) <= MAX_RECEIVED:
            raise InvalidArgumentError(f"a message has 1 to {MAX_RECEIVED} bytes, got {len(message)}")
        self.mailbox.append(message)
        if self._ring_alert and self.has_signal:
            self._output += b"\r\nSBDRING\r\n"

    def receive(self, data: bytes, now: float) -> None:
        """Process bytes of the program."""
        self._input += data
        while self._input:
            if self._expected:
                if len(self._input) < self._expected + 2:
                    return
                self._store_message()
                continue
            end = self._input.find(b"\r")
            if end < 0:
                return
            line = bytes(self._input[:end])
            del self._input[: end + 1]
            if self._echo:
                self._output += line + b"\r"
            self._execute(line.decode("ascii", "replace").strip().upper(), now)

    def output(self) -> bytes:
        """Return the bytes for the program since the last call."""
        data = bytes(self._output)
        self._output.clear()
        return data

    def next_timeout(self) -> float | None:
        """Return when to call `advance`; None: nothing is due."""
        return self._session_ends

    def advance(self, now: float) -> None:
        """End a session that is due."""
        if self._session_ends is not None and now >= self._session_ends:
            self._session_ends = None
            self._end_session()

    def _execute(self, line: str, now: float) -> None:
        if not line or self._session_ends is not None:
            return
        commands: dict[str, Callable[[], None]] = {
            "AT+SBDRB": self._read,
            "AT+SBDD0": lambda: self._clear(outgoing=True),
            "AT+SBDD1": lambda: self._clear(incoming=True),
            "AT+SBDD2": lambda: self._clear(outgoing=True, incoming=True),
            "AT+CSQ": lambda: self._answer(f"+CSQ:{_BARS if self.has_signal else 0}"),
        }
        if line in ("AT+SBDIX", "AT+SBDIXA"):
            self.sessions += 1
            self._session_ends = now + self._session_time
        elif line.startswith("AT+SBDWB="):
            self._expect(line.partition("=")[2])
        elif line in commands:
            commands[line]()
        elif line.startswith("AT+SBDMTA="):
            self._ring_alert = line.endswith("1")
            self._answer()
        elif line.startswith(("ATE", "AT&", "AT+SBD")) or line == "AT":
            self._echo = {"ATE0": False, "ATE1": True}.get(line, self._echo)
            self._answer()
        else:
            self._output += b"\r\nERROR\r\n"

    def _expect(self, size: str) -> None:
        if not size.isdecimal() or not 1 <= int(size) <= MAX_SENT:
            self._answer("3")
            return
        self._expected = int(size)
        self._output += b"READY\r\n"

    def _store_message(self) -> None:
        size, self._expected = self._expected, 0
        message, total = bytes(self._input[:size]), bytes(self._input[size : size + 2])
        del self._input[: size + 2]
        is_valid = checksum(message) == total
        if is_valid:
            self._outgoing = message
        self._answer("0" if is_valid else "2")

    def _read(self) -> None:
        body = self._incoming
        self._output += len(body).to_bytes(2, "big") + body + checksum(body) + b"\r\nOK\r\n"

    def _clear(self, *, outgoing: bool = False, incoming: bool = False) -> None:
        self._outgoing = b"" if outgoing else self._outgoing
        self._incoming = b"" if incoming else self._incoming
        self._answer("0")

    def _end_session(self) -> None:
        if not self.has_signal:
            self._answer(f"+SBDIX: {_NO_SIGNAL}, {self._numbers[0]}, 2, 0, 0, 0")
            return
        had_message = bool(self._outgoing)
        if had_message:
            self.sent.append(self._outgoing)
            self.credits += -(-len(self._outgoing) // CREDIT_SIZE)
            self._numbers[0] += 1
        received = int(bool(self.mailbox))
        self._incoming = self.mailbox.popleft() if received else b""
        self._numbers[1] += received
        self.credits += -(-len(self._incoming) // CREDIT_SIZE) if received else int(not had_message)
        values = (0, self._numbers[0], received, self._numbers[1], len(self._incoming), len(self.mailbox))
        self._answer("+SBDIX: " + ", ".join(map(str, values)))

    def _answer(self, text: str = "") -> None:
        self._output += f"\r\n{text}\r\n\r\nOK\r\n".encode() if text else b"\r\nOK\r\n"
