"""The line that is typed: echo, backspace, Ctrl-C, and the prompt after what a program printed.

Bytes come as they like, several lines in one message or half of one. A line that is too long is cut, and what
is no character is left out.
"""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING, Final

from mavstack.services.serial_control import ShellInput, ShellOpened
from mavstack.sim.px4.shell.programs import PROGRAMS, Machine

if TYPE_CHECKING:
    from mavstack.sim.autopilot.interfaces import Vehicle
    from mavstack.sim.px4.shell.journal import Journal
    from mavstack.sim.px4.state import Px4State

PROMPT: Final = "nsh> "
_LONGEST: Final = 256
_ENTER, _BACKSPACES, _INTERRUPT, _ESCAPE = "\r\n", "\b\x7f", "\x03", "\x1b"
#: In an escape sequence the letter that ends it.
_FINAL: Final = range(0x40, 0x7F)


class Console:
    """The shell of one vehicle."""

    def __init__(self, vehicle: Vehicle, state: Px4State, journal: Journal) -> None:
        self._vehicle = vehicle
        self._machine = Machine(vehicle, state, journal)
        self._line = ""
        self._escaping = False
        self._last = ""
        vehicle.on_event(ShellOpened, lambda _: self._forget())
        vehicle.on_event(ShellInput, self._typed)

    def _forget(self) -> None:
        self._line, self._last, self._escaping = "", "", False

    def _typed(self, event: ShellInput) -> None:
        if event.late:
            return  # what follows it was carried out already
        printed = "".join(self._take(character) for character in event.data.decode("ascii", errors="ignore"))
        if printed:
            self._vehicle.services.shell.feed(printed.encode("utf-8"))
            self._vehicle.touch(self._vehicle.services.shell)

    def _take(self, character: str) -> str:
        """Take one character; gives what is printed."""
        before, self._last = self._last, character
        if self._escaping and character != _INTERRUPT:
            self._escaping = character == "[" or ord(character) not in _FINAL
            return ""
        if character == "\n" and before == "\r":
            return ""
        if character in _ENTER:
            line, self._line = self._line, ""
            return "\n" + self._run(line) + PROMPT
        if character == _ESCAPE:
            self._escaping = True
        elif character == _INTERRUPT:
            self._line, self._escaping = "", False
            return "^C\n" + PROMPT
        elif character in _BACKSPACES:
            shown, self._line = ("\b \b" if self._line else ""), self._line[:-1]
            return shown
        elif character.isprintable() and len(self._line) < _LONGEST:
            self._line += character
            return character
        return ""

    def _run(self, line: str) -> str:
        try:
            name, *words = shlex.split(line) or [""]
        except ValueError:
            return "nsh: unmatched quotation mark\n"
        if not name:
            return ""
        program = PROGRAMS.get(name)
        if program is None:
            return f"nsh: {name}: command not found\n"
        return "".join(f"{printed}\n" for printed in program(self._machine, words))
