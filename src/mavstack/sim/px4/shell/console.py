"""Line editor of the shell: echo, backspace, Ctrl-C, and the prompt after a program's output.

Input arrives in arbitrary pieces, several lines in one message or half a line. A line that is too long is
cut, and bytes that are not printable characters are dropped.
"""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING, Final

from mavstack.services.serial_control import ShellInput, ShellOpened
from mavstack.sim.px4.shell.programs import PROGRAMS, ShellContext

if TYPE_CHECKING:
    from mavstack.sim.px4.shell.message_log import MessageLog
    from mavstack.sim.px4.state import Px4State
    from mavstack.sim.vehicle import SimulatedVehicle

PROMPT: Final = "nsh> "
_MAX_LINE: Final = 256
_ENTER, _BACKSPACES, _INTERRUPT, _ESCAPE = "\r\n", "\b\x7f", "\x03", "\x1b"
#: Codes of the characters that end an escape sequence.
_SEQUENCE_END: Final = range(0x40, 0x7F)


class Console:
    """The shell of one vehicle."""

    def __init__(self, vehicle: SimulatedVehicle, state: Px4State, message_log: MessageLog) -> None:
        self._vehicle = vehicle
        self._context = ShellContext(vehicle, state, message_log)
        self._line = ""
        self._escaping = False
        self._last = ""
        vehicle.on_event(ShellOpened, lambda _: self._reset())
        vehicle.on_event(ShellInput, self._on_input)

    def _reset(self) -> None:
        """Discard the line when a client opens the shell."""
        self._line, self._last, self._escaping = "", "", False

    def _on_input(self, event: ShellInput) -> None:
        """Handle input, and send the output."""
        if event.late:
            return  # input after this part was already executed
        printed = "".join(
            self._handle(character) for character in event.data.decode("ascii", errors="ignore")
        )
        if printed:
            self._vehicle.services.shell.feed(printed.encode("utf-8"))
            self._vehicle.touch(self._vehicle.services.shell)

    def _handle(self, character: str) -> str:
        """Handle one character; return the output."""
        before, self._last = self._last, character
        if self._escaping and character != _INTERRUPT:
            self._escaping = character == "[" or ord(character) not in _SEQUENCE_END
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
        elif character.isprintable() and len(self._line) < _MAX_LINE:
            self._line += character
            return character
        return ""

    def _run(self, line: str) -> str:
        """Run a line; return its output."""
        try:
            name, *words = shlex.split(line) or [""]
        except ValueError:
            return "nsh: unmatched quotation mark\n"
        if not name:
            return ""
        program = PROGRAMS.get(name)
        if program is None:
            return f"nsh: {name}: command not found\n"
        return "".join(f"{printed}\n" for printed in program(self._context, words))
