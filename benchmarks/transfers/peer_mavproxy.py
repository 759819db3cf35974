"""MAVProxy as a client: the program itself, controlled by commands, whose output is read for the end.

For parameters the time counts from its line that the vehicle was detected, at which it begins to download
them, to its line that it received them; for a mission from the command to its line.
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

DETECTED = "Detected vehicle"
HEADER = "QGC WPL 110"
FLOAT_FRAME = {6: 3}  # the frame in its file format


class _Process:
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

    def send(self, command: str) -> None:
        """Send a command."""
        if self._process.stdin is not None:
            self._process.stdin.write(command + "\n")
            self._process.stdin.flush()

    def wait(self, *words: str) -> float:
        """Read until a line contains all words; return the time."""
        assert self._process.stdout is not None
        for line in self._process.stdout:
            print(line, end="", file=sys.stderr)
            if all(word in line for word in words):
                return perf_counter()
        raise RuntimeError("MAVProxy ended")

    def close(self) -> None:
        """Kill the process."""
        self._process.kill()


def _parameters(job: Job, *, packed: bool) -> Answer:
    console = _Process(job, "ftp,param", *(() if packed else ("set param_ftp 0",)))
    start = console.wait(DETECTED)
    end = console.wait("Received ", " parameters")  # from a list if the packed file failed
    saved = Path(job["folder"]) / "mavproxy.parm"
    console.send(f"param save {saved}")
    console.wait("Saved ")
    console.close()
    pairs = (line.split() for line in saved.read_text(encoding="utf-8").splitlines() if line.strip())
    return {"seconds": end - start, "parameters": {pair[0]: float(pair[1]) for pair in pairs}}


def _row(seq: int, frame: int, command: int, x: int, y: int, z: float) -> str:
    """Return an item as a line of a plan file."""
    coordinates = (f"{x / 1e7:.8f}", f"{y / 1e7:.8f}", f"{z:.6f}")
    cells = (seq, int(seq == 0), FLOAT_FRAME.get(frame, frame), command, 0, 0, 0, 0, *coordinates, 1)
    return "\t".join(map(str, cells))


def _mission_up(job: Job) -> Answer:
    file = Path(job["folder"]) / "up.waypoints"
    rows = (_row(seq, *item) for seq, item in enumerate(job["plan"]))
    file.write_text("\n".join((HEADER, *rows, "")), encoding="utf-8")
    console = _Process(job, "wp")
    console.wait(DETECTED)
    start = perf_counter()
    console.send(f"wp load {file}")
    console.wait("Loaded ", " from ")
    end = console.wait(
        "Got MISSION_ACK", "ACCEPTED"
    )  # "Loaded … in" is printed before the last item is acknowledged
    console.close()
    return {"seconds": end - start}


def _mission_down(job: Job) -> Answer:
    file = Path(job["folder"]) / "down.waypoints"
    console = _Process(job, "wp")
    console.wait(DETECTED)
    start = perf_counter()
    console.send(f"wp save {file}")
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
