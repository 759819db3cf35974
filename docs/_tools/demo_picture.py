"""Make docs/images/demo.svg: the live picture that `mav demo` leaves in a terminal.

Run `python docs/_tools/demo_picture.py [SECONDS]`. The command runs in a pseudo-terminal (Linux, macOS); the
picture after so many simulated seconds is turned into an SVG that refers to no fonts on the network.
"""

from __future__ import annotations

import fcntl
import os
import pty
import re
import struct
import sys
import termios
from contextlib import suppress
from pathlib import Path

from rich.console import Console
from rich.text import Text

TARGET = Path(__file__).parents[1] / "images" / "demo.svg"
COLUMNS, ROWS = 110, 36
DEFAULT_SECONDS = 150
_LEAVE_ALTERNATE_SCREEN = "\x1b[?1049l"
_CONTROL = re.compile(r"\x1b\[[0-9;?]*[A-LN-Za-ln-z]")  # every control sequence but colours (…m)
_FONT_FACE = re.compile(r"@font-face\s*{[^}]*}\s*")


def main(seconds: float) -> None:
    """Run the command and write the picture."""
    output = run(["-m", "mavstack", "demo", "--speed", "30", "--for", f"{seconds:g}"])
    lines = last_picture(output)
    TARGET.write_text(to_svg(lines), "utf-8")
    print(f"{TARGET}: {len(lines)} lines, {TARGET.stat().st_size} bytes")


def run(arguments: list[str]) -> str:
    """Run Python with arguments in a terminal of COLUMNS times ROWS and return all output."""
    child, terminal = pty.fork()
    if child == 0:
        os.environ.update(TERM="xterm-256color", COLORTERM="truecolor")
        os.execv(sys.executable, [sys.executable, *arguments])  # noqa: S606 (the own interpreter)
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", ROWS, COLUMNS, 0, 0))
    output = bytearray()
    with suppress(OSError):  # how Linux tells that the terminal has no other end any more
        while data := os.read(terminal, 1 << 16):
            output += data
    _, status = os.waitpid(child, 0)
    if status:
        raise SystemExit(f"mav demo failed:\n{output.decode('utf-8')}")
    return output.decode("utf-8")


def last_picture(output: str) -> list[Text]:
    """Return the lines that stand on the screen after the program has ended."""
    final = output.rpartition(_LEAVE_ALTERNATE_SCREEN)[2]
    lines = [Text.from_ansi(line) for line in _CONTROL.sub("", final).replace("\r", "").split("\n")]
    while lines and not lines[-1].plain.strip():
        lines.pop()
    return lines


def to_svg(lines: list[Text]) -> str:
    """Return the lines as an SVG picture of a terminal."""
    console = Console(width=COLUMNS, record=True, file=Path(os.devnull).open("w"), color_system="truecolor")  # noqa: SIM115
    for line in lines:
        console.print(line, no_wrap=True)
    return _FONT_FACE.sub("", console.export_svg(title="mav demo"))


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else DEFAULT_SECONDS)
