"""The AT session with one SiK radio, sans-IO: command mode, commands and replies; time is an argument.

A radio passes bytes through until its program is silent for a second, sends `+++`, and is silent for another
second. Then the radio prints OK, and takes commands that end with a carriage return. It echoes each
character, prints the reply, and returns to passing bytes by ATO. Commands that begin with RT instead of AT go
to the remote radio over the air; a lost one has no reply.

Replies have no common end: a setting ends with OK or ERROR, a question with one line, a list with silence,
and some commands print nothing. The caller therefore says which `Reply` it expects. Lines before the echo of
a command belong to an earlier one, and are dropped. Sources: `at.c` and `tdm.c` of the firmware.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from enum import Enum, auto
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidArgumentError, InvalidStateError, RadioError
from mavstack.radio.replies import parse_rssi

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.radio.replies import RssiReport

#: Seconds without data before and after +++; the firmware needs one second.
GUARD_TIME: Final = 1.1
#: Seconds to wait for OK after the guard time.
ENTER_TIMEOUT: Final = 1.0
ENTER_ATTEMPTS: Final = 3
#: Seconds to wait for the reply of this radio, and of the remote radio.
LOCAL_TIMEOUT, REMOTE_TIMEOUT = 1.0, 2.0
#: Seconds without data that end a list: from this radio, and from the remote radio.
LOCAL_PAUSE, REMOTE_PAUSE = 0.3, 1.0
#: Seconds to wait for the echo of a command that has no reply.
SILENT_TIMEOUT: Final = 0.3
#: Seconds after a carriage return in which the radio loses bytes, because it runs the command.
BUSY_TIME: Final = 0.1
COMMAND_ATTEMPTS: Final = 3
#: Maximum length of a command in characters; a longer one makes the radio leave command mode.
MAX_COMMAND: Final = 16
#: Maximum length of a line in bytes and of a reply in lines; longer data is not from a radio.
MAX_LINE, MAX_LINES = 512, 200
#: Maximum number of signal reports that wait for the program; the oldest are dropped.
MAX_REPORTS: Final = 16
ESCAPE: Final = b"+++"


class Reply(Enum):
    """The kind of reply that a command has."""

    RESULT = auto()  # OK or ERROR
    LINE = auto()
    LINES = auto()
    NONE = auto()


class Mode(Enum):
    """The state of a session."""

    TRANSPARENT = auto()  # the radio passes bytes, or its mode is not known
    GUARD = auto()  # no bytes are sent before +++
    ESCAPED = auto()  # +++ was sent
    PROBING = auto()  # an empty command asks a radio that may be in command mode already
    READY = auto()
    WAITING = auto()  # waits for a reply
    LEAVING = auto()


@dataclass(frozen=True, slots=True)
class AtCommand:
    """A command for a radio.

    Attributes:
        text: The command in capital letters, without the carriage return; RT… for the remote radio.
        reply: The kind of its reply.
        attempts: How often it is sent in all if no reply comes.
        timeout: Seconds for one reply, None for that of the radio that is asked.
    """

    text: str
    reply: Reply
    attempts: int = COMMAND_ATTEMPTS
    timeout: float | None = None

    def __post_init__(self) -> None:
        if not (self.text.isascii() and self.text.isprintable() and 2 <= len(self.text) <= MAX_COMMAND):
            raise InvalidArgumentError(
                f"AT command {self.text!r} must have 2 to {MAX_COMMAND} printable ASCII characters"
            )

    @property
    def is_remote(self) -> bool:
        """True if the remote radio runs the command."""
        return self.text.startswith("RT")

    @property
    def reply_time(self) -> float:
        """Seconds after which the command is sent again."""
        if self.timeout is not None:
            return self.timeout
        if self.reply is Reply.NONE:
            return SILENT_TIMEOUT
        return REMOTE_TIMEOUT if self.is_remote else LOCAL_TIMEOUT

    @property
    def pause(self) -> float:
        """Seconds of silence that end a list."""
        return REMOTE_PAUSE if self.is_remote else LOCAL_PAUSE


class AtSession:
    """The program's side of the AT commands of one radio.

    Bytes of the radio go to `receive`, bytes for it come from `data_to_send`. An operation begins with
    `enter`, `start` or `leave`, and has ended when `done` is true; `result` returns its lines or raises its
    error.

    Args:
        now: Time at which the session begins; other programs may have sent bytes until then.
    """

    def __init__(self, now: float) -> None:
        self.mode = Mode.TRANSPARENT
        self._quiet_since = now  # time since which no byte was sent to the radio
        self._output = bytearray()
        self._line = bytearray()
        self._lines: list[str] = []
        self._command: AtCommand | None = None
        self._echoed = False
        self._echoes = True  # False after a radio replies without an echo
        self._attempts = 0
        self._deadline: float | None = None
        self._outcome: tuple[str, ...] | RadioError | None = None
        self._pieces: list[bytes] = []  # sent one after the other
        self._reports = False  # AT&T=RSSI is on
        self._new_reports: deque[RssiReport] = deque(maxlen=MAX_REPORTS)

    @property
    def done(self) -> bool:
        """True if the last operation has ended."""
        return self._outcome is not None

    def result(self) -> tuple[str, ...]:
        """Return the lines of the reply of the last operation.

        Raises:
            RadioError: The radio did not answer, or refused the command.
            InvalidStateError: The operation has not ended.
        """
        if self._outcome is None:
            raise InvalidStateError("the operation has not ended")
        if isinstance(self._outcome, RadioError):
            raise self._outcome
        return self._outcome

    def enter(self, now: float) -> None:
        """Begin to enter command mode."""
        self._begin()
        if self.mode is Mode.READY:
            self._finish(())
        else:
            self._wait_for_guard(now)

    def start(self, command: AtCommand, now: float) -> None:
        """Send a command.

        Raises:
            InvalidStateError: The radio is not in command mode.
        """
        if self.mode is not Mode.READY:
            raise InvalidStateError(f"{command.text} needs command mode: call enter() first")
        self._begin()
        self._command = command
        self._reports = command.text == "AT&T=RSSI" or (self._reports and command.text != "AT&T")
        self._send_command(now)

    def leave(self, now: float) -> None:
        """Begin to return the radio to passing bytes, in whatever mode it is.

        Bytes in the guard time after +++ keep the radio out of command mode.
        """
        self._begin()
        if self.mode in (Mode.TRANSPARENT, Mode.GUARD):
            self.assume_transparent(now)
            self._finish(())
            return
        self._pieces = [b"ATO\r"]
        if self._reports:
            self._pieces.insert(0, b"AT&T\r")
        if self.mode is not Mode.READY:
            self._pieces.insert(0, b"\r")
        self.mode, self._deadline = Mode.LEAVING, now

    def assume_transparent(self, now: float) -> None:
        """Take note that the radio passes bytes: after a reboot, or after ATO."""
        self.mode, self._deadline, self._command = Mode.TRANSPARENT, None, None
        self._reports = False
        self._new_reports.clear()
        self._quiet_since = max(self._quiet_since, now)

    def receive(self, data: bytes, now: float) -> None:
        """Process bytes of the radio."""
        for byte in data:
            if byte in b"\r\n":
                if self._line:
                    self._receive_line(bytes(self._line), now)
                    self._line.clear()
            elif len(self._line) < MAX_LINE:
                self._line.append(byte)
        command = self._command
        if (
            command is not None
            and command.reply is Reply.LINES
            and 0 < len(self._lines) < MAX_LINES  # limit: a radio that passes packets again never pauses
            and self._deadline is not None
        ):
            self._deadline = now + command.pause

    def data_to_send(self) -> bytes:
        """Return the bytes for the radio, once."""
        data = bytes(self._output)
        self._output.clear()
        return data

    def reports(self) -> list[RssiReport]:
        """Return the reports that the radio printed by itself (AT&T=RSSI), once."""
        reports = list(self._new_reports)
        self._new_reports.clear()
        return reports

    def next_timeout(self) -> float | None:
        """Return the time of the next `handle_timeout`, or None."""
        return self._deadline

    def handle_timeout(self, now: float) -> None:
        """Do what is due."""
        if self._deadline is None or now < self._deadline:
            return
        if self.mode is Mode.GUARD:
            self._send(ESCAPE, now)
            self._line.clear()
            self.mode, self._deadline = Mode.ESCAPED, now + GUARD_TIME + ENTER_TIMEOUT
        elif self.mode is Mode.ESCAPED:
            self._send(b"\r", now)
            self._pieces = [b"AT\r"]
            self.mode, self._deadline = Mode.PROBING, now + BUSY_TIME
        elif self._pieces:
            self._send(self._pieces.pop(0), now)
            self._deadline = now + (LOCAL_TIMEOUT if self.mode is Mode.PROBING else BUSY_TIME)
        elif self.mode is Mode.PROBING:
            self._retry_enter(now)
        elif self.mode is Mode.LEAVING:
            self.assume_transparent(now)
            self._finish(())
        else:
            self._end_of_time(now)

    def _begin(self) -> None:
        self._outcome, self._attempts, self._command = None, 0, None
        self._lines.clear()

    def _finish(self, outcome: Sequence[str] | RadioError) -> None:
        self._outcome = outcome if isinstance(outcome, RadioError) else tuple(outcome)
        self._deadline, self._command = None, None

    def _send(self, data: bytes, now: float) -> None:
        self._output += data
        self._quiet_since = now

    def _wait_for_guard(self, now: float) -> None:
        self._attempts += 1
        self.mode, self._deadline = Mode.GUARD, max(now, self._quiet_since + GUARD_TIME)

    def _retry_enter(self, now: float) -> None:
        if self._attempts < ENTER_ATTEMPTS:
            self._wait_for_guard(now)
            return
        self.mode = Mode.TRANSPARENT
        self._finish(
            RadioError(
                f"entering command mode failed after {ENTER_ATTEMPTS} attempts: no OK; check that the device "
                "is a SiK radio, that the baud rate is its SERIAL_SPEED, and that no other program uses it"
            )
        )

    def _receive_line(self, line: bytes, now: float) -> None:
        text = line.decode("ascii", "replace").strip()
        if self.mode in (Mode.READY, Mode.WAITING) and (report := self._report_in(text)):
            self._new_reports.append(report)
        elif self.mode in (Mode.ESCAPED, Mode.PROBING):
            if text.endswith("OK") and (
                self.mode is Mode.PROBING or now >= self._quiet_since + GUARD_TIME / 2
            ):
                self.mode = Mode.READY
                self._finish(())
        elif self.mode is Mode.WAITING and self._command is not None:
            self._receive_reply(text, self._command)

    def _report_in(self, text: str) -> RssiReport | None:
        """Return the report in a line, unless it is the reply to a command."""
        asks = self._command is not None and self._command.text[2:] == "I7"
        return None if asks else parse_rssi(text)

    def _receive_reply(self, text: str, command: AtCommand) -> None:
        if not self._echoed and text.upper().endswith(command.text):
            self._echoed, self._echoes = True, True
            self._lines.clear()
            return
        if text and len(self._lines) < MAX_LINES:
            self._lines.append(text)
        if (self._echoed or not self._echoes) and self._is_complete(command):
            self._end_reply(command)

    def _is_complete(self, command: AtCommand) -> bool:
        last = self._lines[-1:]
        if command.reply is Reply.LINE:
            return bool(last)
        return last == ["ERROR"] or (command.reply is Reply.RESULT and last == ["OK"])

    def _end_reply(self, command: AtCommand) -> None:
        self.mode = Mode.READY
        if self._lines[-1:] == ["ERROR"]:
            self._finish(RadioError(f"{command.text} failed: the radio answers ERROR", refused=True))
        else:
            self._finish(self._lines)

    def _send_command(self, now: float) -> None:
        command = self._command
        if command is None:
            return
        self._attempts += 1
        self._echoed = False
        self._lines.clear()
        self._line.clear()
        self._send(f"{command.text}\r".encode("ascii"), now)
        self.mode, self._deadline = Mode.WAITING, now + command.reply_time

    def _end_of_time(self, now: float) -> None:
        command = self._command
        if command is None:
            self._deadline = None
        elif command.reply is Reply.NONE or (command.reply is Reply.LINES and self._lines):
            self._end_reply(command)
        elif not self._echoed and self._is_complete(command):
            self._echoes = False
            self._end_reply(command)
        elif self._attempts < command.attempts:
            self._send_command(now)
        else:
            self.mode = Mode.READY
            self._finish(_no_answer(command))


def _no_answer(command: AtCommand) -> RadioError:
    remedy = "the remote radio is off, out of range, or has other parameters" if command.is_remote else ""
    attempts = f" after {command.attempts} attempts" if command.attempts > 1 else ""
    reason = f"no answer: {remedy}" if remedy else "no answer"
    return RadioError(f"{command.text} failed{attempts}: {reason}")
