r"""The command line interface (CLI) of Betaflight and iNav, sans-IO: lines, replies and errors.

`#` opens the CLI. It echoes each character, prints the reply, and ends with the prompt `\r\n# `. A prompt is
no proof that a reply is complete, since the headings in a dump look alike. Each line is therefore followed by
a marker, a comment with a number: its echo shows that the reply is complete.

`exit` and `save` restart the firmware, and settings that were not saved are lost. In a batch, errors are
counted by the firmware, and make it refuse `save`. Source: `cli.c` of both firmwares.
"""

from __future__ import annotations

import re
from typing import Final

from mavstack.errors import InvalidArgumentError

#: The bytes that open the CLI.
ENTER: Final = b"#"
PROMPT: Final = b"\r\n# "
#: Commands that restart the firmware or leave the CLI, so that the firmware echoes no marker after them.
LEAVING: Final = frozenset({"bl", "bootloader", "defaults", "dfu", "exit", "msc", "save"})
#: Maximum length of a line in characters; the buffers of old firmware are not larger.
MAX_LINE: Final = 120
#: Maximum size of a reply in bytes, larger than any dump.
MAX_REPLY: Final = 4 << 20
_ERROR: Final = re.compile(r"^#{2,3} ?ERROR.*|^ERR_CMD_NA.*|^Invalid .*", re.IGNORECASE | re.MULTILINE)


class CliDialog:
    """The text of an open CLI: lines to it, and complete replies from it."""

    def __init__(self) -> None:
        self._text = bytearray()
        self._line = b""
        self._marker = b""
        self._number = 0

    @property
    def at_prompt(self) -> bool:
        """True if the text ends with a prompt: the CLI is open."""
        return self._text.endswith(PROMPT)

    @property
    def text(self) -> str:
        """The text that no reply has used yet."""
        return _decode(self._text)

    def receive(self, data: bytes) -> None:
        """Add received text."""
        self._text += data
        del self._text[:-MAX_REPLY]

    def send(self, line: str) -> bytes:
        """Return the bytes of a line, with its marker.

        Args:
            line: The line, without its end.

        Raises:
            InvalidArgumentError: The line is too long, or has characters that the CLI takes as keys.
        """
        check_line(line)
        self._number += 1
        self._line, self._marker = line.strip().encode("ascii"), f"# end {self._number}".encode("ascii")
        self._text.clear()
        if not is_leaving(line):
            return self._line + b"\n" + self._marker + b"\n"
        return self._line + b"\n"

    def reply(self) -> str | None:
        """Return the reply to the last line, without its echo; None if it is not complete."""
        end = self._text.find(self._marker)
        if not self._marker or end < 0:
            return None
        reply = bytes(self._text[:end]).removesuffix(PROMPT)
        self._text.clear()
        self._marker = b""
        echo = reply.find(self._line)
        if self._line and echo >= 0 and not reply[:echo].strip(b"\r\n# "):
            reply = reply[echo + len(self._line) :]
        return _decode(reply).strip("\n")


def check_line(line: str) -> None:
    """Check that the CLI takes a line as it is.

    Raises:
        InvalidArgumentError: It does not; the text says why.
    """
    if len(line) > MAX_LINE:
        raise InvalidArgumentError(f"CLI line must have at most {MAX_LINE} characters, got {len(line)}")
    if not line.isascii() or not line.isprintable() or "?" in line:
        raise InvalidArgumentError(
            f"CLI line {line!r} must be printable ASCII without '?', which asks for completion"
        )


def is_leaving(line: str) -> bool:
    """Return whether a line restarts the firmware or leaves the CLI."""
    words = line.partition("#")[0].lower().split()
    return bool(words) and words[0] in LEAVING and not {"nosave", "noreboot"} & set(words[1:])


def errors_in(reply: str) -> list[str]:
    """Return the errors in a reply, one for each line that reports one."""
    return [match[0].strip("# ") for match in _ERROR.finditer(reply)]


def restore_lines(dump: str) -> list[tuple[int, str]]:
    """Return the commands of a dump with their line numbers, without comments and the final `save`.

    Args:
        dump: The text of `diff all` or another dump.

    Raises:
        InvalidArgumentError: A line cannot be sent; the text names it.
    """
    commands: list[tuple[int, str]] = []
    for number, text in enumerate(dump.splitlines(), 1):
        line = text.strip()
        if not line or line.startswith("#"):
            continue
        if is_leaving(line) or line.lower().startswith("save"):
            continue
        try:
            check_line(line)
        except InvalidArgumentError as error:
            raise InvalidArgumentError(f"line {number}: {error}") from None
        commands.append((number, line))
    return commands


def _decode(data: bytes | bytearray) -> str:
    return bytes(data).decode("ascii", "replace").replace("\r\n", "\n").replace("\r", "")
