r"""The command line interface (CLI) of a flight controller: lines, echo and prompt.

A peer enters it by `#`. Each character is echoed, and each line answered, with `\r\n` as line ends and a
prompt `# ` after the answer. `save` and `exit` end it by a reboot. The commands are a registry (see
`cli_commands`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

PROMPT: Final = "\r\n# "
GREETING: Final = "\r\nEntering CLI Mode, type 'exit' to return, or 'help'\r\n"
MAX_LINE: Final = 256
_BACKSPACE, _END, _DELETE = 8, 4, 127
_LINE_ENDS: Final = b"\r\n"
_FIRST_PRINTABLE, _LAST_PRINTABLE = 32, 126


class CommandLine:
    """One session of the CLI.

    Args:
        commands: The commands by name; each gets the text behind its name and returns its answer.
    """

    def __init__(self, commands: Mapping[str, Callable[[str], str]]) -> None:
        self._commands = commands
        self._line = bytearray()
        #: True after the command `save` or `exit`.
        self.closed = False

    def greeting(self) -> bytes:
        """Return the text that begins the session."""
        return (GREETING + PROMPT).encode()

    def feed(self, data: bytes) -> bytes:
        """Process typed bytes; returns echo and answers. Bytes after the end of the session are dropped."""
        output = bytearray()
        for byte in data:
            if self.closed:
                break
            output += self._key(byte)
        return bytes(output)

    def _key(self, byte: int) -> bytes:
        if byte in _LINE_ENDS:
            return self._enter() if self._line else b""
        if byte == _END and not self._line:
            return self._answer("exit").encode()
        if byte in (_BACKSPACE, _DELETE):
            return b"\x08 \x08" if self._line and self._line.pop() else b""
        is_blank = byte == _FIRST_PRINTABLE and not self._line
        if is_blank or len(self._line) >= MAX_LINE or not _FIRST_PRINTABLE <= byte <= _LAST_PRINTABLE:
            return b""
        self._line.append(byte)
        return bytes([byte])

    def _enter(self) -> bytes:
        line = self._line.decode().split("#", 1)[0].rstrip()
        self._line.clear()
        answer = "\r\n" + (self._answer(line) if line else "")
        return (answer if self.closed else answer + PROMPT).encode()

    def _answer(self, line: str) -> str:
        word, _, rest = line.partition(" ")
        command = self._commands.get(word.lower())
        if command is None:
            return "###ERROR IN input: UNKNOWN COMMAND, TRY 'HELP'###"
        text = command(rest.strip())
        self.closed = word.lower() in ("save", "exit")
        return text.replace("\n", "\r\n")
