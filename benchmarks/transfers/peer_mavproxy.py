"""MAVProxy as a client: the program itself, spoken to as a person would, its output read for the end.

For parameters the clock runs from its word that the vehicle is there, at which it begins to fetch them by
itself, to its word that it has them; for a mission from the command to its word.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

from .child import Answer, Job, serve

if TYPE_CHECKING:
    from collections.abc import Callable

HEARD = "Detected vehicle"
HEADER = "QGC WPL 110"
WITH_FLOATS = {6: 3}  # the frame as its file format writes it


class _Console:
    """A running MAVProxy."""

    def __init__(self, job: Job, modules: str, *commands: str) -> None:
        self._process = subprocess.Popen(
            [
                *(sys.executable, "-u", str(Path(sys.executable).with_name("mavproxy.py"))),
                f"--master=udpout:127.0.0.1:{job['port']}",
                f"--default-modules={modules}",
                "--no-state",
                "--mav20",
                *(f"--cmd={command}" for command in commands),
            ],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            cwd=job["folder"],
        )

    def say(self, command: str) -> None:
        """Type a command."""
        if self._process.stdin is not None:
            self._process.stdin.write(command + "\n")
            self._process.stdin.flush()

    def wait(self, *words: str) -> float:
        """Read until a line has all the words; when that was."""
        assert self._process.stdout is not None
        for line in self._process.stdout:
            print(line, end="", file=sys.stderr)
            if all(word in line for word in words):
                return perf_counter()
        raise RuntimeError("MAVProxy ended")

    def close(self) -> None:
        """End it."""
        self._process.kill()


def _parameters(job: Job, *, packed: bool) -> Answer:
    console = _Console(job, "ftp,param", *(() if packed else ("set param_ftp 0",)))
    start = console.wait(HEARD)
    end = console.wait("Received ", " parameters")  # a list, where the packed file failed
    saved = Path(job["folder"]) / "mavproxy.parm"
    console.say(f"param save {saved}")
    console.wait("Saved ")
    console.close()
    pairs = (line.split() for line in saved.read_text(encoding="utf-8").splitlines() if line.strip())
    return {"seconds": end - start, "parameters": {pair[0]: float(pair[1]) for pair in pairs}}


def _row(at: int, frame: int, command: int, x: int, y: int, z: float) -> str:
    """An item as a line of a plan's file: place, current, frame, command, four params, position, continue."""
    place = (f"{x / 1e7:.8f}", f"{y / 1e7:.8f}", f"{z:.6f}")
    cells = (at, int(at == 0), WITH_FLOATS.get(frame, frame), command, 0, 0, 0, 0, *place, 1)
    return "\t".join(map(str, cells))


def _mission_up(job: Job) -> Answer:
    file = Path(job["folder"]) / "up.waypoints"
    rows = (_row(at, *item) for at, item in enumerate(job["plan"]))
    file.write_text("\n".join((HEADER, *rows, "")), encoding="utf-8")
    console = _Console(job, "wp")
    console.wait(HEARD)
    start = perf_counter()
    console.say(f"wp load {file}")
    console.wait("Loaded ", " from ")
    end = console.wait("Got MISSION_ACK", "ACCEPTED")  # "Loaded … in" is said before the last item is there
    console.close()
    return {"seconds": end - start}


def _mission_down(job: Job) -> Answer:
    file = Path(job["folder"]) / "down.waypoints"
    console = _Console(job, "wp")
    console.wait(HEARD)
    start = perf_counter()
    console.say(f"wp save {file}")
    end = console.wait("Saved ")
    console.close()
    return {"seconds": end - start, "plan": _read_plan(file)}


def _read_plan(file: Path) -> list[tuple[int, int, int, int, float]]:
    lines = [line.split() for line in file.read_text(encoding="utf-8").splitlines()[1:] if line.strip()]
    return [
        (int(row[2]), int(row[3]), round(float(row[8]) * 1e7), round(float(row[9]) * 1e7), float(row[10]))
        for row in lines
    ]


WORKS: dict[str, Callable[[Job], Answer]] = {
    "parameters": lambda job: _parameters(job, packed=False),
    "packed": lambda job: _parameters(job, packed=True),
    "mission-up": _mission_up,
    "mission-down": _mission_down,
}

if __name__ == "__main__":
    serve(WORKS)
