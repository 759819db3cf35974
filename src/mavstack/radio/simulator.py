"""A pair of simulated SiK radios, sans-IO: command mode, parameters, EEPROM, the air between them.

Each radio passes the bytes of its program to the other one as long as both run with equal shared parameters.
Like the firmware, a radio runs with the parameters that it had when it booted, enters command mode by the
guard times, loses bytes while it works on a command, and cuts the reply to a remote command to one packet.
`pseudo_terminals.py` puts a pair on two terminals of the operating system.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial
from heapq import heappop, heappush
from itertools import count
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidArgumentError
from mavstack.radio.parameters import PARAMETERS, SHARED

if TYPE_CHECKING:
    from collections.abc import Callable

BANNER: Final = "SiK 2.2 on HM-TRP"
#: Replies to ATI1 to ATI4: version, board, frequency (0x91: 915 MHz), boot loader.
IDENTITY: Final = ("2.2", "77", "145", "1")
DEFAULTS: Final = (26, 57, 64, 25, 20, 0, 1, 0, 915000, 928000, 50, 100, 0, 0, 0, 131)
NAMES: Final = tuple(PARAMETERS)
_SHARED_NUMBERS: Final = tuple(number for number, name in enumerate(NAMES) if name in SHARED)
_MAX_WINDOW, _MAX_COMMAND, _MAX_REPLY = 131, 16, 252
#: Seconds: guard time around +++, run of a command, restart, and search until two radios find each other.
GUARD, WORK, BOOT, SYNC = 1.0, 0.005, 0.5, 1.0
#: Seconds that a packet takes over the air.
AIR_TIME: Final = 0.03


@dataclass
class SimulatedRadio:
    """One radio of a pair.

    Attributes:
        values: The parameters as ATSn? shows them.
        stored: The parameters in the EEPROM.
        running: The parameters with which the radio booted.
        in_command_mode: True between +++ and ATO.
        powered: False for a radio that is switched off.
        updating: True once AT&UPDATE has started the boot loader.
    """

    values: list[int] = field(default_factory=lambda: list(DEFAULTS))
    stored: list[int] = field(default_factory=lambda: list(DEFAULTS))
    running: list[int] = field(default_factory=lambda: list(DEFAULTS))
    in_command_mode: bool = False
    powered: bool = True
    reports: bool = False
    updating: bool = False
    boots: int = 0
    #: Returns whether a command must fail: with ERROR, or ATZ without a restart.
    fails: Callable[[str], bool] = lambda command: False

    def __post_init__(self) -> None:
        self.output = bytearray()
        self.ready_at = self._busy_until = self._last_input = self._next_report = float("-inf")
        self._pluses = 0
        self._command = bytearray()
        self.received = 0

    def set(self, **values: int) -> None:
        """Set, store and run with parameters, given by name."""
        for name, value in values.items():
            self.values[NAMES.index(name)] = value
        self.stored, self.running = list(self.values), list(self.values)

    def reboot(self, now: float) -> None:
        """Start again with the stored parameters."""
        self.values, self.running = list(self.stored), list(self.stored)
        self.in_command_mode = self.reports = False
        self._command.clear()
        self._pluses = 0
        self.boots += 1
        self.ready_at, self._last_input = now + BOOT, now + BOOT

    def feed(self, data: bytes, now: float) -> tuple[bytes, list[str]]:
        """Process bytes of the program.

        Returns:
            The bytes for the air, and the complete commands.
        """
        if not self.powered or now < self.ready_at:
            return b"", []
        commands: list[str] = []
        air = bytearray()
        for byte in data:
            if not self.in_command_mode:
                self._watch_for_escape(byte, now)
                air.append(byte)
            elif now >= self._busy_until:  # bytes are lost while a command runs
                self._feed_command(byte, now, commands)
        return bytes(air), commands

    def advance(self, now: float) -> None:
        """Enter command mode, or report, if it is time to."""
        if self._pluses == len("+++") and now >= self._last_input + GUARD and not self.in_command_mode:
            self.in_command_mode, self._pluses = True, 0
            self._command.clear()
            self.print("OK")

    def next_timeout(self) -> float | None:
        """Return the time of the next `advance`, or None."""
        if self._pluses == len("+++"):
            return self._last_input + GUARD
        return self._next_report if self.reports else None

    def print(self, line: str) -> None:
        """Print a line on the serial port."""
        self.output += f"{line}\r\n".encode("ascii")

    def run(self, command: str, now: float) -> list[str]:
        """Run a command, with AT at its beginning, and return the lines of its reply."""
        if self.fails(command):
            return [] if command == "ATZ" else ["ERROR"]
        self.updating = command == "AT&UPDATE"
        body = command[2:]
        simple = {"": ["OK"], "&UPDATE": [], "O": [], "I": [BANNER], "I0": [BANNER], "I7": [self._report()]}
        if body == "O":
            self.in_command_mode, self._last_input = False, now
        if body in simple:
            return simple[body]
        if body == "Z":
            self.reboot(now)
            return []
        if body in ("&W", "&F"):
            self._store(defaults=body == "&F")
            return ["OK"]
        if body.startswith("&T"):
            return self._test(body, now)
        if body == "I6":
            return ["silence_period: 65", "tx_window_width: 469", "max_data_packet_length: 156"]
        if body == "I5":
            return [f"S{number}: {NAMES[number]}={value}" for number, value in enumerate(self.values)]
        if body in ("I1", "I2", "I3", "I4"):
            return [IDENTITY[int(body[1]) - 1]]
        return self._register(body[1:]) if body.startswith("S") else ["ERROR"]

    def _watch_for_escape(self, byte: int, now: float) -> None:
        silent = now >= self._last_input + GUARD
        if byte != ord("+") or not (self._pluses or silent) or self._pluses == len("+++"):
            self._pluses = 0
        else:
            self._pluses += 1
        self._last_input = now

    def _feed_command(self, byte: int, now: float, commands: list[str]) -> None:
        if byte == ord("\r"):
            self.output += b"\r\n"
            commands.append(self._command.decode("ascii"))
            self._command.clear()
            self._busy_until = now + WORK
        elif len(self._command) >= _MAX_COMMAND:
            self.in_command_mode, self._last_input = False, now
            self._command.clear()
        elif 32 <= byte < 127:
            character = chr(byte).upper().encode("ascii")
            self._command += character
            self.output += character

    def _store(self, *, defaults: bool) -> None:
        if defaults:
            self.values = list(DEFAULTS)
        else:
            self.stored = list(self.values)

    def _test(self, body: str, now: float) -> list[str]:
        if body == "&T":
            self.reports = False
        elif body == "&T=RSSI":
            self.reports = not self.reports
            self._next_report = now + 1
        else:
            return ["ERROR"]
        return []

    def _register(self, text: str) -> list[str]:
        number, mark, value = text.partition("=") if "=" in text else text.partition("?")
        if not number.isdecimal() or int(number) >= len(NAMES) or not mark:
            return ["ERROR"]
        if mark == "?":
            return [str(self.values[int(number)])]
        return ["OK"] if value.isdecimal() and self._assign(int(number), int(value)) else ["ERROR"]

    def _assign(self, number: int, value: int) -> bool:
        parameter = PARAMETERS[NAMES[number]]
        try:
            parameter.check(value)
        except InvalidArgumentError:
            return False
        if parameter.name == "MAX_WINDOW" and value > _MAX_WINDOW:
            return False
        self.values[number] = value
        return True

    def _report(self) -> str:
        packets, self.received = self.received, 0
        errors = "txe=0 rxe=0 stx=0 srx=0 ecc=0/0 temp=31 dco=0"
        return f"L/R RSSI: 180/176  L/R noise: 50/48 pkts: {packets}  {errors}"

    def report_if_due(self, now: float) -> None:
        """Print a report each second while AT&T=RSSI is on."""
        if self.reports and now >= self._next_report:
            self._next_report = now + 1
            self.print(self._report())


class RadioPair:
    """Two radios and the air between them; `near` and `far` are the radios with the indexes 0 and 1."""

    def __init__(self) -> None:
        self.near, self.far = SimulatedRadio(), SimulatedRadio()
        self._radios = (self.near, self.far)
        self._due: list[tuple[float, int, Callable[[float], None]]] = []
        self._order = count()
        #: Called for each packet; returns whether the packet is lost.
        self.loses: Callable[[], bool] = lambda: False

    def connected(self, now: float) -> bool:
        """Return whether the radios have found each other."""
        near, far = self._radios
        return all(radio.powered and now >= radio.ready_at + SYNC for radio in self._radios) and all(
            near.running[number] == far.running[number] for number in _SHARED_NUMBERS
        )

    def receive(self, index: int, data: bytes, now: float) -> None:
        """Process bytes of the program at one end."""
        self.advance(now)
        radio = self._radios[index]
        air, commands = radio.feed(data, now)
        if air:
            self._transmit(index, now, lambda at: self._pass_on(1 - index, air))
            radio.advance(now)
        for command in commands:
            self._schedule(now + WORK, partial(self._run, index, command))

    def output(self, index: int) -> bytes:
        """Return the bytes for the program at one end, once."""
        radio = self._radios[index]
        data = bytes(radio.output)
        radio.output.clear()
        return data

    def advance(self, now: float) -> None:
        """Do what is due."""
        while self._due and self._due[0][0] <= now:
            at, _, deliver = heappop(self._due)
            deliver(at)
        for radio in self._radios:
            radio.advance(now)
            radio.report_if_due(now)

    def next_timeout(self) -> float | None:
        """Return the time of the next `advance`, or None."""
        times = [time for radio in self._radios if (time := radio.next_timeout()) is not None]
        return min([*times, *(entry[0] for entry in self._due[:1])], default=None)

    def _transmit(self, index: int, now: float, deliver: Callable[[float], None]) -> None:
        if self.connected(now) and not self.loses():
            self._schedule(now + AIR_TIME, deliver)

    def _schedule(self, at: float, work: Callable[[float], None]) -> None:
        heappush(self._due, (at, next(self._order), work))

    def _pass_on(self, index: int, data: bytes) -> None:
        radio = self._radios[index]
        radio.received += 1
        if not radio.in_command_mode:
            radio.output += data

    def _run(self, index: int, command: str, now: float) -> None:
        radio = self._radios[index]
        if command.startswith("AT"):
            for line in radio.run(command, now):
                radio.print(line)
        elif command.startswith("RT"):
            self._transmit(index, now, lambda at: self._run_remote(index, command, at))

    def _run_remote(self, index: int, command: str, now: float) -> None:
        peer = self._radios[1 - index]
        was_online = not peer.in_command_mode
        reply = "".join(f"{line}\r\n" for line in peer.run(f"AT{command[2:]}", now))[:_MAX_REPLY]
        peer.in_command_mode = peer.in_command_mode and not was_online
        if reply:
            self._transmit(1 - index, now, lambda at: self._show(index, reply))

    def _show(self, index: int, reply: str) -> None:
        if self._radios[index].in_command_mode:
            self._radios[index].output += reply.encode("ascii")
